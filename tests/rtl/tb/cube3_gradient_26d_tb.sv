// Test bench of cube3_gradient for the vectors of the unit gradient-26d, made from its data sheet by
// cube3 vectors --unit gradient-26d --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_gradient_26d_tb;
    localparam integer FIELDS = 45;
    localparam integer WORDS = 4194304;

    reg [431:0] s;
    reg [17:0] here;
    reg [17:0] behind;
    reg [17:0] ahead;
    reg [1:0] mirrored;
    reg [50:0] factor;
    reg [16:0] nearness;
    wire [50:0] g;
    reg [50:0] expected_g;
    wire [2:0] overflow;
    reg [2:0] expected_overflow;

    reg [16:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_gradient #(.VOXEL_BITS(16), .WEIGHT_BITS(8), .SAMPLE_FRACTION_BITS(0), .GRADIENT_BITS(17), .KEPT_BITS(0), .NEAREST(1), .METHOD(261), .PERSPECTIVE(1)) dut (
        .s(s),
        .here(here),
        .behind(behind),
        .ahead(ahead),
        .mirrored(mirrored),
        .factor(factor),
        .nearness(nearness),
        .g(g),
        .overflow(overflow)
    );

    always @(posedge drive) begin
            s[0 +: 16] <= words[line * FIELDS + 0][15:0];
            s[16 +: 16] <= words[line * FIELDS + 1][15:0];
            s[32 +: 16] <= words[line * FIELDS + 2][15:0];
            s[48 +: 16] <= words[line * FIELDS + 3][15:0];
            s[64 +: 16] <= words[line * FIELDS + 4][15:0];
            s[80 +: 16] <= words[line * FIELDS + 5][15:0];
            s[96 +: 16] <= words[line * FIELDS + 6][15:0];
            s[112 +: 16] <= words[line * FIELDS + 7][15:0];
            s[128 +: 16] <= words[line * FIELDS + 8][15:0];
            s[144 +: 16] <= words[line * FIELDS + 9][15:0];
            s[160 +: 16] <= words[line * FIELDS + 10][15:0];
            s[176 +: 16] <= words[line * FIELDS + 11][15:0];
            s[192 +: 16] <= words[line * FIELDS + 12][15:0];
            s[208 +: 16] <= words[line * FIELDS + 13][15:0];
            s[224 +: 16] <= words[line * FIELDS + 14][15:0];
            s[240 +: 16] <= words[line * FIELDS + 15][15:0];
            s[256 +: 16] <= words[line * FIELDS + 16][15:0];
            s[272 +: 16] <= words[line * FIELDS + 17][15:0];
            s[288 +: 16] <= words[line * FIELDS + 18][15:0];
            s[304 +: 16] <= words[line * FIELDS + 19][15:0];
            s[320 +: 16] <= words[line * FIELDS + 20][15:0];
            s[336 +: 16] <= words[line * FIELDS + 21][15:0];
            s[352 +: 16] <= words[line * FIELDS + 22][15:0];
            s[368 +: 16] <= words[line * FIELDS + 23][15:0];
            s[384 +: 16] <= words[line * FIELDS + 24][15:0];
            s[400 +: 16] <= words[line * FIELDS + 25][15:0];
            s[416 +: 16] <= words[line * FIELDS + 26][15:0];
            here[0 +: 9] <= words[line * FIELDS + 27][8:0];
            here[9 +: 9] <= words[line * FIELDS + 28][8:0];
            behind[0 +: 9] <= words[line * FIELDS + 29][8:0];
            behind[9 +: 9] <= words[line * FIELDS + 30][8:0];
            ahead[0 +: 9] <= words[line * FIELDS + 31][8:0];
            ahead[9 +: 9] <= words[line * FIELDS + 32][8:0];
            mirrored[0 +: 1] <= words[line * FIELDS + 33][0:0];
            mirrored[1 +: 1] <= words[line * FIELDS + 34][0:0];
            factor[0 +: 17] <= words[line * FIELDS + 35][16:0];
            factor[17 +: 17] <= words[line * FIELDS + 36][16:0];
            factor[34 +: 17] <= words[line * FIELDS + 37][16:0];
            nearness[0 +: 17] <= words[line * FIELDS + 38][16:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_gradient_26d_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit gradient-26d\n";
                else if (at == 3) fits = header == "// format voxel_bits=16 weight_bits=8 sample_fraction_bits=0 gradient_bits=17 kept_bits=0 nearest=1\n";
            end
            if (!fits) $display("cube3_gradient_26d_tb: %0s is no vector file with the lines\n// unit gradient-26d\n// format voxel_bits=16 weight_bits=8 sample_fraction_bits=0 gradient_bits=17 kept_bits=0 nearest=1", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_gradient_26d_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_gradient_26d_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_g[0 +: 17] = words[line * FIELDS + 39][16:0];
            expected_g[17 +: 17] = words[line * FIELDS + 40][16:0];
            expected_g[34 +: 17] = words[line * FIELDS + 41][16:0];
            expected_overflow[0 +: 1] = words[line * FIELDS + 42][0:0];
            expected_overflow[1 +: 1] = words[line * FIELDS + 43][0:0];
            expected_overflow[2 +: 1] = words[line * FIELDS + 44][0:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h %h %h\n",
                g[0 +: 17],
                g[17 +: 17],
                g[34 +: 17],
                overflow[0 +: 1],
                overflow[1 +: 1],
                overflow[2 +: 1]);
            if ({g, overflow} !== {expected_g, expected_overflow}) begin
                if (differ == 0) $display("cube3_gradient: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_gradient: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_gradient: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
