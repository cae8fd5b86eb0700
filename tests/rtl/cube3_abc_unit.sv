// The ABC units on their channels: rays of samples in, rays of coloured samples out, a plane and a ray later.
//
//     [samples] --> ring of planes (and the first two) --> 3 x 3 rays --> gradient, table, light --> [shaded]
//
// Cube-3, section 4: N units, one for each depth. A ray is shaded when its neighbours in the planes above and below have come. Where
// slots are shared, the last plane's neighbour is the first, so the first is shaded last; rays of a plane likewise. Without a
// gradient rays pass straight through. Equals crates/abc/src/unit.rs (`AbcUnit::tick`, `AbcSpec`, `Shader`) and, for each sample,
// golden.rs (`shade`).
//
// A ray that is taken is there for the ray that is given in the same cycle: it bypasses the memory. Planes and slots that are read
// together differ in the lowest bits of their numbers, so banks by those bits need one read port each.
// Tokens: [samples] {samples, slot, plane}; [shaded] {leaves, slot, plane}, in lane order; a leaf is {blue, green, red, opacity,
// sample, present}.
module cube3_abc_unit #(
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
    parameter integer NEAREST = 1,
    parameter integer KEPT_BITS = 0,
    parameter integer ROOT_BITS = 8,
    parameter integer POWER_BITS = 10,
    parameter ROOT_FILE = "",
    parameter OPACITY_FILE = "",
    parameter COLOUR_FILE = "",
    parameter POWER_FILE = "",
    parameter integer L = $clog2(N),
    parameter integer P = L + PADDED,
    parameter integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS,
    parameter integer W1 = WEIGHT_BITS + 1,
    parameter integer B1 = NORMAL_BITS + 1,
    parameter integer C4 = COLOUR_BITS + 4,
    parameter integer LEAF = 1 + S + OPACITY_BITS + 3 * COLOUR_BITS,
    parameter integer IN = 2 * P + N * S,
    parameter integer OUT = 2 * P + N * LEAF
) (
    input wire clk,
    input wire rst,
    input wire [P:0] slots,
    input wire [P:0] planes,
    input wire wrapped,
    input wire [1:0] closes,
    input wire [N*(L+1)-1:0] columns_u,
    input wire [N*(L+1)-1:0] columns_v,
    input wire [N*2-1:0] spans_u,
    input wire [N*2-1:0] spans_v,
    // Whether there is a gradient, and rays wait for their neighbours.
    input wire gradient,
    input wire [2*W1-1:0] gradient_weight,
    input wire [3*17-1:0] factor,
    input wire [S-1:0] border,
    input wire [2*S-1:0] threshold,
    // Whether colours are lit.
    input wire shading,
    input wire [C4-1:0] ambient,
    input wire two_sided,
    input wire [3*LIGHTS*B1-1:0] light_direction,
    input wire [3*LIGHTS*B1-1:0] light_halfway,
    input wire [3*LIGHTS*C4-1:0] light_diffuse,
    input wire [3*LIGHTS*C4-1:0] light_specular,
    // [samples]
    input wire valid,
    input wire [IN-1:0] front,
    output wire pop,
    // [shaded]
    input wire can_push,
    output wire push,
    output wire [OUT-1:0] token,
    output wire [1:0] activity,
    // Words saturated in the samples of the ray that is pushed, those that are not transparent.
    output reg [L+3:0] overflows
);
    localparam integer C = L + 2;
    localparam integer G = GRADIENT_BITS + KEPT_BITS;
    // Planes in the ring, a power of two so that the lowest bits of a plane's number are its place.
    localparam integer RING_BITS = 2;
    localparam [P+1:0] RING = (P+2)'(1 << RING_BITS);
    // The number of a shared slot or plane: the lowest bits.
    localparam [P-1:0] SHARED = P'(N - 1);

    // Which ray is given next: the e-th has the number of plane and slot that follows, where the last is followed by the first.
    reg [P-1:0] give_plane;
    reg [P-1:0] give_slot;
    reg done;
    wire [P:0] plane_after = {1'b0, give_plane} + 1'b1;
    wire [P:0] slot_after = {1'b0, give_slot} + 1'b1;
    wire last_plane = plane_after == planes;
    wire last_slot = slot_after == slots;
    wire turn_v = gradient && closes[1];
    wire turn_u = gradient && closes[0];
    wire [P-1:0] plane = !turn_v ? give_plane : last_plane ? {P{1'b0}} : plane_after[P-1:0];
    wire [P-1:0] slot = !turn_u ? give_slot : last_slot ? {P{1'b0}} : slot_after[P-1:0];

    // Takes a ray where the ring has a buffer for its plane: the plane above the one being shaded is still needed.
    wire [P-1:0] in_plane = front[P-1:0];
    wire [P-1:0] in_slot = front[P+:P];
    wire [P-1:0] above = plane == {P{1'b0}} ? {P{1'b0}} : plane - 1'b1;
    wire [P-1:0] oldest = !gradient ? plane : turn_v && last_plane ? give_plane : above;
    wire room = done || {2'b00, in_plane} < {2'b00, oldest} + RING;
    assign pop = valid && room;
    wire [N*S-1:0] in_ray;
    cube3_turn #(.ITEMS(N), .WIDTH(S), .AMOUNT_BITS(L)) turn_in (
        .amount(in_slot[L-1:0]), .items(front[2*P+:N*S]), .turned(in_ray)
    );

    // The newest ray that has been taken, this cycle's included; none before the first.
    reg any;
    reg [2*P-1:0] newest;
    wire taken_any = any || pop;
    wire [2*P-1:0] taken = pop ? {in_plane, in_slot} : newest;

    // Gives a ray when the last of its neighbours has been taken.
    wire [P-1:0] end_plane = planes[P-1:0] - 1'b1;
    wire [P-1:0] end_slot = slots[P-1:0] - 1'b1;
    wire [P-1:0] needed_plane =
        turn_v && plane == {P{1'b0}} ? end_plane : !gradient || plane == end_plane ? plane : plane + 1'b1;
    wire [P-1:0] needed_slot =
        turn_u && slot == {P{1'b0}} ? end_slot : !gradient || slot == end_slot ? slot : slot + 1'b1;
    wire ready = !done && taken_any && taken >= {needed_plane, needed_slot};
    assign push = ready && can_push;
    assign activity = pop || push ? 2'd0 : (valid && !room) || (ready && !can_push) ? 2'd2 : 2'd1;

    always @(posedge clk) begin
        if (rst) begin
            give_plane <= {P{1'b0}};
            give_slot <= {P{1'b0}};
            done <= 1'b0;
            any <= 1'b0;
            newest <= {2 * P{1'b0}};
        end else begin
            any <= taken_any;
            newest <= taken;
            if (push) begin
                give_slot <= last_slot ? {P{1'b0}} : slot_after[P-1:0];
                if (last_slot) begin
                    give_plane <= plane_after[P-1:0];
                    done <= last_plane;
                end
            end
        end
    end

    // Planes of samples, each a ray of every slot, in order of depth.
    reg [N*S-1:0] ring[0:(1<<(RING_BITS+P))-1];
    reg [N*S-1:0] first[0:(1<<(1+P))-1];
    wire in_first = in_plane[P-1:1] == {P - 1{1'b0}};
    always @(posedge clk) begin
        if (!rst && pop) begin
            ring[{in_plane[RING_BITS-1:0], in_slot}] <= in_ray;
            if (in_first) first[{in_plane[0], in_slot}] <= in_ray;
        end
    end

    // Which samples of the ray and of its neighbours lie in the volume.
    wire [N*C-1:0] column_u;
    wire [N*C-1:0] column_v;
    wire [9*N-1:0] inside_u;
    wire [9*N-1:0] inside_v;
    cube3_place_unit #(.N(N), .PADDED(PADDED)) place_u (
        .slot(slot), .wrapped(wrapped), .columns(columns_u), .spans(spans_u), .column(column_u),
        /* verilator lint_off PINCONNECTEMPTY */
        .turns(), .held_in()
        /* verilator lint_on PINCONNECTEMPTY */
    );
    cube3_place_unit #(.N(N), .PADDED(PADDED)) place_v (
        .slot(plane), .wrapped(wrapped), .columns(columns_v), .spans(spans_v), .column(column_v),
        /* verilator lint_off PINCONNECTEMPTY */
        .turns(), .held_in()
        /* verilator lint_on PINCONNECTEMPTY */
    );
    cube3_neighbour_unit #(.N(N)) neighbour_u (.column(column_u), .columns(columns_u), .spans(spans_u), .held_in(inside_u));
    cube3_neighbour_unit #(.N(N)) neighbour_v (.column(column_v), .columns(columns_v), .spans(spans_v), .held_in(inside_v));

    // The rays of the neighbourhood, [v][u], in order of depth.
    // verilator lint_off UNUSEDSIGNAL
    wire [9*N*S-1:0] rays;  // No method reads every depth of every ray.
    // verilator lint_on UNUSEDSIGNAL
    genvar u, v, w, k;
    generate
        for (v = 0; v < 3; v = v + 1) begin : across
            wire [P-1:0] row = v == 0 ? plane - 1'b1 : v == 1 ? plane : plane + 1'b1;
            wire [P-1:0] there = wrapped ? row & SHARED : row;
            for (u = 0; u < 3; u = u + 1) begin : along
                wire [P-1:0] ray = u == 0 ? slot - 1'b1 : u == 1 ? slot : slot + 1'b1;
                wire [P-1:0] at = wrapped ? ray & SHARED : ray;
                wire kept = closes[1] && there[P-1:1] == {P - 1{1'b0}};
                wire [N*S-1:0] held = kept ? first[{there[0], at}] : ring[{there[RING_BITS-1:0], at}];
                wire bypass = pop && in_plane == there && in_slot == at;
                assign rays[(v*3+u)*N*S+:N*S] = bypass ? in_ray : held;
            end
        end
    endgenerate

    wire [N*LEAF-1:0] leaves;
    wire [6*N-1:0] saturated;
    generate
        for (k = 0; k < N; k = k + 1) begin : lane
            // The neighbourhood of the sample, [w][v][u] as golden.rs numbers it; what the method does not read is 0.
            wire [27*S-1:0] s;
            for (w = 0; w < 3; w = w + 1) begin : slice
                for (v = 0; v < 3; v = v + 1) begin : across
                    for (u = 0; u < 3; u = u + 1) begin : along
                        localparam integer U = u - 1;
                        localparam integer V = v - 1;
                        localparam integer W = w - 1;
                        localparam integer FAR = U * U + V * V + W * W;
                        localparam [0:0] READS =
                            METHOD == 6 || METHOD == 61 ? FAR == 1 :
                            METHOD == 10 ? FAR == 1 || (FAR == 2 && (U + V) * W < 0) :
                            METHOD == 12 ? FAR == 1 || (W != 0 && U * W <= 0 && V * W <= 0) : 1'b1;
                        if (FAR != 0 && !READS) begin : unread
                            assign s[(w*9+v*3+u)*S+:S] = {S{1'b0}};
                        end else if (k + w < 1 || k + w > N) begin : beyond
                            assign s[(w*9+v*3+u)*S+:S] = border;
                        end else begin : read
                            wire there_is = inside_u[(w*3+u)*N+k] && inside_v[(w*3+v)*N+k];
                            assign s[(w*9+v*3+u)*S+:S] = there_is ? rays[((v*3+u)*N+k+w-1)*S+:S] : border;
                        end
                    end
                end
            end
            wire [3*G-1:0] g;
            wire [2:0] gradient_overflow;
            cube3_gradient #(
                .METHOD(METHOD), .PERSPECTIVE(0), .FACTORS(1), .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS),
                .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS), .GRADIENT_BITS(GRADIENT_BITS), .KEPT_BITS(KEPT_BITS),
                .NEAREST(NEAREST)
            ) estimator (
                .s(s), .here(gradient_weight), .behind(gradient_weight), .ahead(gradient_weight), .mirrored(2'b00),
                .factor(factor), .nearness(17'd65536), .g(g), .overflow(gradient_overflow)
            );
            wire [3*B1-1:0] normal;
            wire [G:0] magnitude;
            cube3_normalise #(
                .GRADIENT_BITS(GRADIENT_BITS), .KEPT_BITS(KEPT_BITS), .NORMAL_BITS(NORMAL_BITS), .ROOT_BITS(ROOT_BITS),
                .ROOT_FILE(ROOT_FILE)
            ) normaliser (.g(g), .direction(normal), .magnitude(magnitude));
            wire visible;
            wire [OPACITY_BITS-1:0] opacity;
            wire [3*COLOUR_BITS-1:0] colour;
            wire [S-1:0] sample = s[13*S+:S];
            cube3_classify #(
                .VOXEL_BITS(VOXEL_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS), .GRADIENT_BITS(GRADIENT_BITS),
                .KEPT_BITS(KEPT_BITS), .TABLE_BITS(TABLE_BITS), .COLOUR_BITS(COLOUR_BITS), .OPACITY_BITS(OPACITY_BITS),
                .ROWS(1), .CLASSES(1), .OPACITY_FILE(OPACITY_FILE), .COLOUR_FILE(COLOUR_FILE)
            ) tables (
                .sample(sample), .magnitude(magnitude), .length_class(4'd0), .threshold(threshold), .row_shift(5'd0),
                .visible(visible), .opacity(opacity), .colour(colour)
            );
            wire [3*(COLOUR_BITS+8)-1:0] diffuse;
            wire [3*(COLOUR_BITS+8)-1:0] specular;
            cube3_phong #(
                .NORMAL_BITS(NORMAL_BITS), .COLOUR_BITS(COLOUR_BITS), .NEAREST(NEAREST), .LIGHTS(LIGHTS),
                .POWER_BITS(POWER_BITS), .POWER_FILE(POWER_FILE)
            ) light (
                .normal(normal), .ambient(ambient), .two_sided(two_sided), .light_direction(light_direction),
                .light_halfway(light_halfway), .light_diffuse(light_diffuse), .light_specular(light_specular),
                .diffuse(diffuse), .specular(specular)
            );
            wire [3*COLOUR_BITS-1:0] lit;
            wire [2:0] lit_overflow;
            cube3_lit #(
                .COLOUR_BITS(COLOUR_BITS), .NEAREST(NEAREST)
            ) lighting (.colour(colour), .diffuse(diffuse), .specular(specular), .value(lit), .overflow(lit_overflow));
            wire present = visible && inside_u[4*N+k] && inside_v[4*N+k];
            wire shown = present && opacity != {OPACITY_BITS{1'b0}};
            wire [3*COLOUR_BITS-1:0] shown_colour = !shown ? {3 * COLOUR_BITS{1'b0}} : shading ? lit : colour;
            wire [LEAF-1:0] leaf = {shown_colour, opacity, sample, 1'b1};
            assign leaves[k*LEAF+:LEAF] = present ? leaf : {LEAF{1'b0}};
            assign saturated[6*k+:3] = shown && gradient ? gradient_overflow : 3'b000;
            assign saturated[6*k+3+:3] = shown && shading ? lit_overflow : 3'b000;
        end
    endgenerate

    integer i;
    always @* begin
        overflows = {L + 4{1'b0}};
        for (i = 0; i < 6 * N; i = i + 1) overflows = overflows + {{L + 3{1'b0}}, saturated[i]};
    end

    wire [N*LEAF-1:0] turned;
    cube3_turn #(.ITEMS(N), .WIDTH(LEAF), .AMOUNT_BITS(L)) turn_out (
        .amount(-slot[L-1:0]), .items(leaves), .turned(turned)
    );
    assign token = {turned, slot, plane};
endmodule
