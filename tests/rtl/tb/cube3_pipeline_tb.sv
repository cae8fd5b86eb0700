// Runs frames on cube3_pipeline: loads what `cube3::rtl_frame` exports, and writes the pixels and the counters.
//
// +frame=FOLDER with registers.hex, voxels.hex, root.hex, opacity.hex, colour.hex, power.hex; +out=FILE; +repeat=COUNT runs the
// frame so often and writes the last time; +activity=FILE writes each cycle's activity of the units, the last unit first; +limit=CYCLES
// gives a frame up that has not ended by then, with the line `unfinished CYCLES`.
// A line of the output is `pixel U V R G B A` (U and V decimal, colours hex), then `cycles`, `account` for each unit, `occupancy`
// for each channel, `overflows`, all decimal.
module cube3_pipeline_tb;
    parameter integer N = 8;
    parameter integer PADDED = 0;
    parameter integer METHOD = 12;
    parameter integer VOXEL_BITS = 16;
    parameter integer WEIGHT_BITS = 8;
    parameter integer SAMPLE_FRACTION_BITS = 0;
    parameter integer GRADIENT_BITS = 17;
    parameter integer NORMAL_BITS = 12;
    parameter integer TABLE_BITS = 12;
    parameter integer COLOUR_BITS = 12;
    parameter integer OPACITY_BITS = 12;
    parameter integer ACCUMULATOR_BITS = 16;
    parameter integer NEAREST = 1;
    parameter integer KEPT_BITS = 0;
    parameter integer ROOT_BITS = 8;
    parameter integer POWER_BITS = 10;
    localparam integer A = ACCUMULATOR_BITS;
    localparam integer R = $clog2(N) + 2;
    localparam integer REGISTERS = 48 + 4 * N + 2;

    reg clk = 1'b0;
    reg rst = 1'b1;
    reg load = 1'b0;
    reg load_voxel = 1'b0;
    reg [31:0] load_address = 32'd0;
    reg [31:0] load_data = 32'd0;
    wire pixel_valid;
    wire [1:0] pixel_count;
    wire [3*R-1:0] pixel_u;
    wire [3*R-1:0] pixel_v;
    wire [12*A-1:0] pixel_rgba;
    wire done;
    wire [31:0] cycles;
    wire [8*96-1:0] accounts;
    wire [15:0] activities;
    wire [6*32-1:0] occupancies;
    wire [31:0] shading_overflows;
    wire [31:0] pixel_overflows;
    cube3_pipeline #(
        .N(N), .PADDED(PADDED), .METHOD(METHOD), .VOXEL_BITS(VOXEL_BITS), .WEIGHT_BITS(WEIGHT_BITS),
        .SAMPLE_FRACTION_BITS(SAMPLE_FRACTION_BITS), .GRADIENT_BITS(GRADIENT_BITS), .NORMAL_BITS(NORMAL_BITS),
        .TABLE_BITS(TABLE_BITS), .COLOUR_BITS(COLOUR_BITS), .OPACITY_BITS(OPACITY_BITS),
        .ACCUMULATOR_BITS(ACCUMULATOR_BITS), .NEAREST(NEAREST), .KEPT_BITS(KEPT_BITS), .ROOT_BITS(ROOT_BITS),
        .POWER_BITS(POWER_BITS)
    ) dut (
        .clk(clk), .rst(rst), .load(load), .load_voxel(load_voxel), .load_address(load_address), .load_data(load_data),
        .pixel_valid(pixel_valid), .pixel_count(pixel_count), .pixel_u(pixel_u), .pixel_v(pixel_v), .pixel_rgba(pixel_rgba),
        .done(done), .cycles(cycles), .accounts(accounts), .activities(activities), .occupancies(occupancies),
        .shading_overflows(shading_overflows), .pixel_overflows(pixel_overflows)
    );

    string folder;
    string out;
    string activity;
    integer repeat_;
    integer limit;
    integer waited;
    integer run;
    integer i;
    integer p;
    integer file;
    integer activity_file;
    reg writes;
    reg [31:0] registers[0:REGISTERS-1];
    reg [VOXEL_BITS-1:0] voxels[0:N*N*N-1];

    // The tables of every lane.
    genvar k;
    generate
        for (k = 0; k < N; k = k + 1) begin : tables
            string from;
            initial begin
                if ($value$plusargs("frame=%s", from)) begin
                    $readmemh({from, "/root.hex"}, dut.abc.lane[k].normaliser.root);
                    $readmemh({from, "/opacity.hex"}, dut.abc.lane[k].tables.opacities);
                    $readmemh({from, "/colour.hex"}, dut.abc.lane[k].tables.colours);
                    $readmemh({from, "/power.hex"}, dut.abc.lane[k].light.powers);
                end
            end
        end
    endgenerate

    always #5 clk = !clk;

    // Pixels and activities are those before the edge.
    always @(posedge clk) begin
        if (writes && pixel_valid) begin
            for (p = 0; p < pixel_count; p = p + 1) begin
                $fdisplay(file, "pixel %0d %0d %h %h %h %h", $signed(pixel_u[p*R+:R]), $signed(pixel_v[p*R+:R]),
                          pixel_rgba[4*p*A+:A], pixel_rgba[(4*p+1)*A+:A], pixel_rgba[(4*p+2)*A+:A],
                          pixel_rgba[(4*p+3)*A+:A]);
            end
        end
        if (activity_file != 0 && writes && !rst && !done) $fdisplay(activity_file, "%h", activities);
    end

    initial begin
        writes = 1'b0;
        activity_file = 0;
        if (!$value$plusargs("frame=%s", folder) || !$value$plusargs("out=%s", out)) begin
            $display("give +frame=FOLDER and +out=FILE");
            $finish;
        end
        if (!$value$plusargs("repeat=%d", repeat_)) repeat_ = 1;
        if (!$value$plusargs("limit=%d", limit)) limit = 0;
        if ($value$plusargs("activity=%s", activity)) activity_file = $fopen(activity, "w");
        file = $fopen(out, "w");
        $readmemh({folder, "/registers.hex"}, registers);
        $readmemh({folder, "/voxels.hex"}, voxels);
        load = 1'b1;
        for (i = 0; i < REGISTERS; i = i + 1) begin
            load_address = i;
            load_data = registers[i];
            @(negedge clk);
        end
        load_voxel = 1'b1;
        for (i = 0; i < N * N * N; i = i + 1) begin
            load_address = i;
            load_data = {{32 - VOXEL_BITS{1'b0}}, voxels[i]};
            @(negedge clk);
        end
        load = 1'b0;
        for (run = 1; run <= repeat_; run = run + 1) begin
            rst = 1'b1;
            writes = run == repeat_;
            @(negedge clk);
            rst = 1'b0;
            waited = 0;
            while (done !== 1'b1 && (limit == 0 || waited < limit)) begin
                @(negedge clk);
                waited = waited + 1;
            end
            if (done !== 1'b1) begin
                $display("cube3_pipeline: the frame has not ended in %0d cycles", waited);
                if (writes) $fdisplay(file, "unfinished %0d", waited);
            end
        end
        $fdisplay(file, "cycles %0d", cycles);
        for (i = 0; i < 8; i = i + 1) begin
            $fdisplay(file, "account %0d %0d %0d", accounts[96*i+:32], accounts[96*i+32+:32], accounts[96*i+64+:32]);
        end
        for (i = 0; i < 6; i = i + 1) $fdisplay(file, "occupancy %0d", occupancies[32*i+:32]);
        $fdisplay(file, "overflows %0d %0d", shading_overflows, pixel_overflows);
        $fclose(file);
        $finish;
    end
endmodule
