// Test bench of cube3_lerp for the vectors of the unit lerp, made from its data sheet by
// cube3 vectors --unit lerp --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_lerp_tb;
    localparam integer FIELDS = 4;
    localparam integer WORDS = 4194304;

    reg [15:0] near;
    reg [15:0] far;
    reg [8:0] weight;
    wire [15:0] value;
    reg [15:0] expected_value;

    reg [15:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_lerp #(.VOXEL_BITS(16), .WEIGHT_BITS(8), .SAMPLE_FRACTION_BITS(0), .NEAREST(1)) dut (
        .near(near),
        .far(far),
        .weight(weight),
        .value(value)
    );

    always @(posedge drive) begin
            near[0 +: 16] <= words[line * FIELDS + 0][15:0];
            far[0 +: 16] <= words[line * FIELDS + 1][15:0];
            weight[0 +: 9] <= words[line * FIELDS + 2][8:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_lerp_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit lerp\n";
                else if (at == 3) fits = header == "// format voxel_bits=16 weight_bits=8 sample_fraction_bits=0 nearest=1\n";
            end
            if (!fits) $display("cube3_lerp_tb: %0s is no vector file with the lines\n// unit lerp\n// format voxel_bits=16 weight_bits=8 sample_fraction_bits=0 nearest=1", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_lerp_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_lerp_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_value[0 +: 16] = words[line * FIELDS + 3][15:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h\n",
                value[0 +: 16]);
            if ({value} !== {expected_value}) begin
                if (differ == 0) $display("cube3_lerp: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_lerp: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_lerp: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
