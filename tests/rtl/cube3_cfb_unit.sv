// The cubic frame buffer on its channel: it scans the planes of a frame and sends the beam of each (plane, depth).
//
//     (plane i, depth k) counters --> N skewed modules, one word each --> output network --> [beams]
//
// Cube-3, section 3: voxel (x, y, z) is in module (x + y + z) mod N, so that a beam along any axis is one word of every module.
// Equals crates/cfb/src/unit.rs (`CfbUnit::step`, `row`) and lanes.rs (`FrameBuffer::fetch`) for a cubic volume of N voxels a side
// on N lanes. A beam takes one cycle; its token is {voxels, row is in the volume, row, depth, plane}.
//
// Voxels are written through `write` while the machine is in reset; the address is {module, address in the module}.
module cube3_cfb_unit #(
    parameter integer N = 8,
    parameter integer PADDED = 0,
    parameter integer VOXEL_BITS = 16,
    // Derived: bits of a place on an axis, of a slot, of a column, and of a token.
    parameter integer L = $clog2(N),
    parameter integer P = L + PADDED,
    parameter integer T = P + 2 * L + 1 + N * VOXEL_BITS
) (
    input wire clk,
    input wire rst,
    // Registers: see cube3_pipeline.sv.
    input wire [P:0] planes,
    input wire wrapped,
    input wire [1:0] axis_u,
    input wire [1:0] axis_v,
    input wire [2:0] reversed,
    input wire [N*(L+1)-1:0] rows,
    // Voxels.
    input wire write,
    input wire [3*L-1:0] write_address,
    input wire [VOXEL_BITS-1:0] write_data,
    // [beams]
    input wire can_push,
    output wire push,
    output wire [T-1:0] token,
    // 0 busy, 1 starved, 2 blocked.
    output wire [1:0] activity
);
    reg [P-1:0] plane;
    reg [L-1:0] depth;
    reg done;

    wire last_depth = &depth;
    wire [P:0] after = {1'b0, plane} + 1;
    assign push = !done && can_push;
    assign activity = done ? 2'd1 : can_push ? 2'd0 : 2'd2;
    always @(posedge clk) begin
        if (rst) begin
            plane <= {P{1'b0}};
            depth <= {L{1'b0}};
            done <= 1'b0;
        end else if (push) begin
            depth <= depth + 1'b1;
            if (last_depth) begin
                plane <= after[P-1:0];
                done <= after == planes;
            end
        end
    end

    // The row of the volume that the plane has at this depth; a padded plane may have none.
    wire [L:0] column = rows[depth*(L+1)+:L+1];
    wire [L:0] shear = rows[(N-1)*(L+1)+:L+1];
    wire [P+2:0] reach = {{3{1'b0}}, plane} + {{P+2-L{1'b0}}, column} - (wrapped ? {P+3{1'b0}} : {{P+2-L{1'b0}}, shear});
    wire [L-1:0] row = reach[L-1:0];
    wire in_volume = wrapped || reach[P+2:L] == {P+3-L{1'b0}};

    // Where the modules are read: along u each has the one voxel that its number and the other coordinates leave.
    wire [L-1:0] along_v = reversed[1] ? ~row : row;
    wire [L-1:0] along_w = reversed[2] ? ~depth : depth;
    wire [N*VOXEL_BITS-1:0] words;
    wire [N*VOXEL_BITS-1:0] beam;
    genvar m;
    generate
        for (m = 0; m < N; m = m + 1) begin : module_
            localparam [L-1:0] NUMBER = L'(m);
            wire [L-1:0] along_u = NUMBER - along_v - along_w;
            wire [L-1:0] x = axis_u == 2'd0 ? along_u : axis_v == 2'd0 ? along_v : along_w;
            wire [L-1:0] y = axis_u == 2'd1 ? along_u : axis_v == 2'd1 ? along_v : along_w;
            wire [L-1:0] z = axis_u == 2'd2 ? along_u : axis_v == 2'd2 ? along_v : along_w;
            // verilator lint_off UNUSEDSIGNAL
            wire [35:0] address;  // A module has N x N words.
            // verilator lint_on UNUSEDSIGNAL
            cube3_cfb #(
                .LANES(N), .NX(N), .NY(N), .NZ(N)
            ) place (
                .x({{12-L{1'b0}}, x}), .y({{12-L{1'b0}}, y}), .z({{12-L{1'b0}}, z}),
                /* verilator lint_off PINCONNECTEMPTY */
                .module_number(), // It is m: along_u was chosen for it.
                /* verilator lint_on PINCONNECTEMPTY */
                .address(address)
            );
            reg [VOXEL_BITS-1:0] memory[0:N*N-1];
            always @(posedge clk) begin
                if (write && write_address[2*L+:L] == NUMBER) memory[write_address[2*L-1:0]] <= write_data;
            end
            assign words[m*VOXEL_BITS+:VOXEL_BITS] = memory[address[2*L-1:0]];

            // Output network, `output_lane`: lane m is voxel u of the beam with (u + v + w) mod N = m.
            wire [L-1:0] u = NUMBER - row - depth;
            wire [L-1:0] from = (reversed[0] ? ~u : u) + along_v + along_w;
            assign beam[m*VOXEL_BITS+:VOXEL_BITS] = words[from*VOXEL_BITS+:VOXEL_BITS];
        end
    endgenerate

    assign token = {beam, in_volume, row, depth, plane};
endmodule
