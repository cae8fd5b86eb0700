// Test bench of cube3_reflectance for the vectors of the unit reflectance, made from its data sheet by
// cube3 vectors --unit reflectance --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
module cube3_reflectance_tb;
    localparam integer FIELDS = 10;
    localparam integer WORDS = 4194304;

    reg [50:0] g;
    reg [15:0] flat;
    wire [47:0] diffuse;
    reg [47:0] expected_diffuse;
    wire [47:0] specular;
    reg [47:0] expected_specular;

    reg [16:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    integer file, answers, skip, got, lines, line, differ;
    reg drive;

    cube3_reflectance #(.GRADIENT_BITS(17), .KEPT_BITS(0), .COLOUR_BITS(12), .REFLECTANCE_BITS(2), .DIFFUSE_FILE("reflectance.diffuse.hex"), .SPECULAR_FILE("reflectance.specular.hex")) dut (
        .g(g),
        .flat(flat),
        .diffuse(diffuse),
        .specular(specular)
    );

    always @(posedge drive) begin
            g[0 +: 17] <= words[line * FIELDS + 0][16:0];
            g[17 +: 17] <= words[line * FIELDS + 1][16:0];
            g[34 +: 17] <= words[line * FIELDS + 2][16:0];
            flat[0 +: 16] <= words[line * FIELDS + 3][15:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_reflectance_tb: +in=FILE is missing: the vectors");
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
            if (lines < 0) $display("cube3_reflectance_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
        end
        if (lines < 0) $finish;
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_diffuse[0 +: 16] = words[line * FIELDS + 4][15:0];
            expected_diffuse[16 +: 16] = words[line * FIELDS + 5][15:0];
            expected_diffuse[32 +: 16] = words[line * FIELDS + 6][15:0];
            expected_specular[0 +: 16] = words[line * FIELDS + 7][15:0];
            expected_specular[16 +: 16] = words[line * FIELDS + 8][15:0];
            expected_specular[32 +: 16] = words[line * FIELDS + 9][15:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h %h %h\n",
                diffuse[0 +: 16],
                diffuse[16 +: 16],
                diffuse[32 +: 16],
                specular[0 +: 16],
                specular[16 +: 16],
                specular[32 +: 16]);
            if ({diffuse, specular} !== {expected_diffuse, expected_specular}) begin
                if (differ == 0) $display("cube3_reflectance: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        if (answers != 0) $fclose(answers);
        $display("cube3_reflectance: %0d of %0d lines differ", differ, lines);
        $finish;
        end
    end
endmodule
