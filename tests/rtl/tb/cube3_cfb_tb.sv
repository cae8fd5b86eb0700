// Test bench of cube3_cfb for the vectors of the unit cfb, made from its data sheet by
// cube3 vectors --unit cfb --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_cfb_tb;
    localparam integer FIELDS = 5;
    localparam integer WORDS = 4194304;

    reg [11:0] x;
    reg [11:0] y;
    reg [11:0] z;
    wire [11:0] module_number;
    reg [11:0] expected_module_number;
    wire [35:0] address;
    reg [35:0] expected_address;

    reg [35:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg drive;

    cube3_cfb #(.LANES(8), .NX(16), .NY(16), .NZ(16), .SKEW_A(1), .SKEW_B(1), .SKEW_C(1), .BLOCKS(0)) dut (
        .x(x),
        .y(y),
        .z(z),
        .module_number(module_number),
        .address(address)
    );

    always @(posedge drive) begin
            x[0 +: 12] <= words[line * FIELDS + 0][11:0];
            y[0 +: 12] <= words[line * FIELDS + 1][11:0];
            z[0 +: 12] <= words[line * FIELDS + 2][11:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_cfb_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit cfb\n";
                else if (at == 3) fits = header == "// format lanes=8 nx=16 ny=16 nz=16 skew_a=1 skew_b=1 skew_c=1 blocks=0\n";
            end
            if (!fits) $display("cube3_cfb_tb: %0s is no vector file with the lines\n// unit cfb\n// format lanes=8 nx=16 ny=16 nz=16 skew_a=1 skew_b=1 skew_c=1 blocks=0", path);
            else begin
                if ($fscanf(file, "// transactions %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_cfb_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_cfb_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_module_number[0 +: 12] = words[line * FIELDS + 3][11:0];
            expected_address[0 +: 36] = words[line * FIELDS + 4][35:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h\n",
                module_number[0 +: 12],
                address[0 +: 36]);
            if ({module_number, address} !== {expected_module_number, expected_address}) begin
                if (differ == 0) $display("cube3_cfb: line %0d differs first", line);
                differ = differ + 1;
            end
        end
        $display("cube3_cfb: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_cfb: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
