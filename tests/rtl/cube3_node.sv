// A node of the cone: two neighbouring stretches of a ray become one, the left one nearer to the eye.
//
// Pfister et al. 1995, section 3.4. Equals cube3_cone::golden::combine. Modes as in cube3_leaf. Nothing beside something gives the
// something. Words of ACCUMULATOR_BITS, and 12 bits above them for the sums of a weighted sum.
//
// Operators: a complement (a subtracter), a comparator of samples, and for each of the four channels a product of unit words and an
// adder, which compositing and the weighted sum share.
module cube3_node #(
    parameter integer VOXEL_BITS = 16,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer ACCUMULATOR_BITS = 16,
    parameter integer NEAREST = 1
) (
    input  wire [2:0]                                 mode,
    input  wire                                       left_present,
    input  wire [VOXEL_BITS+SAMPLE_FRACTION_BITS-1:0] left_sample,
    input  wire [4*(ACCUMULATOR_BITS+12)-1:0]         left_rgba,
    input  wire                                       right_present,
    input  wire [VOXEL_BITS+SAMPLE_FRACTION_BITS-1:0] right_sample,
    input  wire [4*(ACCUMULATOR_BITS+12)-1:0]         right_rgba,
    output wire                                       present,
    output wire [VOXEL_BITS+SAMPLE_FRACTION_BITS-1:0] sample,
    output wire [4*(ACCUMULATOR_BITS+12)-1:0]         rgba
);
    localparam integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS;
    localparam integer A = ACCUMULATOR_BITS;
    localparam integer N = A + 12;
    localparam [2:0] COMPOSITE = 3'd0;
    localparam [2:0] LAST_OPAQUE = 3'd2;
    localparam [2:0] MAXIMUM = 3'd3;
    localparam [2:0] MINIMUM = 3'd4;
    localparam [2:0] WEIGHTED_SUM = 3'd5;

    // Of equal samples the left one is kept.
    wire [S-1:0] above = mode == MINIMUM ? left_sample : right_sample;
    wire [S-1:0] below = mode == MINIMUM ? right_sample : left_sample;
    wire better = above > below;
    wire both = left_present && right_present;
    wire adds = both && (mode == COMPOSITE || mode == WEIGHTED_SUM);
    // Which stretch is passed on where nothing is added.
    wire takes_right = !left_present
        || (right_present && (mode == LAST_OPAQUE || ((mode == MAXIMUM || mode == MINIMUM) && better)));

    assign present = left_present || right_present;
    assign sample = takes_right ? right_sample : left_sample;

    wire [A-1:0] through = {A{1'b1}} - left_rgba[3*N +: A];

    genvar i;
    generate
        for (i = 0; i < 4; i = i + 1) begin : channel
            wire [A-1:0] product;
            cube3_unit_mul #(.BITS(A), .NEAREST(NEAREST)) weight (
                .a(through), .b(right_rgba[i*N +: A]), .product(product)
            );
            wire [N-1:0] addend = mode == WEIGHTED_SUM ? right_rgba[i*N +: N] : N'(product);
            wire [N-1:0] sum = left_rgba[i*N +: N] + addend;
            assign rgba[i*N +: N] = adds ? sum : takes_right ? right_rgba[i*N +: N] : left_rgba[i*N +: N];
        end
    endgenerate
endmodule
