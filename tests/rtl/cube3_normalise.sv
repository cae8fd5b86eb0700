// Direction and length of a gradient: a block shift brings its largest component to NORMAL_BITS, a table of reciprocal roots
// over the squared length does the rest.
//
// Equals cube3_abc::golden::normalise. Direction: fractions of NORMAL_BITS - 1, -1 to 1 inclusive, all 0 where the gradient is.
// Magnitude: in the gradient's own words. Table `root`: entry i is for squared lengths of the i-th bin from 2^(2B-2) on, so the
// memory starts at word 2^ROOT_BITS. ROOT_BITS is at most 2 NORMAL_BITS - 2.
//
// Operators: 3 negations, 3 squares and their sum, 3 products with the root, each rounded and held at one, 3 negations back;
// for the magnitude 3 products, their sum, and a rounding. The block shift is a priority encoder: none.
module cube3_normalise #(
    parameter integer GRADIENT_BITS = 17,
    parameter integer KEPT_BITS = 0,
    parameter integer NORMAL_BITS = 12,
    parameter integer ROOT_BITS = 8,
    parameter ROOT_FILE = ""
) (
    input  wire [3*(GRADIENT_BITS+KEPT_BITS)-1:0] g,
    output wire [3*(NORMAL_BITS+1)-1:0]           direction,
    output wire [GRADIENT_BITS+KEPT_BITS:0]       magnitude
);
    localparam integer G = GRADIENT_BITS + KEPT_BITS;
    localparam integer B = NORMAL_BITS;
    // Products with the root and half; the length is below 3 * 2^(2B-1), the sum of squares below 3 * 2^2B.
    localparam integer P = 2 * B + 1;
    localparam integer Q = 2 * B + 2;
    localparam integer I = ROOT_BITS + 4;
    // The length with 24 bits below it, with half of the most that is dropped.
    localparam integer X = 2 * B + 25;
    localparam [B-1:0] ONE = B'(1) << (B - 1);

    // Written by $readmemh where a file is named.
    // verilator lint_off UNDRIVEN
    reg [B:0] root [(1 << ROOT_BITS):(12 << ROOT_BITS)-1];
    // verilator lint_on UNDRIVEN

    generate
        if (ROOT_FILE != "") begin : load
            initial $readmemh(ROOT_FILE, root);
        end
    endgenerate

    wire [3*G-1:0] sizes;
    wire [G-1:0] largest = sizes[0 +: G] | sizes[G +: G] | sizes[2*G +: G];
    wire none = largest == G'(0);

    // Leading zeros of the largest component, and how far the length is shifted back: leading zeros of 32 bits + 2B - 9.
    reg [5:0] zeros;
    reg [5:0] back;
    // Half of what the shift back drops.
    reg [X-1:0] half;
    integer bit_;
    always @* begin
        zeros = 6'd0;
        back = 6'd0;
        half = X'(0);
        for (bit_ = 0; bit_ < G; bit_ = bit_ + 1) begin
            if (largest[bit_]) begin
                zeros = 6'(G - 1 - bit_);
                back = 6'(31 - bit_ + 2 * B - 9);
                half = X'(1) << (31 - bit_ + 2 * B - 9) >> 1;
            end
        end
    end

    wire [3*B-1:0] block;
    wire [3*P-1:0] lengths;
    wire [3*Q-1:0] squares;
    wire [Q-1:0] square = squares[0 +: Q] + squares[Q +: Q] + squares[2*Q +: Q];
    wire [I-1:0] index = I'(square >> (2 * B - 2 - ROOT_BITS));
    wire [B:0] reciprocal = root[index];

    genvar i;
    generate
        for (i = 0; i < 3; i = i + 1) begin : component
            wire negative = g[i*G+G-1];
            assign sizes[i*G +: G] = negative ? -g[i*G +: G] : g[i*G +: G];
            // The leading B bits, with zeros below where there are fewer.
            wire [G-1:0] shifted = sizes[i*G +: G] << zeros;
            assign block[i*B +: B] = B'({shifted, {B{1'b0}}} >> G);
            assign squares[i*Q +: Q] = Q'(block[i*B +: B]) * Q'(block[i*B +: B]);
            wire [P-1:0] product = P'(block[i*B +: B]) * P'(reciprocal);
            wire [B:0] rounded = (B+1)'((product + P'(ONE)) >> B);
            wire [B-1:0] unit = rounded > {1'b0, ONE} ? ONE : B'(rounded);
            assign direction[i*(B+1) +: B+1] = none ? (B+1)'(0) : negative ? -{1'b0, unit} : {1'b0, unit};
            assign lengths[i*P +: P] = P'(block[i*B +: B]) * P'(unit);
        end
    endgenerate

    wire [P-1:0] length = lengths[0 +: P] + lengths[P +: P] + lengths[2*P +: P];
    wire [X-1:0] scaled = {length, 24'd0} + half;
    assign magnitude = none ? (G+1)'(0) : (G+1)'(scaled >> back);
endmodule
