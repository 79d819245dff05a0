// Gives SERV samples as it takes them, and prints the clock of each sample and of each result.
module play;
    parameter SAMPLES = 1, RESULTS = 1;
    reg clk = 0, rst = 1;
    reg signed [13:0] samples [0:SAMPLES-1];
    wire signed [13:0] result;
    wire taken, given;
    integer clocks = 0, at = 0, left = RESULTS;
    peer dut (.clk(clk), .rst(rst), .sample(samples[at % SAMPLES]), .taken(taken),
              .result(result), .given(given));
    initial $readmemh("samples.hex", samples);
    always #5 clk = !clk;
    always @(negedge clk) begin
        rst = clocks < 4;
        clocks = clocks + 1;
    end
    always @(posedge clk) begin
        if (taken) begin
            $display("taken %0d", clocks);
            at <= at + 1;
        end
        if (given) begin
            $display("given %0d %0d", clocks, result);
            left = left - 1;
            if (!left) $finish;
        end
    end
endmodule
