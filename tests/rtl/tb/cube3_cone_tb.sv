// Test bench of cube3_cone for the vectors of the unit cone, made from its data sheet by
// cube3 vectors --unit cone --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_cone_tb;
    localparam integer FIELDS = 77;
    localparam integer WORDS = 4194304;

    reg [2:0] mode;
    reg [2:0] start;
    reg [7:0] leaf_present;
    reg [127:0] leaf_sample;
    reg [511:0] leaf_rgba;
    reg [15:0] leaf_ray;
    wire [1:0] count;
    reg [1:0] expected_count;
    wire [2:0] seg_present;
    reg [2:0] expected_seg_present;
    wire [47:0] seg_sample;
    reg [47:0] expected_seg_sample;
    wire [335:0] seg_rgba;
    reg [335:0] expected_seg_rgba;

    reg [27:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_cone #(.VOXEL_BITS(16), .SAMPLE_FRACTION_BITS(0), .ACCUMULATOR_BITS(16), .NEAREST(1), .LEAVES(8)) dut (
        .mode(mode),
        .start(start),
        .leaf_present(leaf_present),
        .leaf_sample(leaf_sample),
        .leaf_rgba(leaf_rgba),
        .leaf_ray(leaf_ray),
        .count(count),
        .seg_present(seg_present),
        .seg_sample(seg_sample),
        .seg_rgba(seg_rgba)
    );

    always @(posedge drive) begin
            mode[0 +: 3] <= words[line * FIELDS + 0][2:0];
            start[0 +: 3] <= words[line * FIELDS + 1][2:0];
            leaf_present[0 +: 1] <= words[line * FIELDS + 2][0:0];
            leaf_present[1 +: 1] <= words[line * FIELDS + 3][0:0];
            leaf_present[2 +: 1] <= words[line * FIELDS + 4][0:0];
            leaf_present[3 +: 1] <= words[line * FIELDS + 5][0:0];
            leaf_present[4 +: 1] <= words[line * FIELDS + 6][0:0];
            leaf_present[5 +: 1] <= words[line * FIELDS + 7][0:0];
            leaf_present[6 +: 1] <= words[line * FIELDS + 8][0:0];
            leaf_present[7 +: 1] <= words[line * FIELDS + 9][0:0];
            leaf_sample[0 +: 16] <= words[line * FIELDS + 10][15:0];
            leaf_sample[16 +: 16] <= words[line * FIELDS + 11][15:0];
            leaf_sample[32 +: 16] <= words[line * FIELDS + 12][15:0];
            leaf_sample[48 +: 16] <= words[line * FIELDS + 13][15:0];
            leaf_sample[64 +: 16] <= words[line * FIELDS + 14][15:0];
            leaf_sample[80 +: 16] <= words[line * FIELDS + 15][15:0];
            leaf_sample[96 +: 16] <= words[line * FIELDS + 16][15:0];
            leaf_sample[112 +: 16] <= words[line * FIELDS + 17][15:0];
            leaf_rgba[0 +: 16] <= words[line * FIELDS + 18][15:0];
            leaf_rgba[16 +: 16] <= words[line * FIELDS + 19][15:0];
            leaf_rgba[32 +: 16] <= words[line * FIELDS + 20][15:0];
            leaf_rgba[48 +: 16] <= words[line * FIELDS + 21][15:0];
            leaf_rgba[64 +: 16] <= words[line * FIELDS + 22][15:0];
            leaf_rgba[80 +: 16] <= words[line * FIELDS + 23][15:0];
            leaf_rgba[96 +: 16] <= words[line * FIELDS + 24][15:0];
            leaf_rgba[112 +: 16] <= words[line * FIELDS + 25][15:0];
            leaf_rgba[128 +: 16] <= words[line * FIELDS + 26][15:0];
            leaf_rgba[144 +: 16] <= words[line * FIELDS + 27][15:0];
            leaf_rgba[160 +: 16] <= words[line * FIELDS + 28][15:0];
            leaf_rgba[176 +: 16] <= words[line * FIELDS + 29][15:0];
            leaf_rgba[192 +: 16] <= words[line * FIELDS + 30][15:0];
            leaf_rgba[208 +: 16] <= words[line * FIELDS + 31][15:0];
            leaf_rgba[224 +: 16] <= words[line * FIELDS + 32][15:0];
            leaf_rgba[240 +: 16] <= words[line * FIELDS + 33][15:0];
            leaf_rgba[256 +: 16] <= words[line * FIELDS + 34][15:0];
            leaf_rgba[272 +: 16] <= words[line * FIELDS + 35][15:0];
            leaf_rgba[288 +: 16] <= words[line * FIELDS + 36][15:0];
            leaf_rgba[304 +: 16] <= words[line * FIELDS + 37][15:0];
            leaf_rgba[320 +: 16] <= words[line * FIELDS + 38][15:0];
            leaf_rgba[336 +: 16] <= words[line * FIELDS + 39][15:0];
            leaf_rgba[352 +: 16] <= words[line * FIELDS + 40][15:0];
            leaf_rgba[368 +: 16] <= words[line * FIELDS + 41][15:0];
            leaf_rgba[384 +: 16] <= words[line * FIELDS + 42][15:0];
            leaf_rgba[400 +: 16] <= words[line * FIELDS + 43][15:0];
            leaf_rgba[416 +: 16] <= words[line * FIELDS + 44][15:0];
            leaf_rgba[432 +: 16] <= words[line * FIELDS + 45][15:0];
            leaf_rgba[448 +: 16] <= words[line * FIELDS + 46][15:0];
            leaf_rgba[464 +: 16] <= words[line * FIELDS + 47][15:0];
            leaf_rgba[480 +: 16] <= words[line * FIELDS + 48][15:0];
            leaf_rgba[496 +: 16] <= words[line * FIELDS + 49][15:0];
            leaf_ray[0 +: 2] <= words[line * FIELDS + 50][1:0];
            leaf_ray[2 +: 2] <= words[line * FIELDS + 51][1:0];
            leaf_ray[4 +: 2] <= words[line * FIELDS + 52][1:0];
            leaf_ray[6 +: 2] <= words[line * FIELDS + 53][1:0];
            leaf_ray[8 +: 2] <= words[line * FIELDS + 54][1:0];
            leaf_ray[10 +: 2] <= words[line * FIELDS + 55][1:0];
            leaf_ray[12 +: 2] <= words[line * FIELDS + 56][1:0];
            leaf_ray[14 +: 2] <= words[line * FIELDS + 57][1:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_cone_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit cone\n";
                else if (at == 3) fits = header == "// format voxel_bits=16 sample_fraction_bits=0 accumulator_bits=16 nearest=1 leaves=8\n";
            end
            if (!fits) $display("cube3_cone_tb: %0s is no vector file with the lines\n// unit cone\n// format voxel_bits=16 sample_fraction_bits=0 accumulator_bits=16 nearest=1 leaves=8", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_cone_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_cone_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_count[0 +: 2] = words[line * FIELDS + 58][1:0];
            expected_seg_present[0 +: 1] = words[line * FIELDS + 59][0:0];
            expected_seg_present[1 +: 1] = words[line * FIELDS + 60][0:0];
            expected_seg_present[2 +: 1] = words[line * FIELDS + 61][0:0];
            expected_seg_sample[0 +: 16] = words[line * FIELDS + 62][15:0];
            expected_seg_sample[16 +: 16] = words[line * FIELDS + 63][15:0];
            expected_seg_sample[32 +: 16] = words[line * FIELDS + 64][15:0];
            expected_seg_rgba[0 +: 28] = words[line * FIELDS + 65][27:0];
            expected_seg_rgba[28 +: 28] = words[line * FIELDS + 66][27:0];
            expected_seg_rgba[56 +: 28] = words[line * FIELDS + 67][27:0];
            expected_seg_rgba[84 +: 28] = words[line * FIELDS + 68][27:0];
            expected_seg_rgba[112 +: 28] = words[line * FIELDS + 69][27:0];
            expected_seg_rgba[140 +: 28] = words[line * FIELDS + 70][27:0];
            expected_seg_rgba[168 +: 28] = words[line * FIELDS + 71][27:0];
            expected_seg_rgba[196 +: 28] = words[line * FIELDS + 72][27:0];
            expected_seg_rgba[224 +: 28] = words[line * FIELDS + 73][27:0];
            expected_seg_rgba[252 +: 28] = words[line * FIELDS + 74][27:0];
            expected_seg_rgba[280 +: 28] = words[line * FIELDS + 75][27:0];
            expected_seg_rgba[308 +: 28] = words[line * FIELDS + 76][27:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h %h\n",
                count[0 +: 2],
                seg_present[0 +: 1],
                seg_present[1 +: 1],
                seg_present[2 +: 1],
                seg_sample[0 +: 16],
                seg_sample[16 +: 16],
                seg_sample[32 +: 16],
                seg_rgba[0 +: 28],
                seg_rgba[28 +: 28],
                seg_rgba[56 +: 28],
                seg_rgba[84 +: 28],
                seg_rgba[112 +: 28],
                seg_rgba[140 +: 28],
                seg_rgba[168 +: 28],
                seg_rgba[196 +: 28],
                seg_rgba[224 +: 28],
                seg_rgba[252 +: 28],
                seg_rgba[280 +: 28],
                seg_rgba[308 +: 28]);
            if ({count, seg_present, seg_sample, seg_rgba} !== {expected_count, expected_seg_present, expected_seg_sample, expected_seg_rgba}) begin
                if (differ == 0) $display("cube3_cone: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_cone: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_cone: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
