// A first-in first-out channel of CAPACITY tokens, each of which takes LATENCY cycles from push to pop.
//
// Equals cube3_channel::Channel. One token is pushed and one popped in a cycle at most. A token on its way counts towards the
// capacity, and the credit of a popped token comes back with the clock edge, so a full rate needs a capacity of LATENCY + 1.
// The outputs are those of the cycle before its edge, and depend on registers only; a push without `can_push` and a pop
// without `valid` are ignored. CAPACITY is 1 to 255, LATENCY 1 or more; reset is synchronous.
module cube3_channel #(
    parameter integer WIDTH = 16,
    parameter integer CAPACITY = 4,
    parameter integer LATENCY = 2
) (
    input  wire             clk,
    input  wire             rst,
    input  wire             push,
    input  wire [WIDTH-1:0] in_data,
    input  wire             pop,
    output wire             can_push,
    output wire             valid,
    output wire [WIDTH-1:0] front,
    output wire [7:0]       occupancy
);
    localparam integer P = CAPACITY > 1 ? $clog2(CAPACITY) : 1;
    localparam [P-1:0] LAST = P'(CAPACITY - 1);

    reg [WIDTH-1:0] slots [0:CAPACITY-1];
    // Where the oldest token is, and where the next one goes.
    reg [P-1:0] head;
    reg [P-1:0] tail;
    // Tokens held, and those of them that have arrived.
    reg [7:0] held;
    reg [7:0] arrived;

    wire pushes = push && can_push;
    wire pops = pop && valid;

    assign can_push = held < 8'(CAPACITY);
    assign valid = arrived != 8'd0;
    assign front = valid ? slots[head] : WIDTH'(0);
    assign occupancy = held;

    // A token arrives LATENCY - 1 cycles after the edge that took it.
    wire arrives;

    generate
        if (LATENCY > 1) begin : delayed
            reg [LATENCY-2:0] on_the_way;
            always_ff @(posedge clk) begin
                if (rst) on_the_way <= (LATENCY-1)'(0);
                else on_the_way <= (LATENCY-1)'({on_the_way, pushes});
            end
            assign arrives = on_the_way[LATENCY-2];
        end else begin : at_once
            assign arrives = pushes;
        end
    endgenerate

    always_ff @(posedge clk) begin
        if (rst) begin
            head <= P'(0);
            tail <= P'(0);
            held <= 8'd0;
            arrived <= 8'd0;
        end else begin
            if (pushes) begin
                slots[tail] <= in_data;
                tail <= tail == LAST ? P'(0) : tail + P'(1);
            end
            if (pops) head <= head == LAST ? P'(0) : head + P'(1);
            held <= held + {7'd0, pushes} - {7'd0, pops};
            arrived <= arrived + {7'd0, arrives} - {7'd0, pops};
        end
    end
endmodule
