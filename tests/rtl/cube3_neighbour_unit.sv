// Which neighbours of the samples of a ray lie in the volume along one axis, u or v: for each depth those at a displacement of -1, 0
// or 1 ray and of -1, 0 or 1 slice. A neighbour is in the volume along u and along v, or it is the border.
//
// Equals crates/frame/src/geometry.rs (`valid_columns`) for the rays beside that of the slot, which is another slot's at each depth.
// columns and spans: see cube3_place_unit.sv. held_in: bit ((w + 1) * 3 + u + 1) * N + k.
module cube3_neighbour_unit #(
    parameter integer N = 8,
    parameter integer L = $clog2(N),
    parameter integer C = L + 2
) (
    input wire [N*C-1:0] column,
    input wire [N*(L+1)-1:0] columns,
    input wire [N*2-1:0] spans,
    output wire [9*N-1:0] held_in
);
    localparam [C:0] SIDE = (C+1)'(N);
    genvar k, w, u;
    generate
        for (k = 0; k < N; k = k + 1) begin : depth
            for (w = 0; w < 3; w = w + 1) begin : slice
                if (k + w < 1 || k + w > N) begin : outside
                    assign held_in[w*3*N+k] = 1'b0;
                    assign held_in[(w*3+1)*N+k] = 1'b0;
                    assign held_in[(w*3+2)*N+k] = 1'b0;
                end else begin : there
                    localparam integer K = k + w - 1;
                    wire [1:0] span = spans[K*2+:2];
                    wire [C:0] here = {column[k*C+C-1], column[k*C+:C]};
                    wire [C:0] there_ = here + {2'b00, columns[K*(L+1)+:L+1]} - {2'b00, columns[k*(L+1)+:L+1]};
                    for (u = 0; u < 3; u = u + 1) begin : ray
                        localparam [C:0] PLACE = (C+1)'(u);
                        wire [C:0] at = there_ + PLACE - 1'b1;
                        wire [C:0] end_ = at + {{C-1{1'b0}}, span};
                        assign held_in[(w*3+u)*N+k] = span != 2'd3 && !at[C] && end_ < SIDE;
                    end
                end
            end
        end
    endgenerate
endmodule
