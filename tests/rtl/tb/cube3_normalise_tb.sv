// Test bench of cube3_normalise for the vectors of the unit normalise, made from its data sheet by
// cube3 vectors --unit normalise --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_normalise_tb;
    localparam integer FIELDS = 7;
    localparam integer WORDS = 4194304;

    reg [50:0] g;
    wire [38:0] direction;
    reg [38:0] expected_direction;
    wire [17:0] magnitude;
    reg [17:0] expected_magnitude;

    reg [17:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_normalise #(.GRADIENT_BITS(17), .KEPT_BITS(0), .NORMAL_BITS(12), .ROOT_BITS(4), .ROOT_FILE("normalise.root.hex")) dut (
        .g(g),
        .direction(direction),
        .magnitude(magnitude)
    );

    always @(posedge drive) begin
            g[0 +: 17] <= words[line * FIELDS + 0][16:0];
            g[17 +: 17] <= words[line * FIELDS + 1][16:0];
            g[34 +: 17] <= words[line * FIELDS + 2][16:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_normalise_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit normalise\n";
                else if (at == 3) fits = header == "// format gradient_bits=17 kept_bits=0 normal_bits=12 root_bits=4\n";
            end
            if (!fits) $display("cube3_normalise_tb: %0s is no vector file with the lines\n// unit normalise\n// format gradient_bits=17 kept_bits=0 normal_bits=12 root_bits=4", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_normalise_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_normalise_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_direction[0 +: 13] = words[line * FIELDS + 3][12:0];
            expected_direction[13 +: 13] = words[line * FIELDS + 4][12:0];
            expected_direction[26 +: 13] = words[line * FIELDS + 5][12:0];
            expected_magnitude[0 +: 18] = words[line * FIELDS + 6][17:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h\n",
                direction[0 +: 13],
                direction[13 +: 13],
                direction[26 +: 13],
                magnitude[0 +: 18]);
            if ({direction, magnitude} !== {expected_direction, expected_magnitude}) begin
                if (differ == 0) $display("cube3_normalise: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_normalise: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_normalise: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
