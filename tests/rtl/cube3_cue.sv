// A colour behind the depth cue's factor, 0 to 1 in fractions of 12 bits.
//
// Equals cube3_abc::golden::cued.
//
// Operators, for each colour: a multiplier, and an adder that rounds to nearest. The factor itself, a sum that goes along with
// the scan and two comparators, comes from outside.
module cube3_cue #(
    parameter integer COLOUR_BITS = 12,
    parameter integer NEAREST = 1
) (
    input  wire [3*COLOUR_BITS-1:0] colour,
    input  wire [12:0]              factor,
    output wire [3*COLOUR_BITS-1:0] value
);
    localparam integer C = COLOUR_BITS;
    localparam integer FRACTION = 12;
    // At most a full colour times 1 and half, with a sign bit, which is 0.
    localparam integer P = C + FRACTION + 1;

    genvar i;
    generate
        for (i = 0; i < 3; i = i + 1) begin : channel
            wire [P-1:0] product = P'(colour[i*C +: C]) * P'(factor);
            cube3_round #(.IN(P), .OUT(C), .DROP(FRACTION), .NEAREST(NEAREST)) round (
                .value(product), .rounded(value[i*C +: C])
            );
        end
    endgenerate
endmodule
