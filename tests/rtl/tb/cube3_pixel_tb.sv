// Test bench of cube3_pixel for the vectors of the unit pixel, made from its data sheet by
// cube3 vectors --unit pixel --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_pixel_tb;
    localparam integer FIELDS = 15;
    localparam integer WORDS = 4194304;

    reg [2:0] mode;
    reg [0:0] present;
    reg [111:0] rgba;
    reg [32:0] sum_weight;
    wire [63:0] pixel;
    reg [63:0] expected_pixel;
    wire [3:0] overflow;
    reg [3:0] expected_overflow;

    reg [32:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_pixel #(.ACCUMULATOR_BITS(16), .NEAREST(1)) dut (
        .mode(mode),
        .present(present),
        .rgba(rgba),
        .sum_weight(sum_weight),
        .pixel(pixel),
        .overflow(overflow)
    );

    always @(posedge drive) begin
            mode[0 +: 3] <= words[line * FIELDS + 0][2:0];
            present[0 +: 1] <= words[line * FIELDS + 1][0:0];
            rgba[0 +: 28] <= words[line * FIELDS + 2][27:0];
            rgba[28 +: 28] <= words[line * FIELDS + 3][27:0];
            rgba[56 +: 28] <= words[line * FIELDS + 4][27:0];
            rgba[84 +: 28] <= words[line * FIELDS + 5][27:0];
            sum_weight[0 +: 33] <= words[line * FIELDS + 6][32:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_pixel_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit pixel\n";
                else if (at == 3) fits = header == "// format accumulator_bits=16 nearest=1\n";
            end
            if (!fits) $display("cube3_pixel_tb: %0s is no vector file with the lines\n// unit pixel\n// format accumulator_bits=16 nearest=1", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_pixel_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_pixel_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_pixel[0 +: 16] = words[line * FIELDS + 7][15:0];
            expected_pixel[16 +: 16] = words[line * FIELDS + 8][15:0];
            expected_pixel[32 +: 16] = words[line * FIELDS + 9][15:0];
            expected_pixel[48 +: 16] = words[line * FIELDS + 10][15:0];
            expected_overflow[0 +: 1] = words[line * FIELDS + 11][0:0];
            expected_overflow[1 +: 1] = words[line * FIELDS + 12][0:0];
            expected_overflow[2 +: 1] = words[line * FIELDS + 13][0:0];
            expected_overflow[3 +: 1] = words[line * FIELDS + 14][0:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h %h %h %h %h\n",
                pixel[0 +: 16],
                pixel[16 +: 16],
                pixel[32 +: 16],
                pixel[48 +: 16],
                overflow[0 +: 1],
                overflow[1 +: 1],
                overflow[2 +: 1],
                overflow[3 +: 1]);
            if ({pixel, overflow} !== {expected_pixel, expected_overflow}) begin
                if (differ == 0) $display("cube3_pixel: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_pixel: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_pixel: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
