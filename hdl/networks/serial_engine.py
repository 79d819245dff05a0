"""SerialEngine: a program that computes a whole scene without a multiplier."""

from myhdl import always_comb, always_seq, block

from golden.engine.formats import OUTPUT_SHIFT, WIDTH
from golden.engine.operand_memory import WORD
from golden.networks.serial_engine import SerialEngine
from hdl.common.signals import Stream, fixed, flag, signed, unsigned
from hdl.engine.frame_check import frame_check
from hdl.engine.operand_memory import operand_memory
from hdl.engine.round_saturate import round_saturate
from hdl.engine.table_address import table_address
from hdl.network_parts.serial_steps import serial_steps


@block
def serial_engine(clk, rst, in_: Stream, out: Stream, *, frame_error, spec: SerialEngine):
    """A frame of sensor samples in, a frame of outputs out, without a multiplier.

    Clocks from the last sample to the outputs: ``spec.clocks_text``. Reset clears all flags and
    counters.
    """
    table = spec.table_address
    start, run, finish, write, store, leaves, ends = (flag() for _ in range(7))
    write_addr, source = unsigned(spec.addr_width), unsigned(spec.addr_width)
    data, read = fixed(WORD), fixed(WORD)
    segment, acc = unsigned(table.addr_width), signed(spec.acc_width)
    relu = flag() if spec.rectifies else None
    base = unsigned(table.base_width) if spec.names_blocks else None

    @always_seq(clk.posedge, reset=rst)
    def leave():
        out.valid.next = leaves
        finish.next = ends

    @always_comb
    def show():
        out.data.next = data[WIDTH:OUTPUT_SHIFT].signed()
        out.last.next = finish

    frames = frame_check(
        clk,
        rst,
        in_,
        store=store,
        finish=finish,
        start=start,
        run=run,
        write=write,
        write_addr=write_addr,
        frame_error=frame_error,
        spec=spec.frame_check,
    )
    common = (
        leave,
        show,
        frames,
        operand_memory(
            clk,
            write=write,
            write_addr=write_addr,
            data=data,
            read_addr=source,
            word=read,
            spec=spec.operand_memory,
        ),
        table_address(clk, read, segment, base=base, spec=table),
        round_saturate(clk, run, acc, in_.data, data, relu=relu, spec=spec.round_saturate),
    )
    return common, serial_steps(
        clk,
        rst,
        run=run,
        finish=finish,
        segment=segment,
        read=read,
        source=source,
        store=store,
        leaves=leaves,
        ends=ends,
        acc=acc,
        relu=relu,
        base=base,
        design=spec,
    )
