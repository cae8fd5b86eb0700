// Linear interpolation of two sample words: near + round((far - near) * weight).
//
// Pfister et al. 1995, section 3. Equals cube3_word::lerp (crates/word/src/rounding.rs). `weight` is 0 to 2^WEIGHT_BITS
// inclusive, so the value lies between the two words and fits: the sum is taken in as many bits as a sample has.
//
// Operators: a multiplier, a subtracter, an adder, and an adder more that rounds to nearest.
module cube3_lerp #(
    parameter integer VOXEL_BITS = 16,
    parameter integer WEIGHT_BITS = 8,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer NEAREST = 1
) (
    // The interface's names are words of some C++ compilers, which Verilator renames.
    // verilator lint_off SYMRSVDWORD
    input  wire [VOXEL_BITS+SAMPLE_FRACTION_BITS-1:0] near,
    input  wire [VOXEL_BITS+SAMPLE_FRACTION_BITS-1:0] far,
    // verilator lint_on SYMRSVDWORD
    input  wire [WEIGHT_BITS:0]                       weight,
    output wire [VOXEL_BITS+SAMPLE_FRACTION_BITS-1:0] value
);
    localparam integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS;
    // A signed difference of S + 1 bits by a weight up to 2^WEIGHT_BITS; half fits on top.
    localparam integer P = S + 1 + WEIGHT_BITS;

    wire signed [S:0]   difference = $signed({1'b0, far}) - $signed({1'b0, near});
    wire signed [P-1:0] product = P'(difference) * P'($signed({1'b0, weight}));
    // Its sign is in the carry of the sum below.
    wire signed [S-1:0] step;

    cube3_round #(.IN(P), .OUT(S), .DROP(WEIGHT_BITS), .NEAREST(NEAREST)) round (.value(product), .rounded(step));

    assign value = near + $unsigned(step);
endmodule
