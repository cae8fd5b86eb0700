// The 2-D skewed buffers on their channels: planes are written beam by beam and read ray by ray.
//
//               write port                        read port
//   [aligned] -------------> ring of planes -----------------> [rays]
//                            (and the first)     ray j of planes i and i+1
//
// Cube-3, section 3: ray slot j at depth k is in module (j + k) mod N, so a beam (one k) and a ray (one j) are each one word of
// every module. Equals crates/dsb/src/unit.rs (`DsbUnit::tick`, two ports) and lanes.rs (`PlaneStore`). The read port goes first in
// a cycle: a plane that it finishes gives its buffer to the write port at once.
// Tokens: [aligned] {words, row is in the volume, depth, plane}; [rays] {ray of the plane below, ray, slot, plane}, in lane order.
module cube3_dsb_unit #(
    parameter integer N = 8,
    parameter integer PADDED = 0,
    parameter integer VOXEL_BITS = 16,
    parameter integer PLANES = 3,
    parameter integer L = $clog2(N),
    parameter integer P = L + PADDED,
    parameter integer CHUNKS = 1 + PADDED,
    parameter integer IN = P + L + 1 + CHUNKS * N * VOXEL_BITS,
    parameter integer OUT = 2 * P + 2 * N * VOXEL_BITS
) (
    input wire clk,
    input wire rst,
    input wire [P:0] slots,
    input wire [P:0] planes,
    // The last plane is read with the first, which is kept.
    input wire closes_v,
    // [aligned]
    input wire valid,
    input wire [IN-1:0] front,
    output wire pop,
    // [rays]
    input wire can_push,
    output wire push,
    output wire [OUT-1:0] token,
    output wire [1:0] write_activity,
    output wire [1:0] read_activity
);
    localparam integer B = $clog2(PLANES);
    localparam [B-1:0] LAST_BUFFER = B'(PLANES - 1);

    // Read port.
    reg [P:0] written;
    reg [P-1:0] plane;
    reg [P-1:0] slot;
    reg [B-1:0] read_buffer;
    reg done;
    wire [P:0] plane_after = {1'b0, plane} + 1'b1;
    wire [P:0] slot_after = {1'b0, slot} + 1'b1;
    wire last = plane_after == planes;
    wire [P+1:0] needed = last ? {1'b0, plane_after} : {1'b0, plane_after} + 1'b1;
    wire ready = !done && {1'b0, written} >= needed;
    assign push = ready && can_push;
    assign read_activity = !ready ? 2'd1 : can_push ? 2'd0 : 2'd2;
    wire plane_ends = push && slot_after == slots;
    wire [B-1:0] below_buffer = read_buffer == LAST_BUFFER ? {B{1'b0}} : read_buffer + 1'b1;

    // Write port: planes from the one being read on are still needed.
    reg [B-1:0] write_buffer;
    wire [P-1:0] in_plane = front[P-1:0];
    wire [L-1:0] in_depth = front[P+:L];
    wire in_volume = front[P+L];
    wire [P:0] released = done || plane_ends ? plane_after : {1'b0, plane};
    localparam [P+1:0] RING = (P+2)'(PLANES);
    wire room = {2'b00, in_plane} < {1'b0, released} + RING;
    assign pop = valid && room;
    assign write_activity = !valid ? 2'd1 : room ? 2'd0 : 2'd2;

    always @(posedge clk) begin
        if (rst) begin
            written <= {P + 1{1'b0}};
            plane <= {P{1'b0}};
            slot <= {P{1'b0}};
            read_buffer <= {B{1'b0}};
            write_buffer <= {B{1'b0}};
            done <= 1'b0;
        end else begin
            if (push) begin
                slot <= plane_ends ? {P{1'b0}} : slot_after[P-1:0];
                if (plane_ends) begin
                    // The last plane stays, so that what is released stays known.
                    if (!last) plane <= plane_after[P-1:0];
                    read_buffer <= below_buffer;
                    done <= last;
                end
            end
            if (pop && (&in_depth)) begin
                written <= written + 1'b1;
                write_buffer <= write_buffer == LAST_BUFFER ? {B{1'b0}} : write_buffer + 1'b1;
            end
        end
    end

    // The modules: for each chunk of N slots a ring of planes and the kept one, N words each.
    wire [CHUNKS*N*VOXEL_BITS-1:0] rays;
    wire [CHUNKS*N*VOXEL_BITS-1:0] belows;
    genvar m, c;
    generate
        for (c = 0; c < CHUNKS; c = c + 1) begin : chunk
            for (m = 0; m < N; m = m + 1) begin : module_
                localparam [L-1:0] NUMBER = L'(m);
                reg [VOXEL_BITS-1:0] ring[0:PLANES*N-1];
                reg [VOXEL_BITS-1:0] first[0:N-1];
                wire [VOXEL_BITS-1:0] in_word =
                    in_volume ? front[P+L+1+(c*N+m)*VOXEL_BITS+:VOXEL_BITS] : {VOXEL_BITS{1'b0}};
                always @(posedge clk) begin
                    if (!rst && pop) begin
                        ring[{write_buffer, in_depth}] <= in_word;
                        if (in_plane == {P{1'b0}}) first[in_depth] <= in_word;
                    end
                end
                // The depth that ray slot j has in this module.
                wire [L-1:0] depth = NUMBER - slot[L-1:0];
                wire [VOXEL_BITS-1:0] next = ring[{below_buffer, depth}];
                wire [VOXEL_BITS-1:0] kept = closes_v ? first[depth] : {VOXEL_BITS{1'b0}};
                assign rays[(c*N+m)*VOXEL_BITS+:VOXEL_BITS] = ring[{read_buffer, depth}];
                assign belows[(c*N+m)*VOXEL_BITS+:VOXEL_BITS] = last ? kept : next;
            end
        end
        if (PADDED != 0) begin : padded
            wire second = slot[P-1];
            assign token = second ? {belows[N*VOXEL_BITS+:N*VOXEL_BITS], rays[N*VOXEL_BITS+:N*VOXEL_BITS], slot, plane}
                                  : {belows[0+:N*VOXEL_BITS], rays[0+:N*VOXEL_BITS], slot, plane};
        end else begin : shared
            assign token = {belows, rays, slot, plane};
        end
    endgenerate
endmodule
