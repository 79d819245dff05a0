"""program_ram: as program_memory, but the words of program and table can be written."""

from myhdl import Signal, always, always_comb, always_seq, block, modbv

from golden.engine.program import WORD_WIDTH
from golden.engine.program_ram import ProgramRam
from hdl.common.delay import connect, delay
from hdl.common.signals import flag, unsigned


@block
def program_ram(
    clk,
    rst,
    *,
    start,
    run,
    finish,
    segment=None,
    look_up=None,
    write,
    write_addr,
    data,
    word,
    table_word=None,
    spec: ProgramRam,
):
    """Words of 36 bits, read by a counter and by the segment of a hidden sum, and written.

    The table stands before the program, and what is written takes the counter's port, so two ports
    do: a block RAM of 512 words. Nothing is read in the clock of a write, because what a block RAM
    then gives differs between devices. Reset puts the counter to the program's first word.
    """
    begin = spec.begin
    memory = [unsigned(WORD_WIDTH) for _ in range(1 << spec.addr_width)]
    counter = Signal(modbv(begin, min=0, max=1 << spec.addr_width))
    addr = unsigned(spec.addr_width)
    stands, asked, asked_late = (flag() for _ in range(3))
    fetched, found, found_late = (unsigned(WORD_WIDTH) for _ in range(3))

    @always_comb
    def decide():
        stands.next = finish or not (start or run)

    @always_seq(clk.posedge, reset=rst)
    def step():
        if stands:
            counter.next = begin
        else:
            counter.next = counter + 1

    @always_comb
    def choose():
        if write:
            addr.next = write_addr
        else:
            addr.next = counter

    @always(clk.posedge)
    def fetch():
        if write:
            memory[addr].next = data
        else:
            fetched.next = memory[addr]

    counted = decide, step, choose, fetch
    if not spec.segment_addr_width:
        if spec.registers:
            return counted, delay(clk, None, fetched, word, clocks=spec.registers)
        return counted, connect(fetched, word)

    @always_comb
    def ask():
        asked.next = look_up and not write

    common = counted, ask
    if not spec.registers:

        @always(clk.posedge)
        def read_table():
            if asked:
                table_word.next = memory[segment]
            else:
                table_word.next = 0

        return common, read_table, connect(fetched, word)

    # A block RAM is faster where its word goes straight into a register, and is cleared only behind
    # that.
    @always(clk.posedge)
    def read_table():
        if not write:
            found.next = memory[segment]

    @always(clk.posedge)
    def clear():
        if asked_late:
            table_word.next = found_late
        else:
            table_word.next = 0

    return (
        common,
        read_table,
        clear,
        delay(clk, None, fetched, word, clocks=1),
        delay(clk, None, found, found_late, clocks=1),
        delay(clk, None, asked, asked_late, clocks=2),
    )
