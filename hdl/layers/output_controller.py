"""CONTROLLER 2: steps through the outputs of a frame."""

from myhdl import always_comb, always_seq, block

from golden.layers.output_controller import OutputController
from hdl.common.signals import Stream, unsigned


@block
def output_controller(clk, rst, out: Stream, *, in_valid, addr, spec: OutputController):
    """Row address, one output a clock (thesis section 5.4.5.3, CONTROLLER 2).

    Latency 0 clocks. CONTROLLER 1 keeps frames ``spec.outputs`` clocks apart or more, so
    ``in_valid`` never comes while rows are still being stepped through. Reset clears the row
    counter.
    """
    outputs = spec.outputs
    count = unsigned(spec.addr_width)

    @always_comb
    def show():
        addr.next = count
        out.valid.next = in_valid or count != 0
        out.last.next = (in_valid or count != 0) and count == outputs - 1

    if outputs == 1:

        @always_seq(clk.posedge, reset=rst)
        def step():
            count.next = 0

        return show, step

    @always_seq(clk.posedge, reset=rst)
    def step():
        if in_valid or count != 0:
            if count == outputs - 1:
                count.next = 0
            else:
                count.next = count + 1

    return show, step
