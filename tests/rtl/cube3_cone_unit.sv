// The cone on its channels: rays of coloured samples in, pixels out.
//
//     [shaded] --> N leaves --> folded tree over the rays of the slot --> [pixels]
//
// Cube-3, section 5: the tree starts at the leaf that holds depth 0. A slot that several rays share gives a pixel for each, at most
// three, in order of depth. Equals crates/cone/src/unit.rs (`ConeUnit::step`, `Reducer`) for rays of one chunk.
// Tokens: [shaded] {leaves, slot, plane}, see cube3_abc_unit.sv; [pixels] {red, green, blue, opacity of ray 2, 1, 0 with red in the
// low bits, v of ray 2, 1, 0, u of ray 2, 1, 0, number of rays}.
module cube3_cone_unit #(
    parameter integer N = 8,
    parameter integer PADDED = 0,
    parameter integer VOXEL_BITS = 16,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer COLOUR_BITS = 12,
    parameter integer OPACITY_BITS = 12,
    parameter integer ACCUMULATOR_BITS = 16,
    parameter integer NEAREST = 1,
    parameter integer L = $clog2(N),
    parameter integer P = L + PADDED,
    parameter integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS,
    parameter integer A = ACCUMULATOR_BITS,
    // A ray's number, signed.
    parameter integer R = L + 2,
    parameter integer LEAF = 1 + S + OPACITY_BITS + 3 * COLOUR_BITS,
    parameter integer IN = 2 * P + N * LEAF,
    parameter integer OUT = 2 + 6 * R + 12 * A
) (
    input wire wrapped,
    input wire [N*(L+1)-1:0] columns_u,
    input wire [N*(L+1)-1:0] columns_v,
    input wire [2:0] mode,
    input wire [OPACITY_BITS-1:0] opaque,
    input wire [32:0] sum_weight,
    // [shaded]
    input wire valid,
    input wire [IN-1:0] front,
    output wire pop,
    // [pixels]
    input wire can_push,
    output wire push,
    output wire [OUT-1:0] token,
    output wire [1:0] activity,
    // Words saturated in the pixels that are pushed.
    output wire [3:0] overflows
);
    localparam integer NODE = A + 12;

    wire [P-1:0] plane = front[P-1:0];
    wire [P-1:0] slot = front[P+:P];
    assign pop = valid && can_push;
    assign push = pop;
    assign activity = !valid ? 2'd1 : can_push ? 2'd0 : 2'd2;

    // The rays of the slot, in order of depth: the second begins where the column or the row turns, the third where the other does.
    // Where both turn at once there are two.
    wire [N-1:0] turns_u;
    wire [N-1:0] turns_v;
    cube3_place_unit #(.N(N), .PADDED(PADDED)) place_u (
        .slot(slot), .wrapped(wrapped), .columns(columns_u), .spans({N{2'd0}}), .turns(turns_u),
        /* verilator lint_off PINCONNECTEMPTY */
        .column(), .held_in()
        /* verilator lint_on PINCONNECTEMPTY */
    );
    cube3_place_unit #(.N(N), .PADDED(PADDED)) place_v (
        .slot(plane), .wrapped(wrapped), .columns(columns_v), .spans({N{2'd0}}), .turns(turns_v),
        /* verilator lint_off PINCONNECTEMPTY */
        .column(), .held_in()
        /* verilator lint_on PINCONNECTEMPTY */
    );
    wire together = turns_u == turns_v;
    wire [2*N-1:0] numbers;
    wire [2*N-1:0] leaf_ray;
    genvar k;
    generate
        for (k = 0; k < N; k = k + 1) begin : depth
            wire both = turns_u[k] && turns_v[k] && !together;
            assign numbers[2*k+:2] = {both, (turns_u[k] || turns_v[k]) && !both};
        end
    endgenerate
    cube3_turn #(.ITEMS(N), .WIDTH(2), .AMOUNT_BITS(L)) turn_numbers (
        .amount(-slot[L-1:0]), .items(numbers), .turned(leaf_ray)
    );

    wire [N-1:0] leaf_present;
    wire [N*S-1:0] leaf_sample;
    wire [4*N*A-1:0] leaf_rgba;
    generate
        for (k = 0; k < N; k = k + 1) begin : lane
            wire [LEAF-1:0] shaded = front[2*P+k*LEAF+:LEAF];
            cube3_leaf #(
                .VOXEL_BITS(VOXEL_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS), .COLOUR_BITS(COLOUR_BITS),
                .OPACITY_BITS(OPACITY_BITS), .ACCUMULATOR_BITS(A), .NEAREST(NEAREST)
            ) leaf (
                .mode(mode), .opaque(opaque), .present(shaded[0]), .sample(shaded[1+:S]),
                .opacity(shaded[1+S+:OPACITY_BITS]), .colour(shaded[1+S+OPACITY_BITS+:3*COLOUR_BITS]),
                .out_present(leaf_present[k]), .out_sample(leaf_sample[k*S+:S]), .out_rgba(leaf_rgba[4*k*A+:4*A])
            );
        end
    endgenerate

    wire [1:0] count;
    wire [2:0] seg_present;
    wire [12*NODE-1:0] seg_rgba;
    cube3_cone #(
        .VOXEL_BITS(VOXEL_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS), .ACCUMULATOR_BITS(A), .NEAREST(NEAREST),
        .LEAVES(N)
    ) tree (
        .mode(mode), .start(slot[L-1:0]), .leaf_present(leaf_present), .leaf_sample(leaf_sample), .leaf_rgba(leaf_rgba),
        .leaf_ray(leaf_ray), .count(count), .seg_present(seg_present), .seg_rgba(seg_rgba),
        /* verilator lint_off PINCONNECTEMPTY */
        .seg_sample()  // What a minimum or maximum was taken of is not sent to the host.
        /* verilator lint_on PINCONNECTEMPTY */
    );

    // Numbers of the rays: those of the first sample, and N less where the slot has turned over.
    wire [L:0] shear_u = wrapped ? {L + 1{1'b0}} : columns_u[(N-1)*(L+1)+:L+1];
    wire [L:0] shear_v = wrapped ? {L + 1{1'b0}} : columns_v[(N-1)*(L+1)+:L+1];
    wire [R-1:0] first_u = {{R-P{1'b0}}, slot} - {1'b0, shear_u};
    wire [R-1:0] first_v = {{R-P{1'b0}}, plane} - {1'b0, shear_v};
    localparam [R-1:0] SIDE = R'(N);
    // The second ray of three has turned along one axis only: the one that has turned at more depths.
    wire [N-1:0] only_u = turns_u & ~turns_v;
    wire [N-1:0] only_v = turns_v & ~turns_u;
    wire second_u = turns_u != {N{1'b0}} && (together || only_u != {N{1'b0}});
    wire second_v = turns_v != {N{1'b0}} && (together || only_v != {N{1'b0}});
    assign token[1:0] = count;
    assign token[2+:R] = first_u;
    assign token[2+R+:R] = second_u ? first_u - SIDE : first_u;
    assign token[2+2*R+:R] = first_u - SIDE;
    assign token[2+3*R+:R] = first_v;
    assign token[2+4*R+:R] = second_v ? first_v - SIDE : first_v;
    assign token[2+5*R+:R] = first_v - SIDE;
    wire [11:0] saturated;
    generate
        for (k = 0; k < 3; k = k + 1) begin : ray
            cube3_pixel #(
                .ACCUMULATOR_BITS(A), .NEAREST(NEAREST)
            ) host_pixel (
                .mode(mode), .present(seg_present[k]), .rgba(seg_rgba[4*k*NODE+:4*NODE]), .sum_weight(sum_weight),
                .pixel(token[2+6*R+4*k*A+:4*A]), .overflow(saturated[4*k+:4])
            );
        end
    endgenerate
    integer i;
    reg [3:0] sum;
    always @* begin
        sum = 4'd0;
        for (i = 0; i < 12; i = i + 1) sum = sum + {3'b000, saturated[i]};
    end
    assign overflows = sum;
endmodule
