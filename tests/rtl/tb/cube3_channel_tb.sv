// Test bench of cube3_channel for the vectors of the unit channel, made from its data sheet by
// cube3 vectors --unit channel --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.
module cube3_channel_tb;
    localparam integer FIELDS = 7;
    localparam integer WORDS = 4194304;

    reg [0:0] push;
    reg [15:0] in_data;
    reg [0:0] pop;
    wire [0:0] can_push;
    reg [0:0] expected_can_push;
    wire [0:0] valid;
    reg [0:0] expected_valid;
    wire [15:0] front;
    reg [15:0] expected_front;
    wire [7:0] occupancy;
    reg [7:0] expected_occupancy;

    reg [15:0] words [0:WORDS-1];
    reg [8*250-1:0] path;
    reg [8*512-1:0] header;
    integer file, answers, at, lines, line, differ;
    reg fits;
    reg clk, rst;
    reg drive;

    cube3_channel #(.CAPACITY(4), .LATENCY(2), .WIDTH(16)) dut (
        .clk(clk),
        .rst(rst),
        .push(push),
        .in_data(in_data),
        .pop(pop),
        .can_push(can_push),
        .valid(valid),
        .front(front),
        .occupancy(occupancy)
    );

    always @(posedge drive) begin
            push[0 +: 1] <= words[line * FIELDS + 0][0:0];
            in_data[0 +: 16] <= words[line * FIELDS + 1][15:0];
            pop[0 +: 1] <= words[line * FIELDS + 2][0:0];
    end

    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs("in=%s", path)) begin
            $display("cube3_channel_tb: +in=FILE is missing: the vectors");
        end else begin
            file = $fopen(path, "r");
            fits = file != 0;
            for (at = 1; fits && at <= 5; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == "// unit channel\n";
                else if (at == 3) fits = header == "// format capacity=4 latency=2\n";
            end
            if (!fits) $display("cube3_channel_tb: %0s is no vector file with the lines\n// unit channel\n// format capacity=4 latency=2", path);
            else begin
                if ($fscanf(file, "// cycles %d", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display("cube3_channel_tb: no vectors with at most %0d lines in %0s", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, "cube3_channel_tb: nothing was compared");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs("out=%s", path)) answers = $fopen(path, "w");
        differ = 0;
        rst = 1; clk = 0; #1 clk = 1; #1 clk = 0; rst = 0;
        for (line = 0; line < lines; line = line + 1) begin
            #1 drive = 1; #1 drive = 0;
            expected_can_push[0 +: 1] = words[line * FIELDS + 3][0:0];
            expected_valid[0 +: 1] = words[line * FIELDS + 4][0:0];
            expected_front[0 +: 16] = words[line * FIELDS + 5][15:0];
            expected_occupancy[0 +: 8] = words[line * FIELDS + 6][7:0];
            #1;
            if (answers != 0) $fwrite(answers, "%h %h %h %h\n",
                can_push[0 +: 1],
                valid[0 +: 1],
                front[0 +: 16],
                occupancy[0 +: 8]);
            if ({can_push, valid, front, occupancy} !== {expected_can_push, expected_valid, expected_front, expected_occupancy}) begin
                if (differ == 0) $display("cube3_channel: line %0d differs first", line);
                differ = differ + 1;
            end
            #1 clk = 1; #1 clk = 0;
        end
        $display("cube3_channel: %0d of %0d lines differ", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, "cube3_channel: lines differ");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule
