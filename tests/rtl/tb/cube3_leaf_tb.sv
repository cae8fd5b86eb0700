// Test bench of cube3_leaf for the vectors of the unit leaf, made from its data sheet by
// cube3 vectors --unit leaf --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_leaf_tb;
    localparam integer FIELDS = 14;
    localparam integer WORDS = 4194304;

    reg [2:0] mode;
    reg [11:0] opaque;
    reg [0:0] present;
    reg [15:0] sample;
    reg [11:0] opacity;
    reg [35:0] colour;
    wire [0:0] out_present;
    reg [0:0] expected_out_present;
    wire [15:0] out_sample;
    reg [15:0] expected_out_sample;
    wire [63:0] out_rgba;
    reg [63:0] expected_out_rgba;

    reg [15:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_leaf #(.VOXEL_BITS(16), .SAMPLE_FRACTION_BITS(0), .COLOUR_BITS(12), .OPACITY_BITS(12), .ACCUMULATOR_BITS(16), .NEAREST(1)) dut (
        .mode(mode),
        .opaque(opaque),
        .present(present),
        .sample(sample),
        .opacity(opacity),
        .colour(colour),
        .out_present(out_present),
        .out_sample(out_sample),
        .out_rgba(out_rgba)
    );

    always @(posedge drive) begin
            mode[0 +: 3] <= words[line * FIELDS + 0][2:0];
            opaque[0 +: 12] <= words[line * FIELDS + 1][11:0];
            present[0 +: 1] <= words[line * FIELDS + 2][0:0];
            sample[0 +: 16] <= words[line * FIELDS + 3][15:0];
            opacity[0 +: 12] <= words[line * FIELDS + 4][11:0];
            colour[0 +: 12] <= words[line * FIELDS + 5][11:0];
            colour[12 +: 12] <= words[line * FIELDS + 6][11:0];
            colour[24 +: 12] <= words[line * FIELDS + 7][11:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_leaf_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit leaf\n";
                else if (at == 3) fits = header == "// format voxel_bits=16 sample_fraction_bits=0 colour_bits=12 opacity_bits=12 accumulator_bits=16 nearest=1\n";
            end
            if (!fits) $display("cube3_leaf_tb: %0s is no vector file with the lines\n// unit leaf\n// format voxel_bits=16 sample_fraction_bits=0 colour_bits=12 opacity_bits=12 accumulator_bits=16 nearest=1", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_leaf_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_leaf_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_out_present[0 +: 1] = words[line * FIELDS + 8][0:0];
            expected_out_sample[0 +: 16] = words[line * FIELDS + 9][15:0];
            expected_out_rgba[0 +: 16] = words[line * FIELDS + 10][15:0];
            expected_out_rgba[16 +: 16] = words[line * FIELDS + 11][15:0];
            expected_out_rgba[32 +: 16] = words[line * FIELDS + 12][15:0];
            expected_out_rgba[48 +: 16] = words[line * FIELDS + 13][15:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h %h %h\n",
                out_present[0 +: 1],
                out_sample[0 +: 16],
                out_rgba[0 +: 16],
                out_rgba[16 +: 16],
                out_rgba[32 +: 16],
                out_rgba[48 +: 16]);
            if ({out_present, out_sample, out_rgba} !== {expected_out_present, expected_out_sample, expected_out_rgba}) begin
                if (differ == 0) $display("cube3_leaf: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_leaf: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_leaf: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
