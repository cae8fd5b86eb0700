// A sample at a leaf of the cone: opacity and colour in the accumulators' width, the colour weighted with the opacity.
//
// Equals cube3_cone::golden::leaf. Modes: 0 composite, 1 first opaque, 2 last opaque, 3 maximum, 4 minimum, 5 weighted sum.
// In modes 1 and 2 a sample below `opaque` is absent, any other has an opacity of 1.
//
// Operators: three products of unit words, a comparator.
module cube3_leaf #(
    parameter integer VOXEL_BITS = 16,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer COLOUR_BITS = 12,
    parameter integer OPACITY_BITS = 12,
    parameter integer ACCUMULATOR_BITS = 16,
    parameter integer NEAREST = 1
) (
    input  wire [2:0]                                 mode,
    input  wire [OPACITY_BITS-1:0]                    opaque,
    input  wire                                       present,
    input  wire [VOXEL_BITS+SAMPLE_FRACTION_BITS-1:0] sample,
    input  wire [OPACITY_BITS-1:0]                    opacity,
    input  wire [3*COLOUR_BITS-1:0]                   colour,
    output wire                                       out_present,
    output wire [VOXEL_BITS+SAMPLE_FRACTION_BITS-1:0] out_sample,
    output wire [4*ACCUMULATOR_BITS-1:0]              out_rgba
);
    localparam integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS;
    localparam integer C = COLOUR_BITS;
    localparam integer A = ACCUMULATOR_BITS;
    localparam [2:0] FIRST_OPAQUE = 3'd1;
    localparam [2:0] LAST_OPAQUE = 3'd2;

    wire surface = mode == FIRST_OPAQUE || mode == LAST_OPAQUE;
    assign out_present = present && !(surface && opacity < opaque);
    assign out_sample = out_present ? sample : S'(0);

    wire [A-1:0] wide;
    cube3_unit_resize #(.FROM(OPACITY_BITS), .TO(A)) resize_opacity (.raw(opacity), .value(wide));
    wire [A-1:0] alpha = surface ? {A{1'b1}} : wide;
    assign out_rgba[3*A +: A] = out_present ? alpha : A'(0);

    genvar i;
    generate
        for (i = 0; i < 3; i = i + 1) begin : channel
            wire [A-1:0] full;
            wire [A-1:0] weighted;
            cube3_unit_resize #(.FROM(C), .TO(A)) resize (.raw(colour[i*C +: C]), .value(full));
            cube3_unit_mul #(.BITS(A), .NEAREST(NEAREST)) weight (.a(full), .b(alpha), .product(weighted));
            assign out_rgba[i*A +: A] = out_present ? weighted : A'(0);
        end
    endgenerate
endmodule
