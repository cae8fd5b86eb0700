// Gradient of a sample from its 26 neighbours by one of the estimators, scaled and saturated to its word.
//
// Pfister et al. 1995, section 3.2. Equals cube3_abc::golden::local_gradient. Sample w*9 + v*3 + u: w along the ray, v from
// plane to plane, u from ray to ray; 13 is the sample itself.
//
// METHOD 6, 26, 10, 12; 61 and 261 are 6d and 26d, which subtract from the difference along the ray what its slope brings.
// PERSPECTIVE 1 mirrors the neighbourhood of a ray that runs against u or v, and multiplies the difference along the ray
// with `nearness`. FACTORS 0 leaves the multipliers of `factor` out: all are then 65536, that is 1.
//
// Operators: of the differences, 3 subtracters and for 26 48 adders and subtracters more; of a shear, 2 multipliers, an adder and
// a subtracter; 4 lerps for 10 and 6 for 12; 3 multipliers of the factors; an adder for each rounded product or word; 6
// comparators of the saturation.
module cube3_gradient #(
    parameter integer METHOD = 12,
    parameter integer PERSPECTIVE = 0,
    parameter integer FACTORS = 1,
    parameter integer VOXEL_BITS = 16,
    parameter integer WEIGHT_BITS = 8,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer GRADIENT_BITS = 17,
    parameter integer KEPT_BITS = 0,
    parameter integer NEAREST = 1
) (
    // Every method reads its own part of the neighbourhood and of the weights.
    // verilator lint_off UNUSEDSIGNAL
    input  wire [27*(VOXEL_BITS+SAMPLE_FRACTION_BITS)-1:0] s,
    input  wire [2*(WEIGHT_BITS+1)-1:0]                    here,
    input  wire [2*(WEIGHT_BITS+1)-1:0]                    behind,
    // A keyword of SystemVerilog, so the name is escaped.
    input  wire [2*(WEIGHT_BITS+1)-1:0]                    \before ,
    input  wire [1:0]                                      mirrored,
    input  wire [3*17-1:0]                                 factor,
    input  wire [16:0]                                     nearness,
    // verilator lint_on UNUSEDSIGNAL
    output wire [3*(GRADIENT_BITS+KEPT_BITS)-1:0]          g,
    output wire [2:0]                                      overflow
);
    localparam integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS;
    localparam integer W1 = WEIGHT_BITS + 1;
    localparam integer G = GRADIENT_BITS + KEPT_BITS;
    // Fraction bits of the factors and of nearness.
    localparam integer FRACTION = 16;
    localparam integer WEIGHTED = (METHOD == 26 || METHOD == 261) ? 1 : 0;
    localparam integer SHEARED = (METHOD == 61 || METHOD == 261) ? 1 : 0;
    // Bits by which the weights of 26 exceed 1.
    localparam integer EXTRA = WEIGHTED != 0 ? 4 : 0;
    // Bits that a component drops from a difference.
    localparam integer DROP = S + 1 - GRADIENT_BITS + EXTRA;
    // A difference, signed; and with up to three of them added in a shear.
    localparam integer D = S + 1 + EXTRA;
    localparam integer DS = D + (SHEARED != 0 ? 2 : 0);
    // Scaled, with half added.
    localparam integer V = DS + KEPT_BITS + 1;
    // The word before it is saturated.
    localparam integer R = V - DROP;

    // The neighbourhood as the ray sees it.
    // verilator lint_off UNUSEDSIGNAL
    wire [27*S-1:0] seen;
    // verilator lint_on UNUSEDSIGNAL

    genvar w, v, u, i;
    generate
        for (w = 0; w < 3; w = w + 1) begin : turn_w
            for (v = 0; v < 3; v = v + 1) begin : turn_v
                for (u = 0; u < 3; u = u + 1) begin : turn_u
                    if (PERSPECTIVE != 0) begin : mirror
                        wire [S-1:0] straight = mirrored[0] ? s[(w*9+v*3+2-u)*S +: S] : s[(w*9+v*3+u)*S +: S];
                        wire [S-1:0] upended = mirrored[0] ? s[(w*9+(2-v)*3+2-u)*S +: S] : s[(w*9+(2-v)*3+u)*S +: S];
                        assign seen[(w*9+v*3+u)*S +: S] = mirrored[1] ? upended : straight;
                    end else begin : as_is
                        assign seen[(w*9+v*3+u)*S +: S] = s[(w*9+v*3+u)*S +: S];
                    end
                end
            end
        end
    endgenerate

    // Differences along u, v and the ray.
    wire signed [D-1:0] along_u;
    wire signed [D-1:0] along_v;
    wire signed [D-1:0] along_ray;

    generate
        if (WEIGHTED != 0) begin : weighted
            // Weights 4, 2, 1 by Manhattan distance are shifts: 1, 2, 1 across times 1, 2, 1 down. Nine differences and their sum.
            wire [9*D-1:0] terms_u;
            wire [9*D-1:0] terms_v;
            wire [9*D-1:0] terms_w;
            for (v = 0; v < 3; v = v + 1) begin : down
                for (u = 0; u < 3; u = u + 1) begin : across
                    localparam integer UP = (v == 1 ? 1 : 0) + (u == 1 ? 1 : 0);
                    wire signed [D-1:0] du = D'($signed({1'b0, seen[(v*9+u*3+2)*S +: S]}))
                        - D'($signed({1'b0, seen[(v*9+u*3)*S +: S]}));
                    wire signed [D-1:0] dv = D'($signed({1'b0, seen[(v*9+2*3+u)*S +: S]}))
                        - D'($signed({1'b0, seen[(v*9+u)*S +: S]}));
                    wire signed [D-1:0] dw = D'($signed({1'b0, seen[(2*9+v*3+u)*S +: S]}))
                        - D'($signed({1'b0, seen[(v*3+u)*S +: S]}));
                    assign terms_u[(v*3+u)*D +: D] = du <<< UP;
                    assign terms_v[(v*3+u)*D +: D] = dv <<< UP;
                    assign terms_w[(v*3+u)*D +: D] = dw <<< UP;
                end
            end
            assign along_u = $signed(terms_u[0 +: D] + terms_u[D +: D] + terms_u[2*D +: D] + terms_u[3*D +: D]
                + terms_u[4*D +: D] + terms_u[5*D +: D] + terms_u[6*D +: D] + terms_u[7*D +: D] + terms_u[8*D +: D]);
            assign along_v = $signed(terms_v[0 +: D] + terms_v[D +: D] + terms_v[2*D +: D] + terms_v[3*D +: D]
                + terms_v[4*D +: D] + terms_v[5*D +: D] + terms_v[6*D +: D] + terms_v[7*D +: D] + terms_v[8*D +: D]);
            assign along_ray = $signed(terms_w[0 +: D] + terms_w[D +: D] + terms_w[2*D +: D] + terms_w[3*D +: D]
                + terms_w[4*D +: D] + terms_w[5*D +: D] + terms_w[6*D +: D] + terms_w[7*D +: D] + terms_w[8*D +: D]);
        end else if (METHOD == 10) begin : perpendicular
            // The foot of the perpendicular from a side ray lies towards the eye on the right, away on the left.
            wire [S-1:0] right;
            wire [S-1:0] left;
            wire [S-1:0] below;
            wire [S-1:0] above;
            cube3_lerp #(
                .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                .NEAREST(NEAREST)
            ) lerp_right (
                .near(seen[(9+3+2)*S +: S]), .far(seen[(3+2)*S +: S]), .weight(here[0 +: W1]), .value(right)
            );
            cube3_lerp #(
                .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                .NEAREST(NEAREST)
            ) lerp_left (
                .near(seen[(9+3)*S +: S]), .far(seen[(2*9+3)*S +: S]), .weight(here[0 +: W1]), .value(left)
            );
            cube3_lerp #(
                .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                .NEAREST(NEAREST)
            ) lerp_below (
                .near(seen[(9+2*3+1)*S +: S]), .far(seen[(2*3+1)*S +: S]), .weight(here[W1 +: W1]), .value(below)
            );
            cube3_lerp #(
                .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                .NEAREST(NEAREST)
            ) lerp_above (
                .near(seen[(9+1)*S +: S]), .far(seen[(2*9+1)*S +: S]), .weight(here[W1 +: W1]), .value(above)
            );
            assign along_u = $signed({1'b0, right}) - $signed({1'b0, left});
            assign along_v = $signed({1'b0, below}) - $signed({1'b0, above});
            assign along_ray = $signed({1'b0, seen[(2*9+3+1)*S +: S]}) - $signed({1'b0, seen[(3+1)*S +: S]});
        end else begin : pairs
            assign along_u = $signed({1'b0, seen[(9+3+2)*S +: S]}) - $signed({1'b0, seen[(9+3)*S +: S]});
            assign along_v = $signed({1'b0, seen[(9+2*3+1)*S +: S]}) - $signed({1'b0, seen[(9+1)*S +: S]});
            if (METHOD == 12) begin : straight
                // Straight behind the sample on slice k+1 lies between rays u-1 and u, v-1 and v; before it, the mirror
                // image: side 1 and side 0.
                wire [2*S-1:0] foot;
                for (i = 0; i < 2; i = i + 1) begin : side
                    // The slice, and the rays and planes next to the sample's.
                    localparam integer K = i == 0 ? 0 : 2;
                    localparam integer N = i == 0 ? 2 : 0;
                    wire [2*W1-1:0] weights = i == 0 ? \before : behind;
                    wire [S-1:0] near_v;
                    wire [S-1:0] far_v;
                    cube3_lerp #(
                        .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                        .NEAREST(NEAREST)
                    ) lerp_near (
                        .near(seen[(K*9+3+1)*S +: S]), .far(seen[(K*9+3+N)*S +: S]), .weight(weights[0 +: W1]), .value(near_v)
                    );
                    cube3_lerp #(
                        .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                        .NEAREST(NEAREST)
                    ) lerp_far (
                        .near(seen[(K*9+N*3+1)*S +: S]), .far(seen[(K*9+N*3+N)*S +: S]), .weight(weights[0 +: W1]), .value(far_v)
                    );
                    cube3_lerp #(
                        .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                        .NEAREST(NEAREST)
                    ) lerp_v (
                        .near(near_v), .far(far_v), .weight(weights[W1 +: W1]), .value(foot[i*S +: S])
                    );
                end
                assign along_ray = $signed({1'b0, foot[S +: S]}) - $signed({1'b0, foot[0 +: S]});
            end else begin : ray
                assign along_ray = $signed({1'b0, seen[(2*9+3+1)*S +: S]}) - $signed({1'b0, seen[(3+1)*S +: S]});
            end
        end
    endgenerate

    // Where rays are less than a voxel apart, u and v are relative to their distance, and so is the ray.
    wire signed [D-1:0] ray;

    generate
        if (PERSPECTIVE != 0) begin : near_rays
            localparam integer P = D + FRACTION;
            wire signed [P-1:0] product = P'(along_ray) * P'($signed({1'b0, nearness}));
            cube3_round #(.IN(P), .OUT(D), .DROP(FRACTION), .NEAREST(NEAREST)) round (.value(product), .rounded(ray));
        end else begin : parallel
            assign ray = along_ray;
        end
    endgenerate

    // What the slope of the ray brings along u and v is no change along w.
    wire signed [DS-1:0] along_w;

    generate
        if (SHEARED != 0) begin : shear
            localparam integer P = DS + WEIGHT_BITS;
            wire signed [P-1:0] along = P'(along_u) * P'($signed({1'b0, here[0 +: W1]}))
                + P'(along_v) * P'($signed({1'b0, here[W1 +: W1]}));
            wire signed [DS-1:0] brought;
            cube3_round #(.IN(P), .OUT(DS), .DROP(WEIGHT_BITS), .NEAREST(NEAREST)) round (.value(along), .rounded(brought));
            assign along_w = DS'(ray) - brought;
        end else begin : straight_ray
            assign along_w = ray;
        end
    endgenerate

    // Back from the mirror, with the factors, in the component's word.
    wire [3*DS-1:0] differences;
    assign differences[2*DS +: DS] = along_w;

    generate
        if (PERSPECTIVE != 0) begin : back
            assign differences[0 +: DS] = mirrored[0] ? -DS'(along_u) : DS'(along_u);
            assign differences[DS +: DS] = mirrored[1] ? -DS'(along_v) : DS'(along_v);
        end else begin : unmirrored
            assign differences[0 +: DS] = DS'(along_u);
            assign differences[DS +: DS] = DS'(along_v);
        end
        for (i = 0; i < 3; i = i + 1) begin : component
            wire signed [DS-1:0] difference = $signed(differences[i*DS +: DS]);
            wire signed [DS+KEPT_BITS-1:0] scaled;
            wire signed [R-1:0] word;
            if (FACTORS != 0) begin : factors
                localparam integer P = DS + FRACTION;
                wire signed [P-1:0] product = P'(difference) * P'($signed({1'b0, factor[i*17 +: 17]}));
                cube3_round #(.IN(P), .OUT(DS + KEPT_BITS), .DROP(FRACTION - KEPT_BITS), .NEAREST(NEAREST)) round (
                    .value(product), .rounded(scaled)
                );
            end else begin : unscaled
                assign scaled = (DS+KEPT_BITS)'(difference) <<< KEPT_BITS;
            end
            cube3_round #(.IN(V), .OUT(R), .DROP(DROP), .NEAREST(NEAREST)) round (.value(V'(scaled)), .rounded(word));
            localparam signed [R-1:0] TOP = (R'($signed(2'b01)) <<< (G - 1)) - R'($signed(2'b01));
            localparam signed [R-1:0] BOTTOM = -(R'($signed(2'b01)) <<< (G - 1));
            wire above = word > TOP;
            wire below = word < BOTTOM;
            assign g[i*G +: G] = above ? G'(TOP) : below ? G'(BOTTOM) : G'(word);
            assign overflow[i] = above | below;
        end
    endgenerate
endmodule
