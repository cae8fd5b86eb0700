// A circle of items turned: item i of the result is item (i + amount) mod ITEMS.
//
// A barrel of one stage for each bit of the amount; the amount is below ITEMS. Selections only: no operators.
module cube3_turn #(
    parameter integer ITEMS = 8,
    parameter integer WIDTH = 16,
    parameter integer AMOUNT_BITS = 3
) (
    input  wire [AMOUNT_BITS-1:0] amount,
    input  wire [ITEMS*WIDTH-1:0] items,
    output reg  [ITEMS*WIDTH-1:0] turned
);
    integer b;
    always @* begin
        turned = items;
        for (b = 0; b < AMOUNT_BITS; b = b + 1) begin
            if (amount[b]) begin
                turned = turned >> ((1 << b) % ITEMS * WIDTH) | turned << ((ITEMS - (1 << b) % ITEMS) * WIDTH);
            end
        end
    end
endmodule
