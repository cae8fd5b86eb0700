// Test bench of cube3_clip for the vectors of the unit clip, made from its data sheet by
// cube3 vectors --unit clip --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_clip_tb;
    localparam integer FIELDS = 8;
    localparam integer WORDS = 4194304;

    reg [13:0] u;
    reg [13:0] v;
    reg [13:0] k;
    reg [33:0] step_u;
    reg [33:0] step_v;
    reg [34:0] step_k;
    reg [61:0] constant;
    wire [0:0] kept;
    reg [0:0] expected_kept;

    reg [61:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_clip #() dut (
        .u(u),
        .v(v),
        .k(k),
        .step_u(step_u),
        .step_v(step_v),
        .step_k(step_k),
        .constant(constant),
        .kept(kept)
    );

    always @(posedge drive) begin
            u[0 +: 14] <= words[line * FIELDS + 0][13:0];
            v[0 +: 14] <= words[line * FIELDS + 1][13:0];
            k[0 +: 14] <= words[line * FIELDS + 2][13:0];
            step_u[0 +: 34] <= words[line * FIELDS + 3][33:0];
            step_v[0 +: 34] <= words[line * FIELDS + 4][33:0];
            step_k[0 +: 35] <= words[line * FIELDS + 5][34:0];
            constant[0 +: 62] <= words[line * FIELDS + 6][61:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_clip_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit clip\n";
                else if (at == 3) fits = header == "// format\n";
            end
            if (!fits) $display("cube3_clip_tb: %0s is no vector file with the lines\n// unit clip\n// format", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_clip_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_clip_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_kept[0 +: 1] = words[line * FIELDS + 7][0:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h\n",
                kept[0 +: 1]);
            if ({kept} !== {expected_kept}) begin
                if (differ == 0) $display("cube3_clip: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_clip: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_clip: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
