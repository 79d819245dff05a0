// By this map of Yosys a sum of three operands costs a LUT for each bit, as in vendors' tools.
//
// Yosys makes carry-save adders of such a sum, which cost about two LUTs for each bit. Vendors'
// tools make one adder of it where LUTs have six inputs. The map does the same with the cells of
// Series 7.
//
// $macc_v2 is Yosys' sum of any number of products and operands. The LUT adds three bits, and its
// second output is what they carry, which the LUT and the chain of the next bit take. The bits of an
// operand that is subtracted are inverted in the LUTs, and 1 is added for it where the chain begins.
// Yosys reads the map for other sums too, before it leaves them as they are, and refuses a width
// that is not defined.

(* techmap_celltype = "$macc_v2" *)
module three_operands (A, B, C, Y);
  parameter NPRODUCTS = 0;
  parameter NADDENDS = 3;
  parameter PRODUCT_NEGATED = 0;
  parameter ADDEND_NEGATED = 0;
  parameter A_SIGNED = 0;
  parameter B_SIGNED = 0;
  parameter C_SIGNED = 0;
  parameter A_WIDTHS = 0;
  parameter B_WIDTHS = 0;
  parameter C_WIDTHS = 48'h000100010001;
  parameter Y_WIDTH = 1;

  wire _TECHMAP_FAIL_ = NPRODUCTS != 0 || NADDENDS != 3 || &ADDEND_NEGATED;

  localparam W0 = C_WIDTHS[15:0];
  localparam W1 = NADDENDS == 3 ? C_WIDTHS[31:16] : 1;
  localparam W2 = NADDENDS == 3 ? C_WIDTHS[47:32] : 1;
  localparam MINUS = 0 + ADDEND_NEGATED[0] + ADDEND_NEGATED[1] + ADDEND_NEGATED[2];
  localparam [63:0] IN0 = 64'hAAAAAAAAAAAAAAAA ^ {64{ADDEND_NEGATED[0]}};
  localparam [63:0] IN1 = 64'hCCCCCCCCCCCCCCCC ^ {64{ADDEND_NEGATED[1]}};
  localparam [63:0] IN2 = 64'hF0F0F0F0F0F0F0F0 ^ {64{ADDEND_NEGATED[2]}};
  localparam [63:0] ADDED = IN0 ^ IN1 ^ IN2 ^ 64'hFF00FF00FF00FF00;
  localparam [63:0] CARRIED = IN0 & IN1 | IN0 & IN2 | IN1 & IN2;
  localparam CHAINS = (Y_WIDTH + 3) / 4;

  (* force_downto *) input A, B;
  (* force_downto *) input [W0 + W1 + W2 - 1:0] C;
  (* force_downto *) output [Y_WIDTH-1:0] Y;

  (* force_downto *) wire [Y_WIDTH-1:0] c0, c1, c2;
  \$pos #(.A_SIGNED(C_SIGNED[0]), .A_WIDTH(W0), .Y_WIDTH(Y_WIDTH)) to0 (.A(C[0 +: W0]), .Y(c0));
  \$pos #(.A_SIGNED(C_SIGNED[1]), .A_WIDTH(W1), .Y_WIDTH(Y_WIDTH)) to1 (.A(C[W0 +: W1]), .Y(c1));
  \$pos #(.A_SIGNED(C_SIGNED[2]), .A_WIDTH(W2), .Y_WIDTH(Y_WIDTH))
    to2 (.A(C[W0 + W1 +: W2]), .Y(c2));

  (* force_downto *) wire [4*CHAINS-1:0] sum, carry, total, chain;
  genvar i;
  generate
    for (i = 0; i < 4 * CHAINS; i = i + 1) begin : bit
      if (i >= Y_WIDTH) begin
        assign sum[i] = 1'b0;
        assign carry[i] = 1'b0;
      end else begin
        wire into;
        if (i == 0) assign into = MINUS == 2;
        else assign into = carry[i-1];
        LUT6_2 #(.INIT({ADDED[63:32], CARRIED[31:0]})) lut (
          .I0(c0[i]), .I1(c1[i]), .I2(c2[i]), .I3(into), .I4(1'b0), .I5(1'b1),
          .O5(carry[i]), .O6(sum[i])
        );
      end
    end
    for (i = 0; i < CHAINS; i = i + 1) begin : slice
      wire [3:0] into;
      if (i == 0) begin
        assign into = {carry[2:0], MINUS == 2 ? 1'b1 : 1'b0};
        CARRY4 carry4 (
          .CYINIT(MINUS != 0 ? 1'b1 : 1'b0), .CI(1'b0),
          .DI(into), .S(sum[3:0]), .O(total[3:0]), .CO(chain[3:0])
        );
      end else begin
        assign into = carry[4*i-1 +: 4];
        CARRY4 carry4 (
          .CYINIT(1'b0), .CI(chain[4*i-1]), .DI(into),
          .S(sum[4*i +: 4]), .O(total[4*i +: 4]), .CO(chain[4*i +: 4])
        );
      end
    end
  endgenerate
  assign Y = total[Y_WIDTH-1:0];
endmodule
