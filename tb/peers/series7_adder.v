// alkaid's sum of three, as a vendor's tool builds it on Series 7: in one LUT for each bit and a
// carry chain. The LUT adds the three bits; its second output is what they carry, which the LUT of
// the next bit takes. It replaces alkaid's ternary_adder.v, whose parameters it has.
module ternary_adder #(
    parameter BW_INPUT0 = 32, SIGNED0 = 0, NEGATE0 = 0, PAD0 = 0,
    parameter BW_INPUT1 = 32, SIGNED1 = 0, NEGATE1 = 0, PAD1 = 0,
    parameter BW_INPUT2 = 32, SIGNED2 = 0, NEGATE2 = 0, PAD2 = 0,
    parameter BW_OUT = 32, DROP_LSBS = 0
) (
    input [BW_INPUT0-1:0] in0,
    input [BW_INPUT1-1:0] in1,
    input [BW_INPUT2-1:0] in2,
    output [BW_OUT-1:0] out
);
    function integer least(input integer a, input integer b);
        least = a < b ? a : b;
    endfunction
    function integer most(input integer a, input integer b);
        most = a > b ? a : b;
    endfunction

    localparam WIDTH = BW_OUT + DROP_LSBS;
    localparam NEGATED = NEGATE0 + NEGATE1 + NEGATE2;
    // Below START there is at most one operand, and it is not negated: its bits are those of the sum.
    localparam SECOND = most(most(least(PAD0, PAD1), least(PAD0, PAD2)), least(PAD1, PAD2));
    localparam START = least(
        least(SECOND, WIDTH - 1),
        least(NEGATE0 ? PAD0 : SECOND, least(NEGATE1 ? PAD1 : SECOND, NEGATE2 ? PAD2 : SECOND)));
    localparam CARRIES = (WIDTH - START + 3) / 4;

    // Of the three bits and the carry of the bit before: the sum in the upper half, and the carry.
    function [63:0] table_of(input integer unused);
        integer n;
        reg [2:0] bits;
        begin
            for (n = 0; n < 32; n = n + 1) begin
                bits = n[2:0] ^ {NEGATE2 != 0, NEGATE1 != 0, NEGATE0 != 0};
                table_of[n] = bits[0] & bits[1] | bits[0] & bits[2] | bits[1] & bits[2];
                table_of[n + 32] = ^bits ^ n[3];
            end
        end
    endfunction

    wire signed [BW_INPUT0:0] s0 = {SIGNED0 ? in0[BW_INPUT0-1] : 1'b0, in0};
    wire signed [BW_INPUT1:0] s1 = {SIGNED1 ? in1[BW_INPUT1-1] : 1'b0, in1};
    wire signed [BW_INPUT2:0] s2 = {SIGNED2 ? in2[BW_INPUT2-1] : 1'b0, in2};
    wire signed [WIDTH+BW_INPUT0-1:0] a = s0, a_placed = a <<< PAD0;
    wire signed [WIDTH+BW_INPUT1-1:0] b = s1, b_placed = b <<< PAD1;
    wire signed [WIDTH+BW_INPUT2-1:0] c = s2, c_placed = c <<< PAD2;
    wire [WIDTH-1:0] total;
    wire [4*CARRIES-1:0] sums, results;
    wire [4*CARRIES:0] carried;
    wire [CARRIES:0] chain;
    // Each negated operand needs a one at the first place.
    assign carried[0] = NEGATED > 0;
    assign chain[0] = NEGATED > 1;

    genvar i;
    generate
        if (NEGATED > 2) three_negated_operands not_built ();
        if (START > 0)
            assign total[START-1:0] =
                a_placed[START-1:0] | b_placed[START-1:0] | c_placed[START-1:0];
        for (i = 0; i < 4 * CARRIES; i = i + 1) begin : places
            if (START + i < WIDTH) begin : used
                LUT6_2 #(.INIT(table_of(0))) lut (
                    .I0(a_placed[START+i]), .I1(b_placed[START+i]), .I2(c_placed[START+i]),
                    .I3(carried[i]), .I4(1'b0), .I5(1'b1), .O5(carried[i+1]), .O6(sums[i]));
                assign total[START+i] = results[i];
            end else begin : unused
                assign carried[i+1] = 1'b0;
                assign sums[i] = 1'b0;
            end
        end
        for (i = 0; i < CARRIES; i = i + 1) begin : chains
            wire [3:0] out_of;
            CARRY4 carry (
                .CI(i ? chain[i] : 1'b0), .CYINIT(i ? 1'b0 : chain[0]),
                .DI(carried[4*i +: 4]), .S(sums[4*i +: 4]), .O(results[4*i +: 4]), .CO(out_of));
            assign chain[i+1] = out_of[3];
        end
    endgenerate
    assign out = total[WIDTH-1:DROP_LSBS];
endmodule
