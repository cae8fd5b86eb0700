// Where the samples of a ray slot are along one axis, u or v: for each depth the column of the slot's ray, whether the ray is the
// slot's first or, where slots are shared, its second, and whether the sample lies in the volume along this axis.
//
// Equals crates/frame/src/geometry.rs (`ray_in`, `column_at`, `valid_columns`). columns: X(k) for k = 0 to N-1; spans: how many
// columns beyond its own sample k needs, 0 to 2, and 3 for a depth that has none.
module cube3_place_unit #(
    parameter integer N = 8,
    parameter integer PADDED = 0,
    parameter integer L = $clog2(N),
    parameter integer P = L + PADDED,
    // A column, signed: -N to 2 N - 2.
    parameter integer C = L + 2
) (
    input wire [P-1:0] slot,
    input wire wrapped,
    input wire [N*(L+1)-1:0] columns,
    input wire [N*2-1:0] spans,
    output wire [N*C-1:0] column,
    output wire [N-1:0] turns,
    output wire [N-1:0] held_in
);
    wire [L:0] shear = columns[(N-1)*(L+1)+:L+1];
    localparam [C:0] SIDE = (C+1)'(N);
    genvar k;
    generate
        for (k = 0; k < N; k = k + 1) begin : depth
            wire [C-1:0] reach = {{C-P{1'b0}}, slot} + {1'b0, columns[k*(L+1)+:L+1]};
            wire [1:0] span = spans[k*2+:2];
            assign turns[k] = wrapped && reach[C-1:L] != {C-L{1'b0}};
            assign column[k*C+:C] = wrapped ? {{C-L{1'b0}}, reach[L-1:0]} : reach - {1'b0, shear};
            wire [C:0] end_ = {column[k*C+C-1], column[k*C+:C]} + {{C-1{1'b0}}, span};
            assign held_in[k] = span != 2'd3 && !column[k*C+C-1] && end_ < SIDE;
        end
    endgenerate
endmodule
