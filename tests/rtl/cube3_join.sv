// A node of the segmented cone: up to three stretches of different rays from the left and from the right, in order of depth.
//
// One step of cube3_cone::lanes::circle. The last stretch on the left and the first on the right become one where they are of
// the same ray; the others are passed on. `has` tells of which rays there is a stretch; one that is not there is all 0.
//
// Operators: those of one cube3_node.
module cube3_join #(
    parameter integer VOXEL_BITS = 16,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer ACCUMULATOR_BITS = 16,
    parameter integer NEAREST = 1
) (
    input  wire [2:0]                                                                   mode,
    input  wire [2:0]                                                                   left_has,
    input  wire [3*(1+VOXEL_BITS+SAMPLE_FRACTION_BITS+4*(ACCUMULATOR_BITS+12))-1:0] left,
    input  wire [2:0]                                                                   right_has,
    input  wire [3*(1+VOXEL_BITS+SAMPLE_FRACTION_BITS+4*(ACCUMULATOR_BITS+12))-1:0] right,
    output wire [2:0]                                                                   has,
    output wire [3*(1+VOXEL_BITS+SAMPLE_FRACTION_BITS+4*(ACCUMULATOR_BITS+12))-1:0] joined
);
    localparam integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS;
    localparam integer N4 = 4 * (ACCUMULATOR_BITS + 12);
    // A stretch: whether a sample takes part, its word, the accumulators; from the top.
    localparam integer T = 1 + S + N4;

    // The last ray on the left, the first on the right.
    wire [2:0] last = left_has[2] ? 3'b100 : left_has[1] ? 3'b010 : 3'b001;
    wire [2:0] first = right_has[0] ? 3'b001 : right_has[1] ? 3'b010 : 3'b100;
    wire [T-1:0] near_end = last[2] ? left[2*T +: T] : last[1] ? left[T +: T] : left[0 +: T];
    wire [T-1:0] far_end = first[0] ? right[0 +: T] : first[1] ? right[T +: T] : right[2*T +: T];
    wire [T-1:0] both;

    cube3_node #(
        .VOXEL_BITS(VOXEL_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS), .ACCUMULATOR_BITS(ACCUMULATOR_BITS),
        .NEAREST(NEAREST)
    ) node (
        .mode(mode),
        .left_present(near_end[T-1]),
        .left_sample(near_end[N4 +: S]),
        .left_rgba(near_end[0 +: N4]),
        .right_present(far_end[T-1]),
        .right_sample(far_end[N4 +: S]),
        .right_rgba(far_end[0 +: N4]),
        .present(both[T-1]),
        .sample(both[N4 +: S]),
        .rgba(both[0 +: N4])
    );

    assign has = left_has | right_has;

    genvar r;
    generate
        for (r = 0; r < 3; r = r + 1) begin : ray
            assign joined[r*T +: T] = (last[r] && first[r]) ? both : left_has[r] ? left[r*T +: T] : right[r*T +: T];
        end
    endgenerate
endmodule
