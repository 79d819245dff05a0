"""The steps of an engine without a multiplier, from the program to the sum."""

from myhdl import always_comb, always_seq, block, concat

from golden.engine.formats import WIDTH
from golden.engine.program import KIND, SOURCE, WORD_WIDTH
from golden.engine.replay import CLEAR
from golden.engine.serial_program import (
    BEFORE,
    ENDS,
    LEAVES,
    NOTHING,
    OF_OUTPUT,
    RELU_BEFORE,
)
from golden.networks.engine import Engine
from hdl.common.delay import delay
from hdl.common.signals import flag, unsigned
from hdl.engine.plane_select import plane_select
from hdl.engine.replay_memory import replay_memory
from hdl.engine.serial_accumulate import serial_accumulate


@block
def serial_steps(
    clk,
    rst,
    run,
    finish,
    segment,
    read,
    source,
    store,
    leaves,
    ends,
    acc,
    relu=None,
    *,
    design: Engine,
):
    """Reads the program in bit planes, and adds up.

    Parameters
    ----------
    run, finish : bool
        A frame is computed; its last output leaves.
    segment : unsigned
        That of ``read``.
    read : signed 18 bits
        One clock after ``source``.
    source : unsigned ``design.addr_width`` bits
    store, leaves, ends : bool
        The sum is a result, an output, the last one.
    acc : signed ``design.acc_width`` bits
    relu : bool
        Where ``design.rectifies``: the sum becomes 0 where it is below.
    design : Engine

    Notes
    -----
    A neuron's first word says what becomes of the sum before, and clears it in the clock in which
    it is there.
    """
    memory = design.replay_memory
    word, plane, plane_late = unsigned(WORD_WIDTH), unsigned(CLEAR + 1), unsigned(CLEAR + 1)
    plane_later, weight, weight_later = unsigned(CLEAR + 1), unsigned(WIDTH), unsigned(WIDTH)
    table_word = unsigned(WIDTH)
    kind, kind_late, kind_later = unsigned(KIND[1]), unsigned(KIND[1]), unsigned(KIND[1])
    first, first_later, of_output, of_output_later = flag(), flag(), flag(), flag()
    take_weight, look_up, subtract = flag(), flag(), flag()
    before, waits, late, later = (unsigned(BEFORE[1]) for _ in range(4))
    coefficient = unsigned(memory.segment_addr_width)
    source_low, kind_low, before_low = SOURCE[0], KIND[0], BEFORE[0]
    source_top, kind_top = source_low + design.addr_width, sum(KIND)
    before_top = sum(BEFORE)
    of_output_bit = OF_OUTPUT[0]

    @always_comb
    def split():
        weight.next = word[WIDTH:]
        source.next = word[source_top:source_low]
        kind.next = word[kind_top:kind_low]
        of_output.next = word[of_output_bit]
        before.next = word[before_top:before_low]

    @always_comb
    def ask():
        coefficient.next = concat(segment, kind_later[0])

    @always_seq(clk.posedge, reset=rst)
    def follow():
        if run and not finish and plane[CLEAR]:
            waits.next = before
        else:
            waits.next = NOTHING
        late.next = waits
        later.next = late

    @always_seq(clk.posedge, reset=rst)
    def mark():
        store.next = run and later != NOTHING
        leaves.next = run and later >= LEAVES
        ends.next = run and later == ENDS

    if design.rectifies:
        relu_before, relu_bit = flag(), RELU_BEFORE[0]

        @always_comb
        def split_relu():
            relu_before.next = word[relu_bit]

        # As late as what else is said of the sum before; only looked at with a result.
        rectify = split_relu, delay(clk, None, relu_before, relu, clocks=4)
    else:
        rectify = ()

    return (
        split,
        rectify,
        ask,
        follow,
        mark,
        delay(clk, None, plane, plane_late, clocks=1),
        delay(clk, None, plane_late, plane_later, clocks=1),
        delay(clk, None, kind, kind_late, clocks=1),
        delay(clk, None, kind_late, kind_later, clocks=1),
        delay(clk, None, weight, weight_later, clocks=2),
        delay(clk, None, first, first_later, clocks=2),
        delay(clk, None, of_output, of_output_later, clocks=2),
        replay_memory(
            clk, rst, run, finish, coefficient, look_up, word, plane, first, table_word, spec=memory
        ),
        plane_select(
            clk,
            read,
            plane_late,
            kind_late,
            take_weight,
            look_up,
            subtract,
            spec=design.plane_select,
        ),
        serial_accumulate(
            clk,
            weight_later,
            take_weight,
            subtract,
            plane_later,
            first_later,
            of_output_later,
            table_word,
            acc,
            spec=design.serial_accumulate,
        ),
    )
