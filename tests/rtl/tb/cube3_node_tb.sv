// Test bench of cube3_node for the vectors of the unit node, made from its data sheet by
// cube3 vectors --unit node --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
module cube3_node_tb;
    localparam integer FIELDS = 19;
    localparam integer WORDS = 4194304;

    reg [2:0] mode;
    reg [0:0] left_present;
    reg [15:0] left_sample;
    reg [111:0] left_rgba;
    reg [0:0] right_present;
    reg [15:0] right_sample;
    reg [111:0] right_rgba;
    wire [0:0] present;
    reg [0:0] expected_present;
    wire [15:0] sample;
    reg [15:0] expected_sample;
    wire [111:0] rgba;
    reg [111:0] expected_rgba;

    reg [27:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    integer file, answers, skip, got, lines, line, differ;
    reg drive;

    cube3_node #(.VOXEL_BITS(16), .SAMPLE_FRACTION_BITS(0), .ACCUMULATOR_BITS(16), .NEAREST(1)) dut (
        .mode(mode),
        .left_present(left_present),
        .left_sample(left_sample),
        .left_rgba(left_rgba),
        .right_present(right_present),
        .right_sample(right_sample),
        .right_rgba(right_rgba),
        .present(present),
        .sample(sample),
        .rgba(rgba)
    );

    always @(posedge drive) begin
            mode[0 +: 3] <= words[line * FIELDS + 0][2:0];
            left_present[0 +: 1] <= words[line * FIELDS + 1][0:0];
            left_sample[0 +: 16] <= words[line * FIELDS + 2][15:0];
            left_rgba[0 +: 28] <= words[line * FIELDS + 3][27:0];
            left_rgba[28 +: 28] <= words[line * FIELDS + 4][27:0];
            left_rgba[56 +: 28] <= words[line * FIELDS + 5][27:0];
            left_rgba[84 +: 28] <= words[line * FIELDS + 6][27:0];
            right_present[0 +: 1] <= words[line * FIELDS + 7][0:0];
            right_sample[0 +: 16] <= words[line * FIELDS + 8][15:0];
            right_rgba[0 +: 28] <= words[line * FIELDS + 9][27:0];
            right_rgba[28 +: 28] <= words[line * FIELDS + 10][27:0];
            right_rgba[56 +: 28] <= words[line * FIELDS + 11][27:0];
            right_rgba[84 +: 28] <= words[line * FIELDS + 12][27:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_node_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            skip = 5;
            while (file != 0 && skip > 0) begin
                got = $fgetc(file);
                if (got == 10) skip = skip - 1;
                if (got < 0) skip = -1;
            end
            if (skip != 0 || $fscanf(file, "// transactions %d", lines) != 1) lines = -1;
            if (lines * FIELDS > WORDS) lines = -1;
            if (lines < 0) $display("cube3_node_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
        end
        if (lines < 0) $finish;
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_present[0 +: 1] = words[line * FIELDS + 13][0:0];
            expected_sample[0 +: 16] = words[line * FIELDS + 14][15:0];
            expected_rgba[0 +: 28] = words[line * FIELDS + 15][27:0];
            expected_rgba[28 +: 28] = words[line * FIELDS + 16][27:0];
            expected_rgba[56 +: 28] = words[line * FIELDS + 17][27:0];
            expected_rgba[84 +: 28] = words[line * FIELDS + 18][27:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h %h %h\n",
                present[0 +: 1],
                sample[0 +: 16],
                rgba[0 +: 28],
                rgba[28 +: 28],
                rgba[56 +: 28],
                rgba[84 +: 28]);
            if ({present, sample, rgba} !== {expected_present, expected_sample, expected_rgba}) begin
                if (differ == 0) $display("cube3_node: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        if (answers != 0) $fclose(answers);
        $display("cube3_node: %0d of %0d lines differ", differ, lines);
        $finish;
        end
    end
endmodule
