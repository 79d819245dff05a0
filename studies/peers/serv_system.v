// SERV with one memory for program and data. Addresses with the highest bit set are the port of
// samples and results.
module peer (
    input clk, input rst,
    input signed [13:0] sample, output taken,
    output signed [13:0] result, output given
);
    parameter WORDS = 4096;
    reg [31:0] memory [0:WORDS-1];
    initial $readmemh("program.mem", memory);

    wire [31:0] ibus_adr, dbus_adr, dbus_dat;
    wire ibus_cyc, dbus_cyc, dbus_we;
    wire [3:0] dbus_sel;
    reg ack;
    reg [31:0] word;
    wire [31:0] adr = ibus_cyc ? ibus_adr : dbus_adr;
    wire port = dbus_adr[31];
    wire data_ack = ack & !ibus_cyc;

    // The program writes whole words only.
    always @(posedge clk) begin
        ack <= !rst & !ack & (ibus_cyc | dbus_cyc);
        word <= memory[adr[2 +: $clog2(WORDS)]];
        if (!ibus_cyc & dbus_cyc & dbus_we & !port & dbus_sel == 4'b1111)
            memory[adr[2 +: $clog2(WORDS)]] <= dbus_dat;
    end
    assign taken = data_ack & port & !dbus_we;
    assign given = data_ack & port & dbus_we;
    assign result = dbus_dat[13:0];

    serv_rf_top #(.WITH_CSR(0)) core (
        .clk(clk), .i_rst(rst), .i_timer_irq(1'b0),
        .o_ibus_adr(ibus_adr), .o_ibus_cyc(ibus_cyc),
        .i_ibus_rdt(word), .i_ibus_ack(ack & ibus_cyc),
        .o_dbus_adr(dbus_adr), .o_dbus_dat(dbus_dat), .o_dbus_sel(dbus_sel),
        .o_dbus_we(dbus_we), .o_dbus_cyc(dbus_cyc),
        .i_dbus_rdt(port ? {{18{sample[13]}}, sample} : word), .i_dbus_ack(data_ack),
        .i_ext_rd(32'b0), .i_ext_ready(1'b0)
    );
endmodule
