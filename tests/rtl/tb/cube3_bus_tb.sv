// Test bench of cube3_bus for the vectors of the unit bus, made from its data sheet by
// cube3 vectors --unit bus --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_bus_tb;
    localparam integer FIELDS = 19;
    localparam integer WORDS = 4194304;

    reg [11:0] row;
    reg [11:0] column;
    reg [127:0] voxel;
    wire [11:0] rotation;
    reg [11:0] expected_rotation;
    wire [127:0] out;
    reg [127:0] expected_out;

    reg [15:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_bus #(.VOXEL_BITS(16), .LANES(8)) dut (
        .row(row),
        .column(column),
        .voxel(voxel),
        .rotation(rotation),
        .out(out)
    );

    always @(posedge drive) begin
            row[0 +: 12] <= words[line * FIELDS + 0][11:0];
            column[0 +: 12] <= words[line * FIELDS + 1][11:0];
            voxel[0 +: 16] <= words[line * FIELDS + 2][15:0];
            voxel[16 +: 16] <= words[line * FIELDS + 3][15:0];
            voxel[32 +: 16] <= words[line * FIELDS + 4][15:0];
            voxel[48 +: 16] <= words[line * FIELDS + 5][15:0];
            voxel[64 +: 16] <= words[line * FIELDS + 6][15:0];
            voxel[80 +: 16] <= words[line * FIELDS + 7][15:0];
            voxel[96 +: 16] <= words[line * FIELDS + 8][15:0];
            voxel[112 +: 16] <= words[line * FIELDS + 9][15:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_bus_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit bus\n";
                else if (at == 3) fits = header == "// format voxel_bits=16 lanes=8\n";
            end
            if (!fits) $display("cube3_bus_tb: %0s is no vector file with the lines\n// unit bus\n// format voxel_bits=16 lanes=8", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_bus_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_bus_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_rotation[0 +: 12] = words[line * FIELDS + 10][11:0];
            expected_out[0 +: 16] = words[line * FIELDS + 11][15:0];
            expected_out[16 +: 16] = words[line * FIELDS + 12][15:0];
            expected_out[32 +: 16] = words[line * FIELDS + 13][15:0];
            expected_out[48 +: 16] = words[line * FIELDS + 14][15:0];
            expected_out[64 +: 16] = words[line * FIELDS + 15][15:0];
            expected_out[80 +: 16] = words[line * FIELDS + 16][15:0];
            expected_out[96 +: 16] = words[line * FIELDS + 17][15:0];
            expected_out[112 +: 16] = words[line * FIELDS + 18][15:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h %h %h %h %h %h\n",
                rotation[0 +: 12],
                out[0 +: 16],
                out[16 +: 16],
                out[32 +: 16],
                out[48 +: 16],
                out[64 +: 16],
                out[80 +: 16],
                out[96 +: 16],
                out[112 +: 16]);
            if ({rotation, out} !== {expected_rotation, expected_out}) begin
                if (differ == 0) $display("cube3_bus: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_bus: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_bus: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
