// Test bench of cube3_reflectance for the vectors of the unit reflectance, made from its data sheet by
// cube3 vectors --unit reflectance --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
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
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
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
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit reflectance\n";
                else if (at == 3) fits = header == "// format gradient_bits=17 kept_bits=0 colour_bits=12 reflectance_bits=2\n";
            end
            if (!fits) $display("cube3_reflectance_tb: %0s is no vector file with the lines\n// unit reflectance\n// format gradient_bits=17 kept_bits=0 colour_bits=12 reflectance_bits=2", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_reflectance_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_reflectance_tb: nothing was compared");
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
        $display("cube3_reflectance: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_reflectance: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
