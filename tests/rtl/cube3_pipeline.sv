// Cube-3 from the skewed modules of the frame buffer to the pixels: a frame of a cubic volume of N voxels a side on N lanes.
//
//   cfb -[beams]-> bus -[aligned]-> dsb -[rays]-> trilin -[samples]-> abc -[shaded]-> cone -[pixels]-> host
//
// Equals `Machine<Cycle>` in sim/src/machine.rs in every bit and every cycle, for a parallel view of the default machine: ideal
// memory, a bus with a channel for each lane, one board, a folded tree, a host that takes every pixel at once. Every unit does its
// arithmetic in the cycle in which it pushes a token; the latency of the channel behind it is the depth that a synthesis tool may
// retime its registers into.
//
// While `rst` is high, `load` writes registers (`load_voxel` 0: their number in the address) and voxels (`load_voxel` 1:
// {module, address in the module}). The frame starts in the first cycle in which `rst` is low, and `done` rises behind the last
// pixel. Registers, one 32-bit word each:
//
//    0 slots           1 planes          2 wrapped         3 offset o        4, 5, 6 voxel axis of u, v, w
//    7 reversed axes (bit 0 u, 1 v, 2 w)                   8 gradient        9, 10 its weights along u, v
//   11, 12, 13 factors of its components                  14 border         15, 16 threshold, lowest and highest
//   17 shading        18 ambient        19 two-sided      20 mode           21 opaque
//   22, 23 weight of the weighted sum, low word and high word
//   24 + 12 l         light l = 0, 1: direction, halfway, diffuse, specular, three words each
//   48                X(k), k = 0 to N; then the N weights along u; then Y(k), k = 0 to N; then the N weights along v
//
// The tables are memories in each lane: *_FILE names what is loaded into them.
module cube3_pipeline #(
    // Voxels a side and lanes, a power of two from 4 on; PADDED = 1 has room for slots that are not shared.
    parameter integer N = 8,
    parameter integer PADDED = 0,
    parameter integer METHOD = 12,
    parameter integer LIGHTS = 2,
    parameter integer VOXEL_BITS = 16,
    parameter integer WEIGHT_BITS = 8,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer GRADIENT_BITS = 17,
    parameter integer NORMAL_BITS = 12,
    parameter integer TABLE_BITS = 12,
    parameter integer COLOUR_BITS = 12,
    parameter integer OPACITY_BITS = 12,
    parameter integer ACCUMULATOR_BITS = 16,
    parameter integer NEAREST = 1,
    parameter integer KEPT_BITS = 0,
    parameter integer ROOT_BITS = 8,
    parameter integer POWER_BITS = 10,
    parameter ROOT_FILE = "",
    parameter OPACITY_FILE = "",
    parameter COLOUR_FILE = "",
    parameter POWER_FILE = "",
    // Derived.
    parameter integer R = $clog2(N) + 2,
    parameter integer A = ACCUMULATOR_BITS
) (
    input wire clk,
    input wire rst,
    input wire load,
    input wire load_voxel,
    // verilator lint_off UNUSEDSIGNAL
    input wire [31:0] load_address,  // As many bits as registers and voxels need.
    // verilator lint_on UNUSEDSIGNAL
    input wire [31:0] load_data,
    // The pixels of a slot: their number, and ray and colour of each, in order of depth.
    output wire pixel_valid,
    output wire [1:0] pixel_count,
    output wire [3*R-1:0] pixel_u,
    output wire [3*R-1:0] pixel_v,
    output wire [12*A-1:0] pixel_rgba,
    output reg done,
    // Cycles so far; and of each unit, cfb, bus, dsb.write, dsb.read, trilin, abc, cone, host: {blocked, starved, busy}.
    output reg [31:0] cycles,
    output wire [8*96-1:0] accounts,
    // This cycle's activity of each unit: 0 busy, 1 starved, 2 blocked.
    output wire [15:0] activities,
    // Tokens that each channel has held, summed over the cycles.
    output wire [6*32-1:0] occupancies,
    // Words saturated in samples that are not transparent, and in pixels.
    output reg [31:0] shading_overflows,
    output reg [31:0] pixel_overflows
);
    localparam integer L = $clog2(N);
    localparam integer P = L + PADDED;
    localparam integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS;
    localparam integer W1 = WEIGHT_BITS + 1;
    localparam integer B1 = NORMAL_BITS + 1;
    localparam integer C4 = COLOUR_BITS + 4;
    localparam integer REGISTERS = 48 + 4 * N + 2;

    // Registers.
    reg [31:0] register[0:REGISTERS-1];
    always @(posedge clk) if (load && !load_voxel) register[load_address[$clog2(REGISTERS)-1:0]] <= load_data;

    wire [P:0] slots = register[0][P:0];
    wire [P:0] planes = register[1][P:0];
    wire wrapped = register[2][0];
    wire [W1-1:0] offset = register[3][W1-1:0];
    wire gradient = register[8][0];
    wire [2*W1-1:0] gradient_weight = {register[10][W1-1:0], register[9][W1-1:0]};
    wire [3*17-1:0] factor = {register[13][16:0], register[12][16:0], register[11][16:0]};
    wire [2*S-1:0] threshold = {register[16][S-1:0], register[15][S-1:0]};
    wire [3*LIGHTS*B1-1:0] light_direction;
    wire [3*LIGHTS*B1-1:0] light_halfway;
    wire [3*LIGHTS*C4-1:0] light_diffuse;
    wire [3*LIGHTS*C4-1:0] light_specular;
    wire [N*(L+1)-1:0] columns_u;
    wire [N*(L+1)-1:0] columns_v;
    wire [N*W1-1:0] weights_u;
    wire [N*W1-1:0] weights_v;
    wire [2*N-1:0] spans_u;
    wire [2*N-1:0] spans_v;
    genvar i, k;
    generate
        for (i = 0; i < 3 * LIGHTS; i = i + 1) begin : light
            localparam integer AT = 24 + i / 3 * 12 + i % 3;
            assign light_direction[i*B1+:B1] = register[AT][B1-1:0];
            assign light_halfway[i*B1+:B1] = register[AT+3][B1-1:0];
            assign light_diffuse[i*C4+:C4] = register[AT+6][C4-1:0];
            assign light_specular[i*C4+:C4] = register[AT+9][C4-1:0];
        end
        for (k = 0; k < N; k = k + 1) begin : template_
            localparam integer U = 48;
            localparam integer V = 48 + 2 * N + 1;
            assign columns_u[k*(L+1)+:L+1] = register[U+k][L:0];
            assign columns_v[k*(L+1)+:L+1] = register[V+k][L:0];
            assign weights_u[k*W1+:W1] = register[U+N+1+k][W1-1:0];
            assign weights_v[k*W1+:W1] = register[V+N+1+k][W1-1:0];
            // Columns that sample k needs beyond its own: a step to the next plane, and the neighbour that has a weight. The last
            // plane has samples only where they lie on planes.
            wire on_plane = offset == {W1{1'b0}};
            wire [1:0] step_u = on_plane || register[U+k][L:0] == register[U+k+1][L:0] ? 2'd0 : 2'd1;
            wire [1:0] step_v = on_plane || register[V+k][L:0] == register[V+k+1][L:0] ? 2'd0 : 2'd1;
            wire [1:0] reach_u = weights_u[k*W1+:W1] == {W1{1'b0}} ? 2'd0 : 2'd1;
            wire [1:0] reach_v = weights_v[k*W1+:W1] == {W1{1'b0}} ? 2'd0 : 2'd1;
            wire none = k == N - 1 && !on_plane;
            assign spans_u[2*k+:2] = none ? 2'd3 : step_u + reach_u;
            assign spans_v[2*k+:2] = none ? 2'd3 : step_v + reach_v;
        end
    endgenerate
    wire [L:0] shear_u = columns_u[(N-1)*(L+1)+:L+1];
    wire [L:0] shear_v = columns_v[(N-1)*(L+1)+:L+1];
    wire [1:0] closes = {wrapped && shear_v != {L + 1{1'b0}}, wrapped && shear_u != {L + 1{1'b0}}};

    // Channels: capacities and latencies of the default machine.
    localparam integer BEAM = P + 2 * L + 1 + N * VOXEL_BITS;
    localparam integer ALIGNED = P + L + 1 + (1 + PADDED) * N * VOXEL_BITS;
    localparam integer PAIR = 2 * P + 2 * N * VOXEL_BITS;
    localparam integer SAMPLES = 2 * P + N * S;
    localparam integer SHADED = 2 * P + N * (1 + S + OPACITY_BITS + 3 * COLOUR_BITS);
    localparam integer PIXELS = 2 + 6 * R + 12 * A;
    wire [5:0] push;
    wire [5:0] pop;
    wire [5:0] can_push;
    wire [5:0] valid;
    wire [6*8-1:0] occupancy;
    wire [BEAM-1:0] beam_in, beam;
    wire [ALIGNED-1:0] aligned_in, aligned;
    wire [PAIR-1:0] pair_in, pair;
    wire [SAMPLES-1:0] samples_in, samples;
    wire [SHADED-1:0] shaded_in, shaded;
    wire [PIXELS-1:0] pixels_in, pixels;
    cube3_channel #(.WIDTH(BEAM), .CAPACITY(4), .LATENCY(2)) beams_channel (
        .clk(clk), .rst(rst), .push(push[0]), .in_data(beam_in), .pop(pop[0]), .can_push(can_push[0]), .valid(valid[0]),
        .front(beam), .occupancy(occupancy[0+:8])
    );
    cube3_channel #(.WIDTH(ALIGNED), .CAPACITY(4), .LATENCY(2)) aligned_channel (
        .clk(clk), .rst(rst), .push(push[1]), .in_data(aligned_in), .pop(pop[1]), .can_push(can_push[1]), .valid(valid[1]),
        .front(aligned), .occupancy(occupancy[8+:8])
    );
    cube3_channel #(.WIDTH(PAIR), .CAPACITY(4), .LATENCY(2)) rays_channel (
        .clk(clk), .rst(rst), .push(push[2]), .in_data(pair_in), .pop(pop[2]), .can_push(can_push[2]), .valid(valid[2]),
        .front(pair), .occupancy(occupancy[16+:8])
    );
    cube3_channel #(.WIDTH(SAMPLES), .CAPACITY(8), .LATENCY(6)) samples_channel (
        .clk(clk), .rst(rst), .push(push[3]), .in_data(samples_in), .pop(pop[3]), .can_push(can_push[3]), .valid(valid[3]),
        .front(samples), .occupancy(occupancy[24+:8])
    );
    cube3_channel #(.WIDTH(SHADED), .CAPACITY(18), .LATENCY(16)) shaded_channel (
        .clk(clk), .rst(rst), .push(push[4]), .in_data(shaded_in), .pop(pop[4]), .can_push(can_push[4]), .valid(valid[4]),
        .front(shaded), .occupancy(occupancy[32+:8])
    );
    cube3_channel #(.WIDTH(PIXELS), .CAPACITY(10), .LATENCY(8)) pixels_channel (
        .clk(clk), .rst(rst), .push(push[5]), .in_data(pixels_in), .pop(pop[5]), .can_push(can_push[5]), .valid(valid[5]),
        .front(pixels), .occupancy(occupancy[40+:8])
    );

    // Units.
    cube3_cfb_unit #(.N(N), .PADDED(PADDED), .VOXEL_BITS(VOXEL_BITS)) cfb (
        .clk(clk), .rst(rst), .planes(planes), .wrapped(wrapped), .axis_u(register[4][1:0]), .axis_v(register[5][1:0]),
        .reversed(register[7][2:0]), .rows(columns_v), .write(load && load_voxel),
        .write_address(load_address[3*L-1:0]), .write_data(load_data[VOXEL_BITS-1:0]), .can_push(can_push[0]), .push(push[0]),
        .token(beam_in), .activity(activities[1:0])
    );
    cube3_bus_unit #(.N(N), .PADDED(PADDED), .VOXEL_BITS(VOXEL_BITS)) bus (
        .wrapped(wrapped), .columns(columns_u), .valid(valid[0]), .front(beam), .pop(pop[0]), .can_push(can_push[1]),
        .push(push[1]), .token(aligned_in), .activity(activities[3:2])
    );
    cube3_dsb_unit #(.N(N), .PADDED(PADDED), .VOXEL_BITS(VOXEL_BITS)) dsb (
        .clk(clk), .rst(rst), .slots(slots), .planes(planes), .closes_v(closes[1]), .valid(valid[1]), .front(aligned),
        .pop(pop[1]), .can_push(can_push[2]), .push(push[2]), .token(pair_in), .write_activity(activities[5:4]),
        .read_activity(activities[7:6])
    );
    cube3_trilin_unit #(
        .N(N), .PADDED(PADDED), .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS),
        .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS), .NEAREST(NEAREST)
    ) trilin (
        .clk(clk), .rst(rst), .slots(slots), .wrapped(wrapped), .closes_u(closes[0]), .offset(offset), .columns_u(columns_u),
        .columns_v(columns_v), .spans_u(spans_u), .spans_v(spans_v), .weights_u(weights_u), .weights_v(weights_v),
        .valid(valid[2]), .front(pair), .pop(pop[2]), .can_push(can_push[3]), .push(push[3]), .token(samples_in),
        .activity(activities[9:8])
    );
    wire [L+3:0] sample_overflows;
    cube3_abc_unit #(
        .N(N), .PADDED(PADDED), .METHOD(METHOD), .LIGHTS(LIGHTS), .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS),
        .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS), .GRADIENT_BITS(GRADIENT_BITS), .NORMAL_BITS(NORMAL_BITS),
        .TABLE_BITS(TABLE_BITS), .COLOUR_BITS(COLOUR_BITS), .OPACITY_BITS(OPACITY_BITS), .NEAREST(NEAREST),
        .KEPT_BITS(KEPT_BITS), .ROOT_BITS(ROOT_BITS), .POWER_BITS(POWER_BITS), .ROOT_FILE(ROOT_FILE),
        .OPACITY_FILE(OPACITY_FILE), .COLOUR_FILE(COLOUR_FILE), .POWER_FILE(POWER_FILE)
    ) abc (
        .clk(clk), .rst(rst), .slots(slots), .planes(planes), .wrapped(wrapped), .closes(closes), .columns_u(columns_u),
        .columns_v(columns_v), .spans_u(spans_u), .spans_v(spans_v), .gradient(gradient), .gradient_weight(gradient_weight),
        .factor(factor), .border(register[14][S-1:0]), .threshold(threshold), .shading(register[17][0]),
        .ambient(register[18][C4-1:0]), .two_sided(register[19][0]), .light_direction(light_direction),
        .light_halfway(light_halfway), .light_diffuse(light_diffuse), .light_specular(light_specular), .valid(valid[3]),
        .front(samples), .pop(pop[3]), .can_push(can_push[4]), .push(push[4]), .token(shaded_in),
        .activity(activities[11:10]), .overflows(sample_overflows)
    );
    wire [3:0] group_overflows;
    cube3_cone_unit #(
        .N(N), .PADDED(PADDED), .VOXEL_BITS(VOXEL_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
        .COLOUR_BITS(COLOUR_BITS), .OPACITY_BITS(OPACITY_BITS), .ACCUMULATOR_BITS(ACCUMULATOR_BITS), .NEAREST(NEAREST)
    ) cone (
        .wrapped(wrapped), .columns_u(columns_u), .columns_v(columns_v), .mode(register[20][2:0]),
        .opaque(register[21][OPACITY_BITS-1:0]), .sum_weight({register[23][0], register[22]}), .valid(valid[4]),
        .front(shaded), .pop(pop[4]), .can_push(can_push[5]), .push(push[5]), .token(pixels_in),
        .activity(activities[13:12]), .overflows(group_overflows)
    );

    // The host takes the pixels of a slot in every cycle: sim/src/host_port.rs.
    assign pop[5] = valid[5];
    assign activities[15:14] = valid[5] ? 2'd0 : 2'd1;
    assign pixel_valid = valid[5] && !rst && !done;
    assign pixel_count = pixels[1:0];
    assign pixel_u = pixels[2+:3*R];
    assign pixel_v = pixels[2+3*R+:3*R];
    assign pixel_rgba = pixels[2+6*R+:12*A];
    reg [P:0] received_slots;
    reg [P:0] received_planes;
    wire [P:0] slots_after = received_slots + 1'b1;
    wire [P:0] planes_after = received_planes + 1'b1;
    always @(posedge clk) begin
        if (rst) begin
            received_slots <= {P + 1{1'b0}};
            received_planes <= {P + 1{1'b0}};
            done <= 1'b0;
            cycles <= 32'd0;
            shading_overflows <= 32'd0;
            pixel_overflows <= 32'd0;
        end else if (!done) begin
            cycles <= cycles + 1'b1;
            if (push[4]) shading_overflows <= shading_overflows + {{28 - L{1'b0}}, sample_overflows};
            if (push[5]) pixel_overflows <= pixel_overflows + {28'd0, group_overflows};
            if (valid[5]) begin
                received_slots <= slots_after == slots ? {P + 1{1'b0}} : slots_after;
                if (slots_after == slots) begin
                    received_planes <= planes_after;
                    done <= planes_after == planes;
                end
            end
        end
    end

    // Accounts of the units, and of the channels.
    generate
        for (i = 0; i < 8; i = i + 1) begin : account
            reg [31:0] busy;
            reg [31:0] starved;
            reg [31:0] blocked;
            always @(posedge clk) begin
                if (rst) begin
                    busy <= 32'd0;
                    starved <= 32'd0;
                    blocked <= 32'd0;
                end else if (!done) begin
                    if (activities[2*i+:2] == 2'd0) busy <= busy + 1'b1;
                    if (activities[2*i+:2] == 2'd1) starved <= starved + 1'b1;
                    if (activities[2*i+:2] == 2'd2) blocked <= blocked + 1'b1;
                end
            end
            assign accounts[96*i+:96] = {blocked, starved, busy};
        end
        for (i = 0; i < 6; i = i + 1) begin : held
            reg [31:0] sum;
            always @(posedge clk) begin
                if (rst) sum <= 32'd0;
                else if (!done) sum <= sum + {24'd0, occupancy[8*i+:8]};
            end
            assign occupancies[32*i+:32] = sum;
        end
    endgenerate
endmodule
