// Test bench of cube3_classify for the vectors of the unit classify, made from its data sheet by
// cube3 vectors --unit classify --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_classify_tb;
    localparam integer FIELDS = 11;
    localparam integer WORDS = 4194304;

    reg [15:0] sample;
    reg [17:0] magnitude;
    reg [3:0] length_class;
    reg [31:0] threshold;
    reg [4:0] row_shift;
    wire [0:0] visible;
    reg [0:0] expected_visible;
    wire [11:0] opacity;
    reg [11:0] expected_opacity;
    wire [35:0] colour;
    reg [35:0] expected_colour;

    reg [17:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_classify #(.VOXEL_BITS(16), .SAMPLE_FRACTION_BITS(0), .GRADIENT_BITS(17), .KEPT_BITS(0), .TABLE_BITS(6), .COLOUR_BITS(12), .OPACITY_BITS(12), .ROWS(1), .CLASSES(1), .OPACITY_FILE("classify.opacity.hex"), .COLOUR_FILE("classify.colour.hex")) dut (
        .sample(sample),
        .magnitude(magnitude),
        .length_class(length_class),
        .threshold(threshold),
        .row_shift(row_shift),
        .visible(visible),
        .opacity(opacity),
        .colour(colour)
    );

    always @(posedge drive) begin
            sample[0 +: 16] <= words[line * FIELDS + 0][15:0];
            magnitude[0 +: 18] <= words[line * FIELDS + 1][17:0];
            length_class[0 +: 4] <= words[line * FIELDS + 2][3:0];
            threshold[0 +: 16] <= words[line * FIELDS + 3][15:0];
            threshold[16 +: 16] <= words[line * FIELDS + 4][15:0];
            row_shift[0 +: 5] <= words[line * FIELDS + 5][4:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_classify_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit classify\n";
                else if (at == 3) fits = header == "// format voxel_bits=16 sample_fraction_bits=0 gradient_bits=17 kept_bits=0 table_bits=6 colour_bits=12 opacity_bits=12 rows=1 classes=1\n";
            end
            if (!fits) $display("cube3_classify_tb: %0s is no vector file with the lines\n// unit classify\n// format voxel_bits=16 sample_fraction_bits=0 gradient_bits=17 kept_bits=0 table_bits=6 colour_bits=12 opacity_bits=12 rows=1 classes=1", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_classify_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_classify_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_visible[0 +: 1] = words[line * FIELDS + 6][0:0];
            expected_opacity[0 +: 12] = words[line * FIELDS + 7][11:0];
            expected_colour[0 +: 12] = words[line * FIELDS + 8][11:0];
            expected_colour[12 +: 12] = words[line * FIELDS + 9][11:0];
            expected_colour[24 +: 12] = words[line * FIELDS + 10][11:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h %h\n",
                visible[0 +: 1],
                opacity[0 +: 12],
                colour[0 +: 12],
                colour[12 +: 12],
                colour[24 +: 12]);
            if ({visible, opacity, colour} !== {expected_visible, expected_opacity, expected_colour}) begin
                if (differ == 0) $display("cube3_classify: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_classify: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_classify: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
