// Diffuse and specular light on a sample by Phong's formula, in integers: ambient light and the lights, one behind another.
//
// Equals cube3_abc::golden::phong_from. Intensities are fractions of COLOUR_BITS below 16, of up to 8 lights; diffuse light
// multiplies the sample's colour, specular light is added. Table `power`: 2^POWER_BITS + 1 entries, one port for each light.
//
// Operators: those of cube3_light for each light.
module cube3_phong #(
    parameter integer NORMAL_BITS = 12,
    parameter integer COLOUR_BITS = 12,
    parameter integer LIGHTS = 1,
    parameter integer POWER_BITS = 10,
    parameter integer NEAREST = 1,
    parameter POWER_FILE = ""
) (
    input  wire [3*(NORMAL_BITS+1)-1:0]        normal,
    input  wire [COLOUR_BITS+3:0]              ambient,
    input  wire                                two_sided,
    input  wire [3*LIGHTS*(NORMAL_BITS+1)-1:0] light_direction,
    input  wire [3*LIGHTS*(NORMAL_BITS+1)-1:0] light_halfway,
    input  wire [3*LIGHTS*(COLOUR_BITS+4)-1:0] light_diffuse,
    input  wire [3*LIGHTS*(COLOUR_BITS+4)-1:0] light_specular,
    output wire [3*(COLOUR_BITS+8)-1:0]        diffuse,
    output wire [3*(COLOUR_BITS+8)-1:0]        specular
);
    localparam integer N = 3 * (NORMAL_BITS + 1);
    localparam integer I = 3 * (COLOUR_BITS + 4);
    localparam integer L = COLOUR_BITS + 8;

    // Written by $readmemh where a file is named.
    // verilator lint_off UNDRIVEN
    reg [COLOUR_BITS:0] powers [0:1<<POWER_BITS];
    // verilator lint_on UNDRIVEN

    generate
        if (POWER_FILE != "") begin : load
            initial $readmemh(POWER_FILE, powers);
        end
    endgenerate

    // Light before the first and behind each.
    wire [3*L*(LIGHTS+1)-1:0] diffuse_sums;
    wire [3*L*(LIGHTS+1)-1:0] specular_sums;
    assign diffuse_sums[0 +: 3*L] = {3{L'(ambient)}};
    assign specular_sums[0 +: 3*L] = (3*L)'(0);
    assign diffuse = diffuse_sums[3*L*LIGHTS +: 3*L];
    assign specular = specular_sums[3*L*LIGHTS +: 3*L];

    genvar l;
    generate
        for (l = 0; l < LIGHTS; l = l + 1) begin : lights
            wire [POWER_BITS:0] index;
            cube3_light #(
                .NORMAL_BITS(NORMAL_BITS), .COLOUR_BITS(COLOUR_BITS), .POWER_BITS(POWER_BITS), .NEAREST(NEAREST)
            ) light (
                .normal(normal),
                .two_sided(two_sided),
                .direction(light_direction[l*N +: N]),
                .halfway(light_halfway[l*N +: N]),
                .diffuse(light_diffuse[l*I +: I]),
                .specular(light_specular[l*I +: I]),
                .index(index),
                .power(powers[index]),
                .diffuse_before(diffuse_sums[3*L*l +: 3*L]),
                .specular_before(specular_sums[3*L*l +: 3*L]),
                .diffuse_after(diffuse_sums[3*L*(l+1) +: 3*L]),
                .specular_after(specular_sums[3*L*(l+1) +: 3*L])
            );
        end
    endgenerate
endmodule
