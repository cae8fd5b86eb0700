// Where a voxel lies in the cubic frame buffer: module (a*x + b*y + c*z) mod LANES, and the address within it.
//
// Pfister et al. 1995, section 3.1. Equals cube3_cfb::golden::Placement and Skew::module. BLOCKS 0: words in rows, x' + X*(y + Y*z) with
// x' the word of the row and X the words of a row; 1: in blocks of up to 8 words a side, each in the order of rows; 2: mini-blocks of
// 2 x 2 x 2 voxels side by side in a module, in blocks of 2*LANES x 8 x 8 voxels. SKEW_A and LANES then share no factor.
//
// All divisors are constants: powers of two are wiring.
module cube3_cfb #(
    parameter integer LANES = 8,
    parameter integer NX = 8,
    parameter integer NY = 8,
    parameter integer NZ = 8,
    parameter integer SKEW_A = 1,
    parameter integer SKEW_B = 1,
    parameter integer SKEW_C = 1,
    parameter integer BLOCKS = 0
) (
    input  wire [11:0] x,
    input  wire [11:0] y,
    input  wire [11:0] z,
    output wire [11:0] module_number,
    // verilator lint_on SYMRSVDWORD
    output wire [35:0] address
);
    // Coefficients from 0 to LANES - 1 give the same modules, and sums that are not negative.
    localparam integer A = (SKEW_A % LANES + LANES) % LANES;
    localparam integer B = (SKEW_B % LANES + LANES) % LANES;
    localparam integer C = (SKEW_C % LANES + LANES) % LANES;

    // Greatest common divisor; gcd(0, n) = n.
    function integer gcd(input integer a, input integer n);
        integer low, high, rest;
        begin
            low = a;
            high = n;
            while (low != 0) begin
                rest = high % low;
                high = low;
                low = rest;
            end
            gcd = high;
        end
    endfunction

    function integer smaller(input integer a, input integer b);
        smaller = a < b ? a : b;
    endfunction

    // Words that a module holds of each row of LANES voxels.
    localparam integer DEPTH = gcd(A, LANES);
    // Lanes from a word of a module's row to the next.
    localparam integer SPREAD = LANES / DEPTH;
    // Words of a module along x; along y and z they are the volume's.
    localparam integer EX = (NX + LANES - 1) / LANES * DEPTH;
    // A block's words along x, y, z and in all, and the blocks along x and y.
    localparam integer BX = smaller(EX, 8);
    localparam integer BY = smaller(NY, 8);
    localparam integer BZ = smaller(NZ, 8);
    localparam integer BLOCK = BX * BY * BZ;
    localparam integer CX = (EX + BX - 1) / BX;
    localparam integer CY = (NY + BY - 1) / BY;

    wire [35:0] wide_x = {24'd0, x};
    wire [35:0] wide_y = {24'd0, y};
    wire [35:0] wide_z = {24'd0, z};

    // What the skew spreads: voxels, or mini-blocks.
    localparam integer SIDE = BLOCKS == 2 ? 2 : 1;
    wire [35:0] sum = 36'(A) * (wide_x / 36'(SIDE)) + 36'(B) * (wide_y / 36'(SIDE)) + 36'(C) * (wide_z / 36'(SIDE));
    assign module_number = 12'(sum % 36'(LANES));

    generate
        if (BLOCKS == 2) begin : mini_blocks
            // Blocks along x and y.
            localparam integer MX = (NX + 2 * LANES - 1) / (2 * LANES);
            localparam integer MY = (NY + 7) / 8;
            wire [28:0] number = 29'(wide_x / 36'(2 * LANES) + 36'(MX) * (wide_y / 36'd8 + 36'(MY) * (wide_z / 36'd8)));
            // Of a block a module has 4 x 4 mini-blocks along y and z.
            assign address = {number, z[2:1], y[2:1], z[0], y[0], x[0]};
        end else begin : words
            // Which of its module's words of a row the voxel is.
            wire [35:0] word = wide_x / 36'(LANES) * 36'(DEPTH) + wide_x % 36'(LANES) / 36'(SPREAD);
            if (BLOCKS == 1) begin : blocks
                wire [35:0] block = word / 36'(BX) + 36'(CX) * (wide_y / 36'(BY) + 36'(CY) * (wide_z / 36'(BZ)));
                wire [35:0] inner = word % 36'(BX) + 36'(BX) * (wide_y % 36'(BY) + 36'(BY) * (wide_z % 36'(BZ)));
                assign address = block * 36'(BLOCK) + inner;
            end else begin : rows
                assign address = word + 36'(EX) * (wide_y + 36'(NY) * wide_z);
            end
        end
    endgenerate
endmodule
