// Test bench of cube3_cue for the vectors of the unit cue, made from its data sheet by
// cube3 vectors --unit cue --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_cue_tb;
    localparam integer FIELDS = 7;
    localparam integer WORDS = 4194304;

    reg [35:0] colour;
    reg [12:0] factor;
    wire [35:0] value;
    reg [35:0] expected_value;

    reg [12:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_cue #(.COLOUR_BITS(12), .NEAREST(1)) dut (
        .colour(colour),
        .factor(factor),
        .value(value)
    );

    always @(posedge drive) begin
            colour[0 +: 12] <= words[line * FIELDS + 0][11:0];
            colour[12 +: 12] <= words[line * FIELDS + 1][11:0];
            colour[24 +: 12] <= words[line * FIELDS + 2][11:0];
            factor[0 +: 13] <= words[line * FIELDS + 3][12:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_cue_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit cue\n";
                else if (at == 3) fits = header == "// format colour_bits=12 nearest=1\n";
            end
            if (!fits) $display("cube3_cue_tb: %0s is no vector file with the lines\n// unit cue\n// format colour_bits=12 nearest=1", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_cue_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_cue_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_value[0 +: 12] = words[line * FIELDS + 4][11:0];
            expected_value[12 +: 12] = words[line * FIELDS + 5][11:0];
            expected_value[24 +: 12] = words[line * FIELDS + 6][11:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h\n",
                value[0 +: 12],
                value[12 +: 12],
                value[24 +: 12]);
            if ({value} !== {expected_value}) begin
                if (differ == 0) $display("cube3_cue: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_cue: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_cue: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
