// The fast bus on its channels: each beam is turned so that voxel x of depth k comes to the lane of its ray slot.
//
//     [beams] --> turn by X(k) and the two skews --> [aligned]
//
// Cube-3, section 3. Equals crates/dsb/src/bus.rs (`BusUnit::step`, a channel for each lane) and lanes.rs (`Rotator::align`). With
// PADDED, up to 2 N slots: a turned beam then fills lanes of the first N slots and of the second.
// Tokens: [beams] {voxels, row is in the volume, row, depth, plane}; [aligned] {words, row is in the volume, depth, plane}.
module cube3_bus_unit #(
    parameter integer N = 8,
    parameter integer PADDED = 0,
    parameter integer VOXEL_BITS = 16,
    parameter integer L = $clog2(N),
    parameter integer P = L + PADDED,
    parameter integer CHUNKS = 1 + PADDED,
    parameter integer IN = P + 2 * L + 1 + N * VOXEL_BITS,
    parameter integer OUT = P + L + 1 + CHUNKS * N * VOXEL_BITS
) (
    input wire wrapped,
    input wire [N*(L+1)-1:0] columns,
    // [beams]
    input wire valid,
    input wire [IN-1:0] front,
    output wire pop,
    // [aligned]
    input wire can_push,
    output wire push,
    output wire [OUT-1:0] token,
    output wire [1:0] activity
);
    wire [P-1:0] plane = front[P-1:0];
    wire [L-1:0] depth = front[P+:L];
    wire [L-1:0] row = front[P+L+:L];
    wire in_volume = front[P+2*L];
    wire [N*VOXEL_BITS-1:0] beam = front[P+2*L+1+:N*VOXEL_BITS];

    assign pop = valid && can_push;
    assign push = pop;
    assign activity = !valid ? 2'd1 : can_push ? 2'd0 : 2'd2;

    // Slot of voxel 0: minus X(k), from the leftmost ray where slots are padded.
    wire [L:0] column = columns[depth*(L+1)+:L+1];
    wire [L:0] shear = columns[(N-1)*(L+1)+:L+1];
    // verilator lint_off UNUSEDSIGNAL
    wire [L:0] left = wrapped ? column : column - shear;  // Shared slots are turned by its lower bits alone.
    // verilator lint_on UNUSEDSIGNAL
    wire [L-1:0] turn = left[L-1:0];
    wire [N*VOXEL_BITS-1:0] turned;
    cube3_bus #(
        .LANES(N), .VOXEL_BITS(VOXEL_BITS)
    ) rotator (
        .row({{12-L{1'b0}}, row}),
        .column({{12-L{1'b0}}, turn}),
        .voxel(beam),
        /* verilator lint_off PINCONNECTEMPTY */
        .rotation(),  // For the vectors; the words are turned inside.
        /* verilator lint_on PINCONNECTEMPTY */
        .out(turned)
    );

    wire [CHUNKS*N*VOXEL_BITS-1:0] words;
    genvar m;
    generate
        if (PADDED != 0) begin : padded
            for (m = 0; m < N; m = m + 1) begin : lane
                localparam [L-1:0] NUMBER = L'(m);
                // The slot in lane m is x - X(k) + shear; it is among the first N or the second.
                wire [L-1:0] x = NUMBER - depth + turn;
                wire [L:0] slot = {1'b0, x} - left;
                wire second = slot[L] && !wrapped;
                wire [VOXEL_BITS-1:0] word = turned[m*VOXEL_BITS+:VOXEL_BITS];
                assign words[m*VOXEL_BITS+:VOXEL_BITS] = second ? {VOXEL_BITS{1'b0}} : word;
                assign words[(N+m)*VOXEL_BITS+:VOXEL_BITS] = second ? word : {VOXEL_BITS{1'b0}};
            end
        end else begin : shared
            assign words = turned;
        end
    endgenerate

    assign token = {words, in_volume, depth, plane};
endmodule
