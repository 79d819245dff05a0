// For simulation: the two cells of Series 7 that series7_adder.v is made of.
module LUT6_2 #(parameter [63:0] INIT = 0) (
    input I0, I1, I2, I3, I4, I5, output O5, O6
);
    assign O6 = INIT[{I5, I4, I3, I2, I1, I0}];
    assign O5 = INIT[{1'b0, I4, I3, I2, I1, I0}];
endmodule

module CARRY4 (input CI, CYINIT, input [3:0] DI, S, output [3:0] O, CO);
    wire [4:0] carries = {CO, CI | CYINIT};
    assign O = S ^ carries[3:0];
    assign CO = S & carries[3:0] | ~S & DI;
endmodule
