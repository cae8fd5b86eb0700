// Light on a sample by a table over the gradient's direction: a cube's face for its largest component, and the others divided by it.
//
// Equals cube3_abc::golden::reflectance. Of equal components u is before v, v before w. A sample without a gradient has the flat
// intensity. Tables `diffuse` and `specular`: six faces of 2^REFLECTANCE_BITS squared, red in the low bits.
//
// Operators: 3 negations, two comparators for the largest component; for each of the two coordinates a divider, a comparator and
// an adder.
module cube3_reflectance #(
    parameter integer GRADIENT_BITS = 17,
    parameter integer KEPT_BITS = 0,
    parameter integer COLOUR_BITS = 12,
    parameter integer REFLECTANCE_BITS = 6,
    parameter DIFFUSE_FILE = "",
    parameter SPECULAR_FILE = ""
) (
    input  wire [3*(GRADIENT_BITS+KEPT_BITS)-1:0] g,
    input  wire [COLOUR_BITS+3:0]                 flat,
    output wire [3*(COLOUR_BITS+4)-1:0]           diffuse,
    output wire [3*(COLOUR_BITS+4)-1:0]           specular
);
    localparam integer G = GRADIENT_BITS + KEPT_BITS;
    localparam integer F = REFLECTANCE_BITS;
    localparam integer I = 3 * (COLOUR_BITS + 4);
    localparam integer ENTRIES = 6 << (2 * F);
    // A size with the fraction of the quotient below.
    localparam integer Q = G + F - 1;

    // Written by $readmemh where a file is named.
    // verilator lint_off UNDRIVEN
    reg [I-1:0] diffuses [0:ENTRIES-1];
    reg [I-1:0] speculars [0:ENTRIES-1];
    // verilator lint_on UNDRIVEN

    generate
        if (DIFFUSE_FILE != "") begin : load_diffuse
            initial $readmemh(DIFFUSE_FILE, diffuses);
        end
        if (SPECULAR_FILE != "") begin : load_specular
            initial $readmemh(SPECULAR_FILE, speculars);
        end
    endgenerate

    wire [2:0] negative;
    wire [3*G-1:0] sizes;

    genvar i;
    generate
        for (i = 0; i < 3; i = i + 1) begin : size
            assign negative[i] = g[i*G+G-1];
            assign sizes[i*G +: G] = negative[i] ? -g[i*G +: G] : g[i*G +: G];
        end
    endgenerate

    wire u_before_v = sizes[0 +: G] >= sizes[G +: G];
    wire [G-1:0] larger = u_before_v ? sizes[0 +: G] : sizes[G +: G];
    wire before_w = larger >= sizes[2*G +: G];
    wire [G-1:0] largest = before_w ? larger : sizes[2*G +: G];
    wire none = largest == G'(0);

    // The axis of the face, and the two behind it in the order u, v, w, u.
    wire [1:0] axis = !before_w ? 2'd2 : u_before_v ? 2'd0 : 2'd1;
    wire [2*G-1:0] sides = axis == 2'd0 ? {sizes[2*G +: G], sizes[G +: G]}
        : axis == 2'd1 ? {sizes[0 +: G], sizes[2*G +: G]}
        : {sizes[G +: G], sizes[0 +: G]};
    wire [1:0] side_negative = axis == 2'd0 ? {negative[2], negative[1]}
        : axis == 2'd1 ? {negative[0], negative[2]}
        : {negative[1], negative[0]};
    wire face_negative = axis == 2'd0 ? negative[0] : axis == 2'd1 ? negative[1] : negative[2];

    // The second one above the first.
    wire [2*F-1:0] coordinates;

    generate
        for (i = 0; i < 2; i = i + 1) begin : coordinate
            localparam [F-1:0] HALF = F'(1) << (F - 1);
            localparam [F-1:0] LAST = HALF - F'(1);
            // 0 to 2^(F-1) where a gradient is; the largest quotient is held below that.
            wire [Q-1:0] quotient = (Q'(sides[i*G +: G]) << (F - 1)) / Q'(largest);
            wire [F-1:0] held = quotient > Q'(LAST) ? LAST : F'(quotient);
            // half + quotient, or half - 1 - quotient.
            assign coordinates[i*F +: F] = HALF + (side_negative[i] ? ~held : held);
        end
    endgenerate

    wire [2*F+2:0] index = {axis, face_negative, coordinates};
    assign diffuse = none ? {3{flat}} : diffuses[index];
    assign specular = none ? I'(0) : speculars[index];
endmodule
