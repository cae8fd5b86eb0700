// Test bench of cube3_node for the vectors of the unit node, made from its data sheet by
// cube3 vectors --unit node --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
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
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
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
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit node\n";
                else if (at == 3) fits = header == "// format voxel_bits=16 sample_fraction_bits=0 accumulator_bits=16 nearest=1\n";
            end
            if (!fits) $display("cube3_node_tb: %0s is no vector file with the lines\n// unit node\n// format voxel_bits=16 sample_fraction_bits=0 accumulator_bits=16 nearest=1", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_node_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_node_tb: nothing was compared");
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
        $display("cube3_node: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_node: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
