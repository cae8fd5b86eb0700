// The fast bus in parallel projection: a beam turned from the frame buffer's lane order to the skewed buffer's.
//
// Pfister et al. 1995, section 3.1. Equals cube3_dsb::golden::rotation and the lanes of cube3_dsb::lanes::Rotator, for wrapped slots and a
// beam that fills the lanes (n = LANES). Voxel (u, v, w) comes in lane (u + v + w) mod n; its slot u - X(k) goes to lane
// (slot + k) mod n, so the rotation is -(X(k) + v) mod n, whatever the plane and the depth.
module cube3_bus #(
    parameter integer VOXEL_BITS = 16,
    parameter integer LANES = 8
) (
    // A rotation does not depend on them.
    // verilator lint_off UNUSEDSIGNAL
    input  wire [11:0]                 plane,
    // verilator lint_on UNUSEDSIGNAL
    input  wire [11:0]                 row,
    // verilator lint_off UNUSEDSIGNAL
    input  wire [11:0]                 depth,
    // verilator lint_on UNUSEDSIGNAL
    input  wire [11:0]                 column,
    input  wire [LANES*VOXEL_BITS-1:0] voxel,
    output wire [11:0]                 rotation,
    output wire [LANES*VOXEL_BITS-1:0] out
);
    localparam integer L = LANES > 1 ? $clog2(LANES) : 1;
    localparam [12:0] N = 13'(LANES);

    // How far towards lane 0, and the same turn the other way.
    wire [12:0] back = ({1'b0, row} + {1'b0, column}) % N;
    assign rotation = back == 13'd0 ? 12'd0 : 12'(N - back);

    cube3_turn #(.ITEMS(LANES), .WIDTH(VOXEL_BITS), .AMOUNT_BITS(L)) turn (
        .amount(L'(back)), .items(voxel), .turned(out)
    );
endmodule
