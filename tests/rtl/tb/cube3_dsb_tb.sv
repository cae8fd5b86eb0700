// Test bench of cube3_dsb for the vectors of the unit dsb, made from its data sheet by
// cube3 vectors --unit dsb --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
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
    integer file, answers, skip, got, lines, line, differ;
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
            skip = 5;
            while (file != 0 && skip > 0) begin
                got = $fgetc(file);
                if (got == 10) skip = skip - 1;
                if (got < 0) skip = -1;
            end
            if (skip != 0 || $fscanf(file, "// transactions %d", lines) != 1) lines = -1;
            if (lines * FIELDS > WORDS) lines = -1;
            if (lines < 0) $display("cube3_dsb_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
        end
        if (lines < 0) $finish;
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
        if (answers != 0) $fclose(answers);
        $display("cube3_dsb: %0d of %0d lines differ", differ, lines);
        $finish;
        end
    end
endmodule
