// What one light adds to the diffuse and specular light on a sample: two cosines and a power by table.
//
// A light of cube3_abc::golden::phong_from. Directions: fractions of NORMAL_BITS - 1, -1 to 1. The power table, 2^POWER_BITS + 1
// entries in fractions of COLOUR_BITS, is the shading unit's: `index` goes out to it, `power` comes back.
//
// Operators: for each cosine 3 multipliers, 2 adders, a negation, a rounding and a comparator; a rounding of the index; for each
// of the 6 products a multiplier, a rounding and an adder.
module cube3_light #(
    parameter integer NORMAL_BITS = 12,
    parameter integer COLOUR_BITS = 12,
    parameter integer POWER_BITS = 10,
    parameter integer NEAREST = 1
) (
    input  wire [3*(NORMAL_BITS+1)-1:0] normal,
    input  wire                         two_sided,
    input  wire [3*(NORMAL_BITS+1)-1:0] direction,
    input  wire [3*(NORMAL_BITS+1)-1:0] halfway,
    input  wire [3*(COLOUR_BITS+4)-1:0] diffuse,
    input  wire [3*(COLOUR_BITS+4)-1:0] specular,
    output wire [POWER_BITS:0]          index,
    input  wire [COLOUR_BITS:0]         power,
    input  wire [3*(COLOUR_BITS+8)-1:0] diffuse_before,
    input  wire [3*(COLOUR_BITS+8)-1:0] specular_before,
    output wire [3*(COLOUR_BITS+8)-1:0] diffuse_after,
    output wire [3*(COLOUR_BITS+8)-1:0] specular_after
);
    localparam integer N = NORMAL_BITS + 1;
    localparam integer B = NORMAL_BITS;
    localparam integer C = COLOUR_BITS;
    localparam integer I = C + 4;
    localparam integer L = C + 8;
    // Three products of words up to 1, and half.
    localparam integer P = 2 * B + 3;
    localparam [B-1:0] ONE = B'(1) << (B - 1);

    wire [2*3*N-1:0] towards = {halfway, direction};
    // Cosines to the light and to halfway, 0 to 1.
    wire [2*B-1:0] cosines;

    genvar i;
    generate
        for (i = 0; i < 2; i = i + 1) begin : cosine
            wire [3*P-1:0] dots;
            wire signed [P-1:0] dot = $signed(dots[0 +: P]) + $signed(dots[P +: P]) + $signed(dots[2*P +: P]);
            // The back is lit as the front, to the bit: the magnitude is taken before it is rounded.
            wire signed [P-1:0] facing = !dot[P-1] ? dot : two_sided ? -dot : P'(0);
            wire [B+2:0] rounded;
            cube3_round #(.IN(P), .OUT(B + 3), .DROP(B - 1), .NEAREST(NEAREST)) round (.value(facing), .rounded(rounded));
            assign cosines[i*B +: B] = rounded > (B+3)'(ONE) ? ONE : B'(rounded);
            genvar j;
            for (j = 0; j < 3; j = j + 1) begin : axis
                assign dots[j*P +: P] = P'($signed(normal[j*N +: N])) * P'($signed(towards[(3*i+j)*N +: N]));
            end
        end
    endgenerate

    // At most 1 and half of what is dropped, with a sign bit, which is 0.
    cube3_round #(.IN(B + 2), .OUT(POWER_BITS + 1), .DROP(B - 1 - POWER_BITS), .NEAREST(NEAREST)) round_index (
        .value({2'b00, cosines[B +: B]}), .rounded(index)
    );

    wire lit = two_sided || cosines[0 +: B] != B'(0);
    wire [C:0] shine = lit ? power : (C+1)'(0);

    generate
        for (i = 0; i < 3; i = i + 1) begin : channel
            localparam integer PD = I + B + 1;
            localparam integer PS = I + C + 2;
            wire [PD-1:0] diffuse_product = PD'(diffuse[i*I +: I]) * PD'(cosines[0 +: B]);
            wire [PS-1:0] specular_product = PS'(specular[i*I +: I]) * PS'(shine);
            wire [PD-B:0] diffuse_part;
            wire [PS-C-1:0] specular_part;
            cube3_round #(.IN(PD), .OUT(PD - B + 1), .DROP(B - 1), .NEAREST(NEAREST)) round_diffuse (
                .value(diffuse_product), .rounded(diffuse_part)
            );
            cube3_round #(.IN(PS), .OUT(PS - C), .DROP(C), .NEAREST(NEAREST)) round_specular (
                .value(specular_product), .rounded(specular_part)
            );
            assign diffuse_after[i*L +: L] = diffuse_before[i*L +: L] + L'(diffuse_part);
            assign specular_after[i*L +: L] = specular_before[i*L +: L] + L'(specular_part);
        end
    endgenerate
endmodule
