// The colour of a lit sample: times diffuse, plus specular, saturated at 1.
//
// Equals cube3_abc::golden::lit. Diffuse: fractions of COLOUR_BITS; specular: on the scale of a unit colour word.
//
// Operators, for each colour: a multiplier, an adder (and one that rounds to nearest), a comparator.
module cube3_lit #(
    parameter integer COLOUR_BITS = 12,
    parameter integer NEAREST = 1
) (
    input  wire [3*COLOUR_BITS-1:0]     colour,
    input  wire [3*(COLOUR_BITS+8)-1:0] diffuse,
    input  wire [3*(COLOUR_BITS+8)-1:0] specular,
    output wire [3*COLOUR_BITS-1:0]     value,
    output wire [2:0]                   overflow
);
    localparam integer C = COLOUR_BITS;
    localparam integer L = C + 8;
    // A product with a sign bit, which is 0.
    localparam integer P = C + L + 1;
    localparam [C-1:0] FULL = {C{1'b1}};

    genvar i;
    generate
        for (i = 0; i < 3; i = i + 1) begin : channel
            wire [P-1:0] product = P'(colour[i*C +: C]) * P'(diffuse[i*L +: L]);
            wire [L:0] through;
            cube3_round #(.IN(P), .OUT(L + 1), .DROP(C), .NEAREST(NEAREST)) round (.value(product), .rounded(through));
            wire [L:0] sum = through + {1'b0, specular[i*L +: L]};
            assign overflow[i] = sum > (L+1)'(FULL);
            assign value[i*C +: C] = overflow[i] ? FULL : C'(sum);
        end
    endgenerate
endmodule
