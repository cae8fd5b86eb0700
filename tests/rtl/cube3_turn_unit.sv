// Turns a row of N words by a number of places: what brings a ray from the order of its depths to the order of the lanes, and back.
//
// Depth k of ray slot j is in lane (j + k) mod N: `ray_lane` in crates/dsb/src/golden.rs. BACK = 0: out[(i + by) mod N] = in[i];
// BACK = 1: out[i] = in[(i + by) mod N]. log2 N stages of two-way selectors; N is a power of two.
module cube3_turn_unit #(
    parameter integer N = 8,
    parameter integer WORD = 16,
    parameter integer BACK = 0
) (
    input wire [N*WORD-1:0] in,
    input wire [$clog2(N)-1:0] by,
    output reg [N*WORD-1:0] out
);
    integer stage;
    always @* begin
        out = in;
        for (stage = 0; stage < $clog2(N); stage = stage + 1) begin
            if (by[stage]) begin
                if (BACK != 0) out = (out >> (WORD << stage)) | (out << (N * WORD - (WORD << stage)));
                else out = (out << (WORD << stage)) | (out >> (N * WORD - (WORD << stage)));
            end
        end
    end
endmodule
