"""The part of an engine without a multiplier that reads the program and makes the sums."""

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
from golden.networks.serial_engine import SerialEngine
from hdl.common.delay import delay
from hdl.common.signals import flag, unsigned
from hdl.engine.plane_select import plane_select
from hdl.engine.replay_memory import replay_memory
from hdl.engine.serial_accumulate import serial_accumulate


@block
def serial_steps(
    clk,
    rst,
    *,
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
    base=None,
    design: SerialEngine,
):
    """Reads the program once for each bit plane of the operands, and adds up the coefficients.

    run, finish: A frame is being computed, and its last output leaves.
    segment, unsigned: The segment in which ``read`` lies.
    read, signed 18 bits: The operand, one clock after its address ``source``.
    source: unsigned ``design.addr_width`` bits.
    store, leaves, ends: The sum is a result; it is an output; it is the last output.
    acc: signed ``design.acc_width`` bits.
    relu: Where ``design.rectifies``: the sum becomes 0 where it is below.
    base, unsigned ``design.table_address.base_width`` bits: Where ``design.names_blocks``: the
        block of the table in which ``read`` is looked up.

    The first word of a neuron says what becomes of the sum of the neuron before, and clears that
    sum in the clock in which it is complete.
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

    if design.names_blocks:
        base_top = design.table_address.base_width
        named = unsigned(base_top)

        @always_comb
        def split_base():
            named.next = word[base_top:]

        # As late as the operand.
        blocks = split_base, delay(clk, None, named, base, clocks=1)
    else:
        blocks = ()

    return (
        split,
        rectify,
        blocks,
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
            clk,
            rst,
            run=run,
            finish=finish,
            segment=coefficient,
            look_up=look_up,
            word=word,
            plane=plane,
            first=first,
            table_word=table_word,
            spec=memory,
        ),
        plane_select(
            clk,
            word=read,
            plane=plane_late,
            kind=kind_late,
            take_weight=take_weight,
            look_up=look_up,
            subtract=subtract,
            spec=design.plane_select,
        ),
        serial_accumulate(
            clk,
            weight=weight_later,
            take_weight=take_weight,
            subtract=subtract,
            plane=plane_later,
            first=first_later,
            of_output=of_output_later,
            table_word=table_word,
            acc=acc,
            spec=design.serial_accumulate,
        ),
    )
