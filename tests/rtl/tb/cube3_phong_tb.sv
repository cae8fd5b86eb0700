// Test bench of cube3_phong for the vectors of the unit phong, made from its data sheet by
// cube3 vectors --unit phong --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_phong_tb;
    localparam integer FIELDS = 23;
    localparam integer WORDS = 4194304;

    reg [38:0] normal;
    reg [15:0] ambient;
    reg [0:0] two_sided;
    reg [38:0] light_direction;
    reg [38:0] light_halfway;
    reg [47:0] light_diffuse;
    reg [47:0] light_specular;
    wire [59:0] diffuse;
    reg [59:0] expected_diffuse;
    wire [59:0] specular;
    reg [59:0] expected_specular;

    reg [19:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_phong #(.NORMAL_BITS(12), .COLOUR_BITS(12), .NEAREST(1), .POWER_BITS(5), .LIGHTS(1), .POWER_FILE("phong.power.hex")) dut (
        .normal(normal),
        .ambient(ambient),
        .two_sided(two_sided),
        .light_direction(light_direction),
        .light_halfway(light_halfway),
        .light_diffuse(light_diffuse),
        .light_specular(light_specular),
        .diffuse(diffuse),
        .specular(specular)
    );

    always @(posedge drive) begin
            normal[0 +: 13] <= words[line * FIELDS + 0][12:0];
            normal[13 +: 13] <= words[line * FIELDS + 1][12:0];
            normal[26 +: 13] <= words[line * FIELDS + 2][12:0];
            ambient[0 +: 16] <= words[line * FIELDS + 3][15:0];
            two_sided[0 +: 1] <= words[line * FIELDS + 4][0:0];
            light_direction[0 +: 13] <= words[line * FIELDS + 5][12:0];
            light_direction[13 +: 13] <= words[line * FIELDS + 6][12:0];
            light_direction[26 +: 13] <= words[line * FIELDS + 7][12:0];
            light_halfway[0 +: 13] <= words[line * FIELDS + 8][12:0];
            light_halfway[13 +: 13] <= words[line * FIELDS + 9][12:0];
            light_halfway[26 +: 13] <= words[line * FIELDS + 10][12:0];
            light_diffuse[0 +: 16] <= words[line * FIELDS + 11][15:0];
            light_diffuse[16 +: 16] <= words[line * FIELDS + 12][15:0];
            light_diffuse[32 +: 16] <= words[line * FIELDS + 13][15:0];
            light_specular[0 +: 16] <= words[line * FIELDS + 14][15:0];
            light_specular[16 +: 16] <= words[line * FIELDS + 15][15:0];
            light_specular[32 +: 16] <= words[line * FIELDS + 16][15:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_phong_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit phong\n";
                else if (at == 3) fits = header == "// format normal_bits=12 colour_bits=12 nearest=1 power_bits=5 lights=1\n";
            end
            if (!fits) $display("cube3_phong_tb: %0s is no vector file with the lines\n// unit phong\n// format normal_bits=12 colour_bits=12 nearest=1 power_bits=5 lights=1", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_phong_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_phong_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_diffuse[0 +: 20] = words[line * FIELDS + 17][19:0];
            expected_diffuse[20 +: 20] = words[line * FIELDS + 18][19:0];
            expected_diffuse[40 +: 20] = words[line * FIELDS + 19][19:0];
            expected_specular[0 +: 20] = words[line * FIELDS + 20][19:0];
            expected_specular[20 +: 20] = words[line * FIELDS + 21][19:0];
            expected_specular[40 +: 20] = words[line * FIELDS + 22][19:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h %h %h\n",
                diffuse[0 +: 20],
                diffuse[20 +: 20],
                diffuse[40 +: 20],
                specular[0 +: 20],
                specular[20 +: 20],
                specular[40 +: 20]);
            if ({diffuse, specular} !== {expected_diffuse, expected_specular}) begin
                if (differ == 0) $display("cube3_phong: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_phong: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_phong: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
