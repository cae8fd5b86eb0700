// A signed word without its lowest DROP bits, rounded to nearest (ties towards +infinity) or down.
//
// Equals cube3_word::Rounding::shift_right (crates/word/src/rounding.rs). IN holds the value with half added to it.
//
// Operators: an adder where it rounds to nearest and drops anything.
module cube3_round #(
    parameter integer IN = 16,
    parameter integer OUT = 8,
    parameter integer DROP = 8,
    parameter integer NEAREST = 1
) (
    input  wire signed [IN-1:0]  value,
    output wire signed [OUT-1:0] rounded
);
    generate
        if (NEAREST != 0 && DROP > 0) begin : nearest
            localparam signed [IN-1:0] ONE = IN'(1);
            localparam signed [IN-1:0] HALF = ONE << (DROP - 1);
            wire signed [IN-1:0] sum = value + HALF;
            assign rounded = OUT'(sum >>> DROP);
        end else begin : truncate
            assign rounded = OUT'(value >>> DROP);
        end
    endgenerate
endmodule
