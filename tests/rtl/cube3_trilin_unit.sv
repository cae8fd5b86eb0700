// The interpolators on their channels: a pair of discrete rays in, a ray of samples out.
//
//     [rays] --> ray j of planes i, i+1 --> with ray j-1 --> [samples] of ray j-1
//
// Cube-3, section 4: N units, one for each depth of a ray. Ray j of a plane is finished by ray j+1; the last by the first where slots
// are shared, which is kept for it, and by nothing where they are not: it leaves while the next plane begins. Equals
// crates/trilin/src/unit.rs (`TrilinUnit::step`, `Interpolator`); every sample takes its 7 lerps, nothing is reused, which changes no bit.
// Tokens: [rays] {ray of the plane below, ray, slot, plane}; [samples] {samples, slot, plane}, in lane order, 0 where there is none.
module cube3_trilin_unit #(
    parameter integer N = 8,
    parameter integer PADDED = 0,
    parameter integer VOXEL_BITS = 16,
    parameter integer WEIGHT_BITS = 8,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer NEAREST = 1,
    parameter integer L = $clog2(N),
    parameter integer P = L + PADDED,
    parameter integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS,
    parameter integer W1 = WEIGHT_BITS + 1,
    parameter integer IN = 2 * P + 2 * N * VOXEL_BITS,
    parameter integer OUT = 2 * P + N * S
) (
    input wire clk,
    input wire rst,
    input wire [P:0] slots,
    input wire wrapped,
    input wire closes_u,
    input wire [W1-1:0] offset,
    input wire [N*(L+1)-1:0] columns_u,
    input wire [N*(L+1)-1:0] columns_v,
    input wire [N*2-1:0] spans_u,
    input wire [N*2-1:0] spans_v,
    input wire [N*W1-1:0] weights_u,
    input wire [N*W1-1:0] weights_v,
    // [rays]
    input wire valid,
    input wire [IN-1:0] front,
    output wire pop,
    // [samples]
    input wire can_push,
    output wire push,
    output wire [OUT-1:0] token,
    output wire [1:0] activity
);
    wire [P-1:0] in_plane = front[P-1:0];
    wire [P-1:0] in_slot = front[P+:P];
    wire [2*N*VOXEL_BITS-1:0] in_pair;
    cube3_turn #(.ITEMS(N), .WIDTH(VOXEL_BITS), .AMOUNT_BITS(L)) turn_ray (
        .amount(in_slot[L-1:0]), .items(front[2*P+:N*VOXEL_BITS]), .turned(in_pair[0+:N*VOXEL_BITS])
    );
    cube3_turn #(.ITEMS(N), .WIDTH(VOXEL_BITS), .AMOUNT_BITS(L)) turn_below (
        .amount(in_slot[L-1:0]), .items(front[2*P+N*VOXEL_BITS+:N*VOXEL_BITS]), .turned(in_pair[N*VOXEL_BITS+:N*VOXEL_BITS])
    );

    // The first pair of the plane and the newest, in order of depth; and the plane whose last ray has been taken and not given.
    reg [2*N*VOXEL_BITS-1:0] first;
    reg [2*N*VOXEL_BITS-1:0] newest;
    reg closing;
    reg [P-1:0] plane;
    reg [P-1:0] slot;
    wire in_first = in_slot == {P{1'b0}};
    wire [P:0] in_slot_after = {1'b0, in_slot} + 1'b1;
    assign pop = valid && (closing || !in_first ? can_push : 1'b1);
    assign push = can_push && (closing || (valid && !in_first));
    assign activity = (closing && !can_push) || (valid && !pop) ? 2'd2 : valid || closing ? 2'd0 : 2'd1;
    always @(posedge clk) begin
        if (rst) closing <= 1'b0;
        else begin
            if (pop) begin
                newest <= in_pair;
                plane <= in_plane;
                slot <= in_slot;
                if (in_first) first <= in_pair;
            end
            if (pop) closing <= in_slot_after == slots;
            else if (push) closing <= 1'b0;
        end
    end

    wire [2*N*VOXEL_BITS-1:0] right = !closing ? in_pair : closes_u ? first : {2 * N * VOXEL_BITS{1'b0}};
    wire [N-1:0] in_u;
    wire [N-1:0] in_v;
    cube3_place_unit #(.N(N), .PADDED(PADDED)) place_u (
        .slot(slot), .wrapped(wrapped), .columns(columns_u), .spans(spans_u),
        /* verilator lint_off PINCONNECTEMPTY */
        .column(), .turns(),
        /* verilator lint_on PINCONNECTEMPTY */
        .held_in(in_u)
    );
    cube3_place_unit #(.N(N), .PADDED(PADDED)) place_v (
        .slot(plane), .wrapped(wrapped), .columns(columns_v), .spans(spans_v),
        /* verilator lint_off PINCONNECTEMPTY */
        .column(), .turns(),
        /* verilator lint_on PINCONNECTEMPTY */
        .held_in(in_v)
    );

    wire [N*S-1:0] samples;
    genvar k, i;
    generate
        for (k = 0; k < N; k = k + 1) begin : depth
            wire [8*VOXEL_BITS-1:0] voxel;
            for (i = 0; i < 4; i = i + 1) begin : corner
                localparam integer V = i / 2;
                wire [2*VOXEL_BITS-1:0] pair;
                if (i % 2 == 0) begin : left
                    assign pair[0+:VOXEL_BITS] = newest[(V*N+k)*VOXEL_BITS+:VOXEL_BITS];
                    if (k + 1 < N) begin : far
                        assign pair[VOXEL_BITS+:VOXEL_BITS] = newest[(V*N+k+1)*VOXEL_BITS+:VOXEL_BITS];
                    end else begin : none
                        assign pair[VOXEL_BITS+:VOXEL_BITS] = {VOXEL_BITS{1'b0}};
                    end
                end else begin : right_
                    assign pair[0+:VOXEL_BITS] = right[(V*N+k)*VOXEL_BITS+:VOXEL_BITS];
                    if (k + 1 < N) begin : far
                        assign pair[VOXEL_BITS+:VOXEL_BITS] = right[(V*N+k+1)*VOXEL_BITS+:VOXEL_BITS];
                    end else begin : none
                        assign pair[VOXEL_BITS+:VOXEL_BITS] = {VOXEL_BITS{1'b0}};
                    end
                end
                assign voxel[i*VOXEL_BITS+:VOXEL_BITS] = pair[0+:VOXEL_BITS];
                assign voxel[(4+i)*VOXEL_BITS+:VOXEL_BITS] = pair[VOXEL_BITS+:VOXEL_BITS];
            end
            wire [S-1:0] sample;
            cube3_trilin #(
                .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                .NEAREST(NEAREST)
            ) cell_ (
                .voxel(voxel),
                .weight_w(offset), .weight_u(weights_u[k*W1+:W1]), .weight_v(weights_v[k*W1+:W1]),
                .sample(sample)
            );
            assign samples[k*S+:S] = in_u[k] && in_v[k] ? sample : {S{1'b0}};
        end
    endgenerate

    wire [N*S-1:0] turned;
    cube3_turn #(.ITEMS(N), .WIDTH(S), .AMOUNT_BITS(L)) turn_samples (
        .amount(-slot[L-1:0]), .items(samples), .turned(turned)
    );
    assign token = {turned, slot, plane};
endmodule
