// The pixel of a ray's node: the accumulators as they are, of a weighted sum the sums times the weight, saturated at 1.
//
// Equals cube3_cone::golden::pixel. The weight is a fraction of 32 bits, at most 1.
//
// Operators, for each channel: a multiplier, an adder that rounds to nearest, a comparator.
module cube3_pixel #(
    parameter integer ACCUMULATOR_BITS = 16,
    parameter integer NEAREST = 1
) (
    input  wire [2:0]                         mode,
    // A ray without a sample is all 0, so nothing depends on it.
    // verilator lint_off UNUSEDSIGNAL
    input  wire                               present,
    // verilator lint_on UNUSEDSIGNAL
    input  wire [4*(ACCUMULATOR_BITS+12)-1:0] rgba,
    input  wire [32:0]                        sum_weight,
    output wire [4*ACCUMULATOR_BITS-1:0]      pixel,
    output wire [3:0]                         overflow
);
    localparam integer A = ACCUMULATOR_BITS;
    localparam integer N = A + 12;
    localparam integer FRACTION = 32;
    // A product with half, and a sign bit, which is 0.
    localparam integer P = N + FRACTION + 2;
    localparam [2:0] WEIGHTED_SUM = 3'd5;
    localparam [A-1:0] FULL = {A{1'b1}};

    genvar i;
    generate
        for (i = 0; i < 4; i = i + 1) begin : channel
            wire [P-1:0] product = P'(rgba[i*N +: N]) * P'(sum_weight);
            wire [N:0] mean;
            cube3_round #(.IN(P), .OUT(N + 1), .DROP(FRACTION), .NEAREST(NEAREST)) round (.value(product), .rounded(mean));
            assign overflow[i] = mode == WEIGHTED_SUM && mean > (N+1)'(FULL);
            assign pixel[i*A +: A] = overflow[i] ? FULL : mode == WEIGHTED_SUM ? A'(mean) : rgba[i*N +: A];
        end
    endgenerate
endmodule
