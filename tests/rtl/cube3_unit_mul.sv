// Product of two unit words: a * b / (2^BITS - 1), to nearest (ties up) or down, without a divider.
//
// Blinn's rule for any width: 1 / (2^b - 1) = 2^-b * (1 + 2^-b + ...), of which two terms suffice. Equals
// cube3_word::unit_mul (crates/word/src/unit.rs). Every sum stays below 2^(2 BITS).
//
// Operators: a multiplier and two adders, one of which adds a constant.
module cube3_unit_mul #(
    parameter integer BITS = 16,
    parameter integer NEAREST = 1
) (
    input  wire [BITS-1:0] a,
    input  wire [BITS-1:0] b,
    output wire [BITS-1:0] product
);
    localparam integer P = 2 * BITS;
    localparam [P-1:0] ONE = P'(1);

    wire [P-1:0] exact = P'(a) * P'(b);
    wire [P-1:0] carried;

    generate
        if (NEAREST != 0) begin : nearest
            wire [P-1:0] start = exact + (ONE << (BITS - 1));
            assign carried = start + (start >> BITS);
        end else begin : truncate
            assign carried = exact + (exact >> BITS) + ONE;
        end
    endgenerate

    assign product = BITS'(carried >> BITS);
endmodule
