// Test bench of cube3_lerp for the vectors of the unit lerp, made from its data sheet by
// cube3 vectors --unit lerp --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
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
    integer file, answers, skip, got, lines, line, differ;
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
            skip = 5;
            while (file != 0 && skip > 0) begin
                got = $fgetc(file);
                if (got == 10) skip = skip - 1;
                if (got < 0) skip = -1;
            end
            if (skip != 0 || $fscanf(file, "// transactions %d", lines) != 1) lines = -1;
            if (lines * FIELDS > WORDS) lines = -1;
            if (lines < 0) $display("cube3_lerp_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
        end
        if (lines < 0) $finish;
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
        if (answers != 0) $fclose(answers);
        $display("cube3_lerp: %0d of %0d lines differ", differ, lines);
        $finish;
        end
    end
endmodule
