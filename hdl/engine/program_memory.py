"""program_memory: holds the words of program and table, and steps through the program."""

from myhdl import Signal, always, always_comb, always_seq, block, modbv

from golden.engine.program import WORD_WIDTH
from golden.engine.program_memory import ProgramMemory
from hdl.common.delay import connect, delay
from hdl.common.rom import Constants
from hdl.common.signals import flag, unsigned


@block
def program_memory(
    clk,
    rst,
    *,
    start,
    run,
    finish,
    segment=None,
    look_up=None,
    word,
    table_word=None,
    spec: ProgramMemory,
):
    """Words of 36 bits, read twice a clock: by a counter, and by the segment of a hidden sum.

    The table stands before the program, so its address needs no addition. One memory with two read
    ports: a block RAM of 512 words. Reset puts the counter to the program's first word.
    """
    begin = spec.begin
    memory = Constants(spec.contents, WORD_WIDTH, spec.meanings)
    counter = Signal(modbv(begin, min=0, max=1 << spec.addr_width))
    stands, look_up_late = flag(), flag()
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

    @always(clk.posedge)
    def fetch():
        fetched.next = memory[counter]

    if not spec.table and spec.registers:
        return decide, step, fetch, delay(clk, None, fetched, word, clocks=1)

    if not spec.table:
        return decide, step, fetch, connect(fetched, word)

    if not spec.registers:

        @always(clk.posedge)
        def read_table():
            if look_up:
                table_word.next = memory[segment]
            else:
                table_word.next = 0

        return decide, step, fetch, read_table, connect(fetched, word)

    # A block RAM is faster where its word goes straight into a register, and is cleared only behind
    # that.
    @always(clk.posedge)
    def read_table():
        found.next = memory[segment]

    @always(clk.posedge)
    def clear():
        if look_up_late:
            table_word.next = found_late
        else:
            table_word.next = 0

    return (
        decide,
        step,
        fetch,
        read_table,
        clear,
        delay(clk, None, fetched, word, clocks=1),
        delay(clk, None, found, found_late, clocks=1),
        delay(clk, None, look_up, look_up_late, clocks=2),
    )
