// The folded cone: a segmented reduction of the leaves of a circle from any start, for a slot that up to three rays share.
//
// Pfister et al. 1995, section 3.4. Equals cube3_cone::lanes::circle over one chunk. Level by level neighbours are paired relative
// to `start`. While a level has an even number of nodes, one bit of the start chooses between the two pairings of the circle: the
// cross-links of the folded cone. A level of an odd number (leaves that are no power of two) is turned to its start once, and
// is straight from there on; its last node passes.
//
// Port `leaf_ray`: which of the slot's rays, in order of depth, a leaf belongs to. Segment r is ray r; one without a leaf is all 0.
//
// Operators: those of LEAVES - 1 nodes.
module cube3_cone #(
    parameter integer VOXEL_BITS = 16,
    parameter integer SAMPLE_FRACTION_BITS = 0,
    parameter integer ACCUMULATOR_BITS = 16,
    parameter integer NEAREST = 1,
    parameter integer LEAVES = 8
) (
    // A cone of one leaf has no node and one start.
    // verilator lint_off UNUSEDSIGNAL
    input  wire [2:0]                                           mode,
    input  wire [(LEAVES > 1 ? $clog2(LEAVES) : 1)-1:0]         start,
    // verilator lint_on UNUSEDSIGNAL
    input  wire [LEAVES-1:0]                                    leaf_present,
    input  wire [LEAVES*(VOXEL_BITS+SAMPLE_FRACTION_BITS)-1:0]  leaf_sample,
    input  wire [4*LEAVES*ACCUMULATOR_BITS-1:0]                 leaf_rgba,
    input  wire [2*LEAVES-1:0]                                  leaf_ray,
    output wire [1:0]                                           count,
    output wire [2:0]                                           seg_present,
    output wire [3*(VOXEL_BITS+SAMPLE_FRACTION_BITS)-1:0]       seg_sample,
    output wire [12*(ACCUMULATOR_BITS+12)-1:0]                  seg_rgba
);
    localparam integer S = VOXEL_BITS + SAMPLE_FRACTION_BITS;
    localparam integer A = ACCUMULATOR_BITS;
    localparam integer N = A + 12;
    // A stretch of a ray: whether a sample takes part, its word, the accumulators; from the top.
    localparam integer T = 1 + S + 4 * N;
    // Three of them, and of which rays there is one, from the top.
    localparam integer M = 3 + 3 * T;
    localparam integer LEVELS = $clog2(LEAVES);

    // Nodes of a level, the leaves being level 0.
    function integer nodes(input integer level);
        integer l;
        begin
            nodes = LEAVES;
            for (l = 0; l < level; l = l + 1) nodes = (nodes + 1) / 2;
        end
    endfunction

    // Nodes of the levels before one.
    function integer before_level(input integer level);
        integer l;
        begin
            before_level = 0;
            for (l = 0; l < level; l = l + 1) before_level = before_level + nodes(l);
        end
    endfunction

    // Whether a level before had an odd number of nodes, so that the circle has been cut open.
    function integer is_straight(input integer level);
        integer l;
        begin
            is_straight = 0;
            for (l = 0; l < level; l = l + 1) if (nodes(l) % 2 != 0) is_straight = 1;
        end
    endfunction

    // All levels, one behind another.
    wire [M*before_level(LEVELS+1)-1:0] levels /* verilator split_var */;

    genvar i, c, level;
    generate
        for (i = 0; i < LEAVES; i = i + 1) begin : leaf
            wire [T-1:0] stretch;
            assign stretch[T-1] = leaf_present[i];
            assign stretch[4*N +: S] = leaf_sample[i*S +: S];
            for (c = 0; c < 4; c = c + 1) begin : channel
                assign stretch[c*N +: N] = {12'd0, leaf_rgba[(4*i+c)*A +: A]};
            end
            for (c = 0; c < 3; c = c + 1) begin : ray
                wire mine = leaf_ray[2*i +: 2] == 2'(c);
                assign levels[i*M+3*T+c] = mine;
                assign levels[i*M+c*T +: T] = mine ? stretch : T'(0);
            end
        end
        for (level = 0; level < LEVELS; level = level + 1) begin : pairing
            localparam integer COUNT = nodes(level);
            localparam integer FROM = before_level(level) * M;
            localparam integer TO = before_level(level + 1) * M;
            wire [COUNT*M-1:0] ordered;
            if (is_straight(level) != 0) begin : straight
                assign ordered = levels[FROM +: COUNT*M];
            end else begin : circle
                // One bit of the start where pairs go on round the circle, all that is left of it where they do not.
                localparam integer BITS = COUNT % 2 == 0 ? 1 : LEVELS - level;
                cube3_turn #(.ITEMS(COUNT), .WIDTH(M), .AMOUNT_BITS(BITS)) turn (
                    .amount(start[level +: BITS]), .items(levels[FROM +: COUNT*M]), .turned(ordered)
                );
            end
            for (i = 0; i < (COUNT + 1) / 2; i = i + 1) begin : node
                if (2 * i + 1 < COUNT) begin : pair
                    cube3_join #(
                        .VOXEL_BITS(VOXEL_BITS), .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS),
                        .ACCUMULATOR_BITS(ACCUMULATOR_BITS), .NEAREST(NEAREST)
                    ) join_ (
                        .mode(mode),
                        .left_has(ordered[2*i*M+3*T +: 3]),
                        .left(ordered[2*i*M +: 3*T]),
                        .right_has(ordered[(2*i+1)*M+3*T +: 3]),
                        .right(ordered[(2*i+1)*M +: 3*T]),
                        .has(levels[TO+i*M+3*T +: 3]),
                        .joined(levels[TO+i*M +: 3*T])
                    );
                end else begin : passes
                    assign levels[TO+i*M +: M] = ordered[2*i*M +: M];
                end
            end
        end
    endgenerate

    localparam integer ROOT = before_level(LEVELS) * M;
    wire [2:0] has = levels[ROOT+3*T +: 3];
    // How many of three: a full adder.
    assign count = {(has[0] & has[1]) | (has[0] & has[2]) | (has[1] & has[2]), ^has};

    generate
        for (i = 0; i < 3; i = i + 1) begin : segment
            assign seg_present[i] = levels[ROOT+i*T+T-1];
            assign seg_sample[i*S +: S] = levels[ROOT+i*T+4*N +: S];
            assign seg_rgba[i*4*N +: 4*N] = levels[ROOT+i*T +: 4*N];
        end
    endgenerate
endmodule
