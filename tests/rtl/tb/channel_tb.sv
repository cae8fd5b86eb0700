// Test bench of cube3_channel: one line of +in=FILE a cycle (push, data, pop in hexadecimal), one line of outputs each:
// can_push valid front occupancy, as seen before the cycle's clock edge.
module channel_tb #(
    parameter integer WIDTH = 16,
    parameter integer CAPACITY = 4,
    parameter integer LATENCY = 2,
    parameter integer CYCLES = 1
);
    reg clk = 1'b0;
    reg rst = 1'b1;
    reg push = 1'b0;
    reg pop = 1'b0;
    reg [WIDTH-1:0] in_data = WIDTH'(0);
    wire can_push;
    wire valid;
    wire [WIDTH-1:0] front;
    wire [7:0] occupancy;

    cube3_channel #(.WIDTH(WIDTH), .CAPACITY(CAPACITY), .LATENCY(LATENCY)) channel (
        .clk(clk), .rst(rst), .push(push), .in_data(in_data), .pop(pop), .can_push(can_push), .valid(valid),
        .front(front), .occupancy(occupancy)
    );

    // Three fields a cycle.
    reg [WIDTH-1:0] stimulus [0:3*CYCLES-1];
    reg [8*1024-1:0] file;
    integer cycle;

    initial begin
        if (!$value$plusargs("in=%s", file)) begin
            $display("+in=FILE is missing");
            $finish;
        end
        $readmemh(file, stimulus);
        // Two edges in reset.
        repeat (2) begin
            #1 clk = 1'b1;
            #1 clk = 1'b0;
        end
        rst = 1'b0;
        for (cycle = 0; cycle < CYCLES; cycle = cycle + 1) begin
            push = stimulus[3*cycle][0];
            in_data = stimulus[3*cycle+1];
            pop = stimulus[3*cycle+2][0];
            #1 $display("%h %h %h %h", can_push, valid, front, occupancy);
            clk = 1'b1;
            #1 clk = 1'b0;
        end
        $finish;
    end
endmodule
