// Where an element of a 2-D skewed buffer lies: slot j at depth k is in module (j + k) mod LANES.
//
// Pfister et al. 1995, section 3.1. Equals cube3_dsb::golden::module, beam_lane, ray_lane: the place of a slot in the lane order of a
// beam, the place of a depth in the lane order of a ray, both in chunks of LANES. Places are below 4096.
module cube3_dsb #(
    parameter integer LANES = 8
) (
    input  wire [11:0] slot,
    input  wire [11:0] depth,
    output wire [11:0] beam_module,
    output wire [11:0] beam_place,
    output wire [11:0] ray_place
);
    localparam [12:0] N = 13'(LANES);
    wire [12:0] lane = ({1'b0, slot} + {1'b0, depth}) % N;

    assign beam_module = 12'(lane);
    assign beam_place = 12'({1'b0, slot} / N * N + lane);
    assign ray_place = 12'({1'b0, depth} / N * N + lane);
endmodule
