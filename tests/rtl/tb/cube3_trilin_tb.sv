// Test bench of cube3_trilin for the vectors of the unit trilin, made from its data sheet by
// cube3 vectors --unit trilin --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_trilin_tb;
    localparam integer FIELDS = 12;
    localparam integer WORDS = 4194304;

    reg [127:0] voxel;
    reg [8:0] weight_w;
    reg [8:0] weight_u;
    reg [8:0] weight_v;
    wire [15:0] sample;
    reg [15:0] expected_sample;

    reg [15:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_trilin #(.VOXEL_BITS(16), .WEIGHT_BITS(8), .SAMPLE_FRACTION_BITS(0), .NEAREST(1)) dut (
        .voxel(voxel),
        .weight_w(weight_w),
        .weight_u(weight_u),
        .weight_v(weight_v),
        .sample(sample)
    );

    always @(posedge drive) begin
            voxel[0 +: 16] <= words[line * FIELDS + 0][15:0];
            voxel[16 +: 16] <= words[line * FIELDS + 1][15:0];
            voxel[32 +: 16] <= words[line * FIELDS + 2][15:0];
            voxel[48 +: 16] <= words[line * FIELDS + 3][15:0];
            voxel[64 +: 16] <= words[line * FIELDS + 4][15:0];
            voxel[80 +: 16] <= words[line * FIELDS + 5][15:0];
            voxel[96 +: 16] <= words[line * FIELDS + 6][15:0];
            voxel[112 +: 16] <= words[line * FIELDS + 7][15:0];
            weight_w[0 +: 9] <= words[line * FIELDS + 8][8:0];
            weight_u[0 +: 9] <= words[line * FIELDS + 9][8:0];
            weight_v[0 +: 9] <= words[line * FIELDS + 10][8:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_trilin_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit trilin\n";
                else if (at == 3) fits = header == "// format voxel_bits=16 weight_bits=8 sample_fraction_bits=0 nearest=1\n";
            end
            if (!fits) $display("cube3_trilin_tb: %0s is no vector file with the lines\n// unit trilin\n// format voxel_bits=16 weight_bits=8 sample_fraction_bits=0 nearest=1", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_trilin_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_trilin_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_sample[0 +: 16] = words[line * FIELDS + 11][15:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h\n",
                sample[0 +: 16]);
            if ({sample} !== {expected_sample}) begin
                if (differ == 0) $display("cube3_trilin: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_trilin: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_trilin: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
