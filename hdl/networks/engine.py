"""Engine: one multiplier, or none, and a program that computes a whole scene."""

from myhdl import always, always_comb, always_seq, block

from golden.engine.formats import OUTPUT_SHIFT, WIDTH
from golden.engine.operand_memory import WORD
from golden.engine.program import (
    END,
    FIRST,
    FIRST_OF_OUTPUT,
    KIND,
    OUTPUT,
    RELU,
    SOURCE,
    STORE,
    TAKE_INTERCEPT,
    WORD_WIDTH,
)
from golden.networks.engine import Engine
from hdl.common.delay import delay
from hdl.common.signals import Stream, fixed, flag, signed, unsigned
from hdl.engine.frame_check import frame_check
from hdl.engine.frame_guard import frame_guard
from hdl.engine.image_loader import image_loader
from hdl.engine.multiply_accumulate import multiply_accumulate
from hdl.engine.operand_memory import operand_memory
from hdl.engine.operand_select import operand_select
from hdl.engine.program_memory import program_memory
from hdl.engine.program_ram import program_ram
from hdl.engine.round_saturate import round_saturate
from hdl.engine.table_address import table_address
from hdl.network_parts.serial_steps import serial_steps


@block
def engine(clk, rst, in_: Stream, out: Stream, *, frame_error, load=None, image=None, spec: Engine):
    """A frame of sensor samples in, a frame of outputs out, on one multiplier or on none.

    With a multiplier the fields of a step stand in several words of the program, each where the
    clock of its use finds it; docs/instruction-set.md shows which. Clocks from the last sample to
    the outputs: ``spec.clocks_text``. Reset clears all flags and counters, and a loaded image.
    """
    table = spec.table_address
    word, table_word = unsigned(WORD_WIDTH), unsigned(WORD_WIDTH)
    start, run, finish, write, look_up = (flag() for _ in range(5))
    write_addr, source = unsigned(spec.addr_width), unsigned(spec.addr_width)
    data, read, operand = (fixed(WORD) for _ in range(3))
    segment = unsigned(table.addr_width)
    weight, kind = unsigned(WIDTH), unsigned(KIND[1])
    take_intercept, first, first_of_output, store, leaves, ends = (flag() for _ in range(6))
    acc = signed(spec.acc_width)
    if spec.loaded:
        halt, busy, put = flag(), flag(), flag()
        put_addr, put_word = unsigned(spec.image_loader.program_addr_width), unsigned(WORD_WIDTH)
        before_last = unsigned(spec.addr_width)
    source_low, kind_low = SOURCE[0], KIND[0]
    source_top, kind_top = source_low + spec.addr_width, sum(KIND)
    take_bit, first_bit, first_of_output_bit = TAKE_INTERCEPT[0], FIRST[0], FIRST_OF_OUTPUT[0]
    store_bit, output_bit, end_bit = STORE[0], OUTPUT[0], END[0]
    relu = flag() if spec.rectifies else None
    base = unsigned(table.base_width) if spec.names_blocks else None
    weight_late = unsigned(WIDTH) if spec.names_blocks and not spec.serial else None

    @always_seq(clk.posedge, reset=rst)
    def leave():
        out.valid.next = leaves
        finish.next = ends

    @always_comb
    def show():
        out.data.next = data[WIDTH:OUTPUT_SHIFT].signed()
        out.last.next = finish

    if spec.loaded:
        frames = (
            image_loader(
                clk,
                rst,
                load,
                busy=busy,
                halt=halt,
                write=put,
                write_addr=put_addr,
                word=put_word,
                before_last=before_last,
                image_error=image.error,
                spec=spec.image_loader,
            ),
            frame_guard(
                clk,
                rst,
                in_,
                halt=halt,
                before_last=before_last,
                store=store,
                finish=finish,
                start=start,
                run=run,
                busy=busy,
                write=write,
                write_addr=write_addr,
                frame_error=frame_error,
                spec=spec.frame_guard,
            ),
        )
    else:
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
    if spec.serial:
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

    if spec.names_blocks:
        kept, base_top = unsigned(WIDTH), table.base_width

        # A block is named sooner than a weight is multiplied, so weights are stored with the names.
        @always_comb
        def name():
            base.next = word[base_top:]

        @always(clk.posedge)
        def withhold():
            if kind == 1 or kind == 2:
                kept.next = 0
            else:
                kept.next = weight

        clocks = spec.program.pipeline.table
        blocks = name, withhold, delay(clk, None, kept, weight_late, clocks=clocks)
    else:
        blocks = ()

    if spec.rectifies:
        intercept, relu_bit = flag(), RELU[0]

        @always_comb
        def split():
            weight.next = word[WIDTH:]
            source.next = word[source_top:source_low]
            kind.next = word[kind_top:kind_low]
            first.next = word[first_bit]
            first_of_output.next = word[first_of_output_bit]

        # A bit of the word is that of ReLU; the kind comes with the operand, which is earlier.
        @always_comb
        def recognise():
            intercept.next = kind == 1

        # Only looked at with a result that is stored.
        @always(clk.posedge)
        def rectify():
            relu.next = word[relu_bit]

        late = spec.program.pipeline.weight - spec.program.pipeline.operand
        split_all = (
            split,
            recognise,
            rectify,
            delay(clk, None, intercept, take_intercept, clocks=late),
        )
    else:

        @always_comb
        def split():
            weight.next = word[WIDTH:]
            source.next = word[source_top:source_low]
            kind.next = word[kind_top:kind_low]
            take_intercept.next = word[take_bit]
            first.next = word[first_bit]
            first_of_output.next = word[first_of_output_bit]

        split_all = split

    # This is as late as the segment is.
    @always(clk.posedge)
    def ask():
        look_up.next = kind == 1 or kind == 2

    # These registers stand between a block RAM and counters. Words that were on their way when a
    # reset or the last output stopped the program do nothing.
    @always_seq(clk.posedge, reset=rst)
    def mark():
        store.next = run and word[store_bit]
        leaves.next = run and word[output_bit]
        ends.next = run and word[end_bit]

    if spec.loaded:
        program = program_ram(
            clk,
            rst,
            start=start,
            run=run,
            finish=finish,
            segment=segment,
            look_up=look_up,
            write=put,
            write_addr=put_addr,
            data=put_word,
            word=word,
            table_word=table_word,
            spec=spec.program_ram,
        )
    else:
        program = program_memory(
            clk,
            rst,
            start=start,
            run=run,
            finish=finish,
            segment=segment,
            look_up=look_up,
            word=word,
            table_word=table_word,
            spec=spec.program_memory,
        )

    return (
        common,
        split_all,
        blocks,
        ask,
        mark,
        program,
        operand_select(clk, read, kind, operand, spec=spec.operand_select),
        multiply_accumulate(
            clk,
            operand=operand,
            weight=weight if weight_late is None else weight_late,
            take_intercept=take_intercept,
            table_word=table_word,
            first=first,
            first_of_output=first_of_output,
            acc=acc,
            spec=spec.multiply_accumulate,
        ),
    )
