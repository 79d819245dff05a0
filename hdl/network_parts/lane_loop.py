"""Runs the program of an engine with several multipliers as a loop, in which frames overlap."""

from myhdl import Signal, always, always_comb, always_seq, block, concat, modbv

from golden.engine.operand_memory import WORD
from golden.networks.engine import Engine
from golden.numbers.precision import SIGNAL
from hdl.common.delay import connect, delay
from hdl.common.signals import Stream, fixed, flag, unsigned
from hdl.engine.frame_check import frame_check
from hdl.engine.operand_memory import operand_memory
from hdl.engine.program_memory import program_memory


@block
def lane_loop(
    clk,
    rst,
    in_: Stream,
    *,
    word,
    source,
    store,
    run,
    shows,
    sums,
    sample,
    write,
    write_addr,
    source_addr,
    frame_error,
    design: Engine,
):
    """Keeps the samples of frames, and begins each frame with the next loop of the program.

    word, unsigned 36 bits: The word of the program.
    source, unsigned ``design.program.layout["source"]`` bits: The address of its operand, without
        the loop that stored it.
    store: One clock later: a result or a sample is stored.
    run: The loop runs.
    shows: There is a frame whose output the word marks, if it marks any.
    sums, sample, bool, signed Fix(14,13): As late as ``store``: whether a sum is stored, or else
        the sample.
    write, write_addr, bool, unsigned ``design.addr_width`` bits: One clock later than ``store``.
    source_addr, unsigned ``design.addr_width`` bits: The address of the word's operand.
    frame_error: See ``frame_check``.

    A loop begins where one is at its last word, or where none runs, if a frame is there, or as long
    as frames of earlier loops are computed. Addresses that are written count from 0 in each loop;
    above them the number of the loop counts.
    """
    program = design.program
    good, opens, wraps, last, turns, goes, waits, joins, more = (flag() for _ in range(9))
    # The loop goes on so many clocks before its words come out of the registers of the memory.
    early = program.pipeline.memory_registers
    runs, turns_late, enters, enters_late = (flag() for _ in range(4))
    frames, frames_late = unsigned(program.stages), unsigned(program.stages)
    top = program.stages - 1
    wrap_bit = program.field("wrap")[0]
    first, final = program.first_stage, program.last_stage
    late_bit = program.field("late")[0]

    # The loop says early that it ends, because a block RAM is too slow to drive a counter.
    @always_seq(clk.posedge, reset=rst)
    def follow():
        wraps.next = runs and word[wrap_bit]
        last.next = wraps

    @always_comb
    def decide():
        opens.next = good and not runs
        turns.next = last or (good and not runs)
        joins.next = good or waits

    @always_comb
    def go_on():
        more.next = good or waits or frames[top:] != 0

    @always_comb
    def step():
        goes.next = runs and (more or not last)
        enters.next = turns and joins

    @always_seq(clk.posedge, reset=rst)
    def turn():
        if opens:
            runs.next = True
        elif last:
            runs.next = more

    @always_seq(clk.posedge, reset=rst)
    def wait():
        if turns:
            waits.next = False
        elif good:
            waits.next = True

    # Bit k: a frame began k loops ago.
    @always_seq(clk.posedge, reset=rst)
    def pass_on():
        if turns:
            frames.next = concat(frames[top:], joins)

    if first == final:

        @always_comb
        def live():
            shows.next = frames_late[final]

    else:

        @always_comb
        def live():
            if word[late_bit]:
                shows.next = frames_late[final]
            else:
                shows.next = frames_late[first]

    return (
        follow,
        decide,
        go_on,
        step,
        turn,
        wait,
        pass_on,
        live,
        later(clk, rst, runs, run, clocks=early),
        later(clk, rst, turns, turns_late, clocks=early),
        later(clk, rst, enters, enters_late, clocks=early),
        later(clk, rst, frames, frames_late, clocks=early),
        program_memory(
            clk,
            rst,
            start=opens,
            run=goes,
            finish=wraps,
            word=word,
            spec=design.program_memory,
        ),
        addresses(
            clk,
            rst,
            turns=turns_late,
            word=word,
            source=source,
            store=store,
            write=write,
            write_addr=write_addr,
            source_addr=source_addr,
            program=program,
        ),
        samples(
            clk,
            rst,
            in_,
            word=word,
            run=run,
            good=good,
            turns=turns_late,
            enters=enters_late,
            sums=sums,
            sample=sample,
            frame_error=frame_error,
            design=design,
        ),
    )


@block
def later(clk, rst, data, data_late, *, clocks: int):
    """``data_late`` is ``data`` of so many clocks ago, or of the same clock."""
    return delay(clk, rst, data, data_late, clocks=clocks) if clocks else connect(data, data_late)


@block
def addresses(clk, rst, *, turns, word, source, store, write, write_addr, source_addr, program):
    """The addresses of the operands: with several loops in the memory, the loop is above them."""
    turn_low, turn_width = program.field("turn")
    turn_top, width = turn_low + turn_width, program.field("source")[1]
    span = 1 << width
    addr = Signal(modbv(span - 1, min=0, max=span))
    begins = flag()
    late = delay(clk, rst, turns, begins, clocks=2)

    @always_seq(clk.posedge, reset=rst)
    def count():
        if begins:
            if store:
                addr.next = 0
            else:
                addr.next = span - 1
        elif store:
            addr.next = addr + 1

    @always_seq(clk.posedge, reset=rst)
    def mark():
        write.next = store

    if not turn_width:
        return late, count, mark, connect(addr, write_addr), connect(source, source_addr)

    turns_span = 1 << turn_width
    turn, turn_late = (Signal(modbv(0, min=0, max=turns_span)) for _ in range(2))
    reads = Signal(modbv(0, min=0, max=turns_span))

    @always_seq(clk.posedge, reset=rst)
    def count_turns():
        if turns:
            turn.next = turn + 1

    @always_comb
    def look_back():
        reads.next = turn - word[turn_top:turn_low]

    @always_comb
    def place():
        write_addr.next = concat(turn_late, addr)
        source_addr.next = concat(reads, source)

    return (
        late,
        count,
        mark,
        count_turns,
        look_back,
        place,
        delay(clk, rst, turn, turn_late, clocks=2),
    )


@block
def samples(
    clk,
    rst,
    in_: Stream,
    *,
    word,
    run,
    good,
    turns,
    enters,
    sums,
    sample,
    frame_error,
    design: Engine,
):
    """Accepts frames, keeps two of them, and gives the samples of the one that begins in turn.

    A frame may begin ``design.busy`` clocks after the last sample of the good frame before.
    """
    program, busy = design.program, design.busy
    memory, check = design.sample_memory, design.frame_check
    copy_bit, width = program.field("copy")[0], SIGNAL.width
    taking, taken, frees, good_late = (flag() for _ in range(4))
    taken_addr, put_addr, get_addr = (
        unsigned(check.addr_width),
        unsigned(memory.addr_width),
        unsigned(memory.addr_width),
    )
    given, found = fixed(WORD), fixed(WORD)
    place = unsigned(check.addr_width)
    # Which of both frames comes in, and which one is read, from the loop on in which it begins.
    half_in, half_out = flag(), Signal(bool(1))
    remaining = unsigned(busy.bit_length())

    @always_seq(clk.posedge, reset=rst)
    def pause():
        if good:
            remaining.next = busy
        elif remaining != 0:
            remaining.next = remaining - 1

    @always_comb
    def free():
        frees.next = remaining == 1

    @always(clk.posedge)
    def catch():
        given.next = in_.data

    @always_seq(clk.posedge, reset=rst)
    def swap():
        if good_late:
            half_in.next = not half_in
        if enters:
            half_out.next = not half_out

    @always_comb
    def address():
        put_addr.next = concat(half_in, taken_addr)
        get_addr.next = concat(half_out, place)

    @always_seq(clk.posedge, reset=rst)
    def count():
        if turns or not run:
            place.next = 0
        elif word[copy_bit]:
            place.next = place + 1

    @always(clk.posedge)
    def choose():
        sums.next = not word[copy_bit]

    @always_comb
    def give():
        sample.next = found[width:].signed()

    return (
        pause,
        free,
        catch,
        swap,
        address,
        count,
        choose,
        give,
        delay(clk, rst, good, good_late, clocks=1),
        frame_check(
            clk,
            rst,
            in_,
            finish=frees,
            start=good,
            run=taking,
            write=taken,
            write_addr=taken_addr,
            frame_error=frame_error,
            spec=check,
        ),
        operand_memory(
            clk,
            write=taken,
            write_addr=put_addr,
            data=given,
            read_addr=get_addr,
            word=found,
            spec=memory,
        ),
    )
