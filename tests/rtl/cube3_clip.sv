// Whether a sample is inside of a cut plane: the plane's linear function is 0 or more.
//
// Equals cube3_frame::Linear::at, 0 or more, with the widest registers: u, v, k to 14 bits, steps to 40.
//
// Operators: 3 multipliers and 3 adders for a sample anywhere. A unit that scans in order needs one adder: it adds a step.
module cube3_clip (
    input  wire signed [13:0] u,
    input  wire signed [13:0] v,
    input  wire signed [13:0] k,
    input  wire signed [33:0] step_u,
    input  wire signed [33:0] step_v,
    input  wire signed [34:0] step_k,
    input  wire signed [61:0] constant,
    output wire               kept
);
    // Three products of 49 bits and a constant of 62.
    localparam integer P = 64;
    wire signed [P-1:0] value = P'(u) * P'(step_u) + P'(v) * P'(step_v) + P'(k) * P'(step_k) + P'(constant);

    assign kept = !value[P-1];
endmodule
