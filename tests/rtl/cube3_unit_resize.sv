// A unit word in another width, both ends exact. Wider repeats the bits from the top on; narrower keeps the leading ones.
//
// Equals cube3_word::unit_resize (crates/word/src/unit.rs). Wiring: no operators.
module cube3_unit_resize #(
    parameter integer FROM = 12,
    parameter integer TO = 16
) (
    // Narrowing drops the low bits.
    // verilator lint_off UNUSEDSIGNAL
    input  wire [FROM-1:0] raw,
    // verilator lint_on UNUSEDSIGNAL
    output wire [TO-1:0]   value
);
    genvar i;
    generate
        for (i = 0; i < TO; i = i + 1) begin : bits
            assign value[TO-1-i] = raw[FROM-1-i%FROM];
        end
    endgenerate
endmodule
