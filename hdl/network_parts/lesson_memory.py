"""The program memory of an engine that learns: three places to begin, a jump, and one counter."""

from myhdl import Signal, always, always_seq, block, modbv

from golden.engine.formats import WORD_WIDTH
from golden.networks.learning_engine import LearningEngine
from hdl.common.rom import Constants, rom
from hdl.common.signals import unsigned


@block
def lesson_memory(
    clk,
    rst,
    *,
    arrives,
    taken,
    goes,
    jump,
    equation,
    segment,
    look_up,
    word,
    table_word,
    design: LearningEngine,
):
    """Words of 36 bits, read twice a clock: by a counter, and by the segment of a hidden sum.

    arrives, taken, goes, jump: In the next clock the counter stands at the first word of a frame,
        of what keeps a placement, of what all equations begin with, or of the rest of one; of
        these, the first that is high counts. Otherwise it steps.
    equation, unsigned: The number of that equation.
    segment: unsigned.
    look_up: Where it is low, ``table_word`` is 0.
    word, table_word, unsigned 36 bits: They come one clock after their addresses.
    """
    program = design.program
    notes = (*program.notes, "not used")
    memory = Constants(design.contents, WORD_WIDTH, notes)
    frame, keep, alike, *equations = program.starts
    width = design.program_addr_width
    counter = Signal(modbv(frame, min=0, max=1 << width))
    place = unsigned(width)

    @always_seq(clk.posedge, reset=rst)
    def step():
        if arrives:
            counter.next = frame
        elif taken:
            counter.next = keep
        elif goes:
            counter.next = alike
        elif jump:
            counter.next = place
        else:
            counter.next = counter + 1

    @always(clk.posedge)
    def fetch():
        word.next = memory[counter]

    @always(clk.posedge)
    def read_table():
        if look_up:
            table_word.next = memory[segment]
        else:
            table_word.next = 0

    return step, fetch, read_table, rom(equation, place, words=equations)
