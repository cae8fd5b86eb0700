// Test bench of cube3_lit for the vectors of the unit lit, made from its data sheet by
// cube3 vectors --unit lit --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_lit_tb;
    localparam integer FIELDS = 15;
    localparam integer WORDS = 4194304;

    reg [35:0] colour;
    reg [59:0] diffuse;
    reg [59:0] specular;
    wire [35:0] value;
    reg [35:0] expected_value;
    wire [2:0] overflow;
    reg [2:0] expected_overflow;

    reg [19:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_lit #(.COLOUR_BITS(12), .NEAREST(1)) dut (
        .colour(colour),
        .diffuse(diffuse),
        .specular(specular),
        .value(value),
        .overflow(overflow)
    );

    always @(posedge drive) begin
            colour[0 +: 12] <= words[line * FIELDS + 0][11:0];
            colour[12 +: 12] <= words[line * FIELDS + 1][11:0];
            colour[24 +: 12] <= words[line * FIELDS + 2][11:0];
            diffuse[0 +: 20] <= words[line * FIELDS + 3][19:0];
            diffuse[20 +: 20] <= words[line * FIELDS + 4][19:0];
            diffuse[40 +: 20] <= words[line * FIELDS + 5][19:0];
            specular[0 +: 20] <= words[line * FIELDS + 6][19:0];
            specular[20 +: 20] <= words[line * FIELDS + 7][19:0];
            specular[40 +: 20] <= words[line * FIELDS + 8][19:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_lit_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit lit\n";
                else if (at == 3) fits = header == "// format colour_bits=12 nearest=1\n";
            end
            if (!fits) $display("cube3_lit_tb: %0s is no vector file with the lines\n// unit lit\n// format colour_bits=12 nearest=1", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_lit_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_lit_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_value[0 +: 12] = words[line * FIELDS + 9][11:0];
            expected_value[12 +: 12] = words[line * FIELDS + 10][11:0];
            expected_value[24 +: 12] = words[line * FIELDS + 11][11:0];
            expected_overflow[0 +: 1] = words[line * FIELDS + 12][0:0];
            expected_overflow[1 +: 1] = words[line * FIELDS + 13][0:0];
            expected_overflow[2 +: 1] = words[line * FIELDS + 14][0:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h %h %h\n",
                value[0 +: 12],
                value[12 +: 12],
                value[24 +: 12],
                overflow[0 +: 1],
                overflow[1 +: 1],
                overflow[2 +: 1]);
            if ({value, overflow} !== {expected_value, expected_overflow}) begin
                if (differ == 0) $display("cube3_lit: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_lit: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_lit: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
