// Test bench of cube3_dsb for the vectors of the unit dsb, made from its data sheet by
// cube3 vectors --unit dsb --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_dsb_tb;
    localparam integer FIELDS = 5;
    localparam integer WORDS = 4194304;

    reg [11:0] slot;
    reg [11:0] depth;
    wire [11:0] beam_module;
    reg [11:0] expected_beam_module;
    wire [11:0] beam_place;
    reg [11:0] expected_beam_place;
    wire [11:0] ray_place;
    reg [11:0] expected_ray_place;

    reg [11:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_dsb #(.LANES(8)) dut (
        .slot(slot),
        .depth(depth),
        .beam_module(beam_module),
        .beam_place(beam_place),
        .ray_place(ray_place)
    );

    always @(posedge drive) begin
            slot[0 +: 12] <= words[line * FIELDS + 0][11:0];
            depth[0 +: 12] <= words[line * FIELDS + 1][11:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_dsb_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit dsb\n";
                else if (at == 3) fits = header == "// format lanes=8\n";
            end
            if (!fits) $display("cube3_dsb_tb: %0s is no vector file with the lines\n// unit dsb\n// format lanes=8", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_dsb_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_dsb_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_beam_module[0 +: 12] = words[line * FIELDS + 2][11:0];
            expected_beam_place[0 +: 12] = words[line * FIELDS + 3][11:0];
            expected_ray_place[0 +: 12] = words[line * FIELDS + 4][11:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h\n",
                beam_module[0 +: 12],
                beam_place[0 +: 12],
                ray_place[0 +: 12]);
            if ({beam_module, beam_place, ray_place} !== {expected_beam_module, expected_beam_place, expected_ray_place}) begin
                if (differ == 0) $display("cube3_dsb: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_dsb: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_dsb: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
