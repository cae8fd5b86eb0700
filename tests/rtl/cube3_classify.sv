// Opacity and colour of a sample by the tables; a sample outside of the threshold is not visible and has none.
//
// Equals cube3_abc::golden::classify_in. The colour table is over the sample's leading TABLE_BITS, the opacity table besides over
// ROWS rows of the gradient's magnitude (1, or a power of two) and over CLASSES classes of step lengths.
// Table entries: opacity (class*ROWS + row) * 2^TABLE_BITS + index; colour with red in the low bits.
//
// Operators: two comparators for the threshold, one that holds the row at the last.
module cube3_classify #(
    parameter integer VOXEL_BITS = 16,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer GRADIENT_BITS = 17,
    parameter integer KEPT_BITS = 0,
    parameter integer TABLE_BITS = 12,
    parameter integer COLOUR_BITS = 12,
    parameter integer OPACITY_BITS = 12,
    parameter integer ROWS = 1,
    parameter integer CLASSES = 1,
    parameter OPACITY_FILE = "",
    parameter COLOUR_FILE = ""
) (
    input  wire [VOXEL_BITS+SAMPLE_FRACTION_BITS-1:0]     sample,
    input  wire [GRADIENT_BITS+KEPT_BITS:0]               magnitude,
    // A keyword of SystemVerilog, so the name is escaped; Verilator renames it in C++. Few classes need few of its bits.
    // verilator lint_off SYMRSVDWORD
    // verilator lint_off UNUSEDSIGNAL
    input  wire [3:0]                                     \class ,
    // verilator lint_on UNUSEDSIGNAL
    // verilator lint_on SYMRSVDWORD
    input  wire [2*(VOXEL_BITS+SAMPLE_FRACTION_BITS)-1:0] threshold,
    input  wire [4:0]                                     row_shift,
    output wire                                           visible,
    output wire [OPACITY_BITS-1:0]                        opacity,
    output wire [3*COLOUR_BITS-1:0]                       colour
);
    localparam integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS;
    localparam integer O = OPACITY_BITS;
    localparam integer C = COLOUR_BITS;
    localparam integer ENTRIES = 1 << TABLE_BITS;
    localparam integer WORDS = CLASSES * ROWS * ENTRIES;
    localparam integer A = $clog2(WORDS);
    localparam integer M = GRADIENT_BITS + KEPT_BITS + 1;
    // The row before it is held, and the last one, in a word that holds both.
    localparam integer R = M > $clog2(ROWS) + 1 ? M : $clog2(ROWS) + 1;
    localparam integer N = $clog2(ROWS) > 0 ? $clog2(ROWS) : 1;
    localparam [R-1:0] LAST = R'(ROWS - 1);

    // Written by $readmemh where a file is named.
    // verilator lint_off UNDRIVEN
    reg [O-1:0] opacities [0:WORDS-1];
    reg [3*C-1:0] colours [0:ENTRIES-1];
    // verilator lint_on UNDRIVEN

    generate
        if (OPACITY_FILE != "") begin : load_opacity
            initial $readmemh(OPACITY_FILE, opacities);
        end
        if (COLOUR_FILE != "") begin : load_colour
            initial $readmemh(COLOUR_FILE, colours);
        end
    endgenerate

    wire [TABLE_BITS-1:0] index = TABLE_BITS'(sample >> (S - TABLE_BITS));
    wire [R-1:0] far_row = R'(magnitude) >> row_shift;
    wire [N-1:0] row = far_row > LAST ? N'(LAST) : N'(far_row);
    // The row and the class lie above the index: no adders, as their numbers are powers of two.
    wire [A-1:0] address = A'(index) | A'(row) << TABLE_BITS | A'(\class ) << (TABLE_BITS + $clog2(ROWS));

    assign visible = !(sample < threshold[0 +: S] || sample > threshold[S +: S]);
    assign opacity = visible ? opacities[address] : O'(0);
    assign colour = visible ? colours[index] : (3*C)'(0);
endmodule
