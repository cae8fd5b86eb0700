// Sheared trilinear interpolation of one sample: four lerps along w, two along u, one along v, each rounded.
//
// Pfister et al. 1995, section 3. Equals cube3_trilin::golden::cell of lifted voxels. Voxel w*4 + v*2 + u is that of
// plane w (front, back) on the discrete ray (u, v).
//
// Operators: seven lerps. Fewer where neighbouring samples share them, which is a matter of the registers around the unit.
module cube3_trilin #(
    parameter integer VOXEL_BITS = 16,
    parameter integer WEIGHT_BITS = 8,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer NEAREST = 1
) (
    input  wire [8*VOXEL_BITS-1:0]                    voxel,
    input  wire [WEIGHT_BITS:0]                       weight_w,
    input  wire [WEIGHT_BITS:0]                       weight_u,
    input  wire [WEIGHT_BITS:0]                       weight_v,
    output wire [VOXEL_BITS+SAMPLE_FRACTION_BITS-1:0] sample
);
    localparam integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS;

    // Along w: ray 2v + u. Along u: row v.
    wire [4*S-1:0] along_w;
    wire [2*S-1:0] along_u;

    genvar i;
    generate
        for (i = 0; i < 4; i = i + 1) begin : w
            // A voxel in the sample format has its fraction below.
            cube3_lerp #(
                .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                .NEAREST(NEAREST)
            ) lerp (
                .near(S'(voxel[i*VOXEL_BITS +: VOXEL_BITS]) << SAMPLE_FRACTION_BITS),
                .far(S'(voxel[(4+i)*VOXEL_BITS +: VOXEL_BITS]) << SAMPLE_FRACTION_BITS),
                .weight(weight_w),
                .value(along_w[i*S +: S])
            );
        end
        for (i = 0; i < 2; i = i + 1) begin : u
            cube3_lerp #(
                .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                .NEAREST(NEAREST)
            ) lerp (
                .near(along_w[2*i*S +: S]),
                .far(along_w[(2*i+1)*S +: S]),
                .weight(weight_u),
                .value(along_u[i*S +: S])
            );
        end
    endgenerate

    cube3_lerp #(
        .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
        .NEAREST(NEAREST)
    ) v (
        .near(along_u[0 +: S]),
        .far(along_u[S +: S]),
        .weight(weight_v),
        .value(sample)
    );
endmodule
