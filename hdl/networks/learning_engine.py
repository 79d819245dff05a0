"""LearningEngine: an engine that learns the gains and offsets of its sensors."""

from myhdl import Signal, always, always_comb, always_seq, block, concat, instances, modbv

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE_SHIFT, WIDTH, WORD, WORD_WIDTH
from golden.learning.corrected import SHORT
from golden.learning.places import FIELDS, Places
from golden.networks.learning_engine import LearningEngine
from golden.numbers.precision import SIGNAL
from hdl.common import ops
from hdl.common.delay import delay
from hdl.common.rom import Constants, rom
from hdl.common.signals import Stream, fixed, flag, signed, unsigned
from hdl.engine.frame_check import frame_check
from hdl.engine.frame_guard import frame_guard
from hdl.engine.multiply_accumulate import multiply_accumulate
from hdl.engine.operand_memory import operand_memory
from hdl.engine.operand_select import operand_select
from hdl.engine.round_saturate import round_saturate
from hdl.engine.table_address import table_address


@block
def lesson_address(address, bank, number, mapped, *, places: Places):
    """The bank of theta, or the number of a placement, in the place that the program leaves.

    address: unsigned ``places.addr_width`` bits.
    number: unsigned ``places.number_width`` bits.
    mapped: unsigned ``places.addr_width`` bits.
    """
    width, low, bank_bit = places.addr_width, places.placement_width, places.bank_bit
    top, of_theta, behind = width - 1, width - 2, places.bank_bit + 1
    kept, rest = flag(), unsigned(low)

    @always_comb
    def cut():
        kept.next = address[top]
        rest.next = address[low:]

    @always_comb
    def choose():
        if kept:
            mapped.next = concat(kept, number, rest)
        elif address[of_theta]:
            mapped.next = concat(address[width:behind], bank, address[bank_bit:])
        else:
            mapped.next = address

    return cut, choose


@block
def lesson_control(
    clk,
    rst,
    *,
    stops,
    waits,
    ready,
    learn,
    opening,
    studying,
    goes,
    finish,
    keep_run,
    putting,
    bad,
    bank,
    stepped,
    shown,
    written,
    equation,
    learn_error,
    design: LearningEngine,
):
    """Begins equations in the clocks that are free, and says to which placement they belong.

    stops: A sample or a known output comes in: an equation that runs is stopped, and begins anew
        later.
    waits: No equation begins.
    ready: Neither a frame nor a placement is computed or kept.
    learn: Equations may begin.
    opening, studying: An equation runs: the clock before its first step, and all others.
    goes: The clock before ``opening``.
    finish: The last result of the part that runs is stored.
    keep_run: That part keeps a placement.
    putting: Not so if this is high: theta has come in, and is the one that is read from then on.
    bad: A word of the new theta was saturated, so the step is not taken.
    bank: Where the theta is that is read.
    stepped: A step has been taken since reset.
    shown, written, unsigned: The placement of the equation, and the one that is written next.
    equation, unsigned: Which output the equation is of.
    learn_error: High for one clock after a step that is not taken.
    """
    final = design.outputs - 1
    passed, kept, put, none, full = (flag() for _ in range(5))
    most = (1 << design.program.places.number_width) - 1

    @always_comb
    def judge():
        passed.next = finish and studying
        kept.next = finish and keep_run and not putting
        put.next = finish and keep_run and putting
        none.next = shown == written

    @always_comb
    def decide():
        goes.next = learn and ready and not (none or opening or studying or waits)

    @always_seq(clk.posedge, reset=rst)
    def open_equation():
        opening.next = goes
        if stops or passed:
            studying.next = False
        elif opening:
            studying.next = True

    @always_seq(clk.posedge, reset=rst)
    def exchange():
        learn_error.next = passed and bad
        if put or (passed and not bad):
            bank.next = not bank
            stepped.next = True

    # A placement that is being written is not shown.
    @always_seq(clk.posedge, reset=rst)
    def follow():
        if kept:
            shown.next = written
            written.next = written + 1
            equation.next = 0
            full.next = full or written == most
        elif passed and equation == final:
            shown.next = shown + 1
            equation.next = 0
        elif passed:
            equation.next = equation + 1
        elif none and full:
            shown.next = shown + 1
        elif none:
            shown.next = 0

    return judge, decide, open_equation, exchange, follow


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


@block
def learning_engine(
    clk,
    rst,
    in_: Stream,
    out: Stream,
    *,
    frame_error,
    target: Stream,
    learn,
    learn_error,
    theta: Stream,
    spec: LearningEngine,
):
    """A frame of sensor samples in, a frame of outputs out; and known outputs in, to learn from.

    Clocks from the last sample to the outputs: ``spec.clocks_text``. An equation takes up to
    ``spec.longest_equation`` clocks in one piece; a sample that comes stops it, and it begins anew
    later. ``spec.placements`` placements are kept; the next one takes the place of the oldest.
    Reset clears every flag and counter, forgets the placements, and brings back the gains and
    offsets of before.
    """
    places = spec.program.places
    addr_width, half_width = places.addr_width, places.addr_width - 1
    word, table_word = unsigned(WORD_WIDTH), unsigned(WORD_WIDTH)
    segment = unsigned(spec.table_address.addr_width)
    acc, data, read, second, operand = signed(spec.acc_width), *(fixed(WORD) for _ in range(4))
    # Who runs.
    frame_start, frame_run, keep_start, keep_run, keep_busy = (flag() for _ in range(5))
    opening, studying, active, finish, frame_finish, keep_over = (flag() for _ in range(6))
    busy, arrives, ready, taken, stops, halt, fresh, lost = (flag() for _ in range(8))
    broken_targets, nothing, goes, bad = (flag() for _ in range(4))
    telling, theta_leaves, partly, putting, waits = (flag() for _ in range(5))
    at_low, at_high, continues, clipped = (flag() for _ in range(4))
    # Marks of steps.
    store, leaves, places_next, ends, wrote, jump = (flag() for _ in range(6))
    # Where words are.
    bank, write_bank, stepped, result_top = (flag() for _ in range(4))
    shown, written = (Signal(modbv(0, min=0, max=1 << places.number_width)) for _ in range(2))
    result_low = Signal(modbv(0, min=0, max=1 << half_width))
    equation = unsigned(max(1, (spec.outputs - 1).bit_length()))
    source, read_addr, second_addr, second_source = (unsigned(addr_width) for _ in range(4))
    result_source, result_addr, write_addr = (unsigned(addr_width) for _ in range(3))
    sample_place, target_place = unsigned(addr_width), unsigned(addr_width)
    theta_place, asked, unread_place, part_addr = (unsigned(addr_width) for _ in range(4))
    unread = Signal(modbv(0, min=0, max=1 << places.target_width))
    put_word, kept_word = fixed(WORD), fixed(WORD)
    sample_write, target_write, write = (flag() for _ in range(3))
    sample_addr = unsigned(places.sample_width)
    target_width = spec.frame_guard.addr_width
    target_addr, before_last = unsigned(target_width), unsigned(target_width)
    incoming = fixed(SIGNAL)
    weight, kept, kept_late = (unsigned(WIDTH) for _ in range(3))
    kind = unsigned(2)
    look_up, intercept, take_intercept, first, first_of_output = (flag() for _ in range(5))
    product, product_late = flag(), flag()
    spoiled, over, beyond, of_theta = (flag() for _ in range(4))
    lowest_bits = {name: low for name, (_, (low, _)) in FIELDS.items()}
    source_low, kind_low = lowest_bits["source"], lowest_bits["kind"]
    source_top, kind_top = source_low + addr_width, kind_low + 2
    first_bit, first_of_output_bit, store_bit, output_bit, end_bit, product_bit = (
        lowest_bits[name]
        for name in ("first", "first_of_output", "store", "output", "end", "product")
    )
    top_bit, theta_bit, sign_bit = addr_width - 1, addr_width - 2, WIDTH - 1
    samples, targets, theta_low = places.samples, places.targets, places.theta
    final, less = places.unknowns - 1, WIDTH - 1
    assert OUTPUT_SHIFT - SAMPLE_SHIFT == 1, "theta is scaled by one bit"
    less_two = (spec.outputs - 2) % (1 << target_width)
    theta_less_two = (places.unknowns - 2) % (1 << target_width)
    target_bits = places.target_width
    lowest_sample, highest_sample = SIGNAL.low << SAMPLE_SHIFT, SIGNAL.high << SAMPLE_SHIFT

    see = ops.either(frame_start, frame_run, busy)

    @always_comb
    def meet():
        arrives.next = in_.valid and not busy
        ready.next = not (busy or keep_busy)

    take = ops.both(target.valid, ready, taken)
    # A sample or a known output stops everything but a frame, which lets neither of them in.
    stop = ops.either(arrives, taken, stops)

    @always_comb
    def work():
        active.next = (frame_run or keep_run or studying) and not stops

    @always_comb
    def guard():
        halt.next = (arrives or not fresh) and not keep_busy
        keep_over.next = keep_busy and (arrives or finish)
        frame_finish.next = finish and frame_run

    @always_seq(clk.posedge, reset=rst)
    def remember():
        lost.next = arrives and keep_busy and not finish
        if arrives:
            fresh.next = False
        elif frame_finish:
            fresh.next = not clipped

    # A sample stands in data while it is written.
    @always_comb
    def meet_ends():
        at_low.next = data == lowest_sample
        at_high.next = data == highest_sample
        continues.next = sample_addr != 0

    @always_seq(clk.posedge, reset=rst)
    def remember_ends():
        if sample_write:
            clipped.next = at_low or at_high or (clipped and continues)

    @always(clk.posedge)
    def hold():
        nothing.next = False

    @always_comb
    def report():
        target.ready.next = ready
        target.error.next = broken_targets or lost
        out.data.next = data[WIDTH:OUTPUT_SHIFT].signed()
        theta.valid.next = theta_leaves
        theta.data.next = second[WIDTH:OUTPUT_SHIFT].signed()
        out.last.next = frame_finish

    @always_comb
    def split():
        source.next = word[source_top:source_low]
        kind.next = word[kind_top:kind_low]
        first.next = word[first_bit]
        first_of_output.next = word[first_of_output_bit]

    recognise = ops.equal(kind, 1, intercept)

    # The address of a second word stands where a weight does, and is used a clock sooner.
    @always(clk.posedge)
    def keep():
        kept.next = word[WIDTH:]
        kept_late.next = kept
        product.next = word[product_bit]
        product_late.next = product
        look_up.next = kind == 1 or kind == 2

    @always_comb
    def name():
        if telling:
            second_source.next = asked
        else:
            second_source.next = kept[addr_width:]

    @always_comb
    def weigh():
        if product_late:
            weight.next = concat(
                second[sign_bit], second[sign_bit], second[sign_bit], second[WIDTH:SHORT]
            )
        else:
            weight.next = kept_late

    # Words that were on their way when a part was stopped do nothing.
    @always_seq(clk.posedge, reset=rst)
    def mark():
        store.next = active and word[store_bit]
        leaves.next = frame_run and word[store_bit] and word[output_bit]
        places_next.next = active and word[output_bit] and not word[store_bit]
        ends.next = active and word[end_bit] and word[store_bit]
        jump.next = active and word[end_bit] and not word[store_bit]
        wrote.next = active and store
        finish.next = active and ends
        out.valid.next = leaves

    @always(clk.posedge)
    def place():
        if places_next:
            result_low.next = kept[half_width:]
            result_top.next = kept[top_bit]
        elif wrote:
            result_low.next = result_low + 1

    join = ops.join(result_top, result_low, result_source)

    # Until a step has been taken, a frame clears the theta in use. An equation, and any later
    # frame, writes the other one.
    @always_comb
    def choose_bank():
        write_bank.next = bank == (frame_run and not stepped)

    @always_comb
    def widen():
        sample_place.next = sample_addr
        target_place.next = target_addr[target_bits:]

    @always_comb
    def direct():
        write.next = sample_write or target_write or wrote
        if sample_write:
            write_addr.next = samples | sample_place
        elif target_write and not putting:
            write_addr.next = targets | target_place
        else:
            write_addr.next = result_addr

    @always_comb
    def bring():
        if arrives:
            incoming.next = in_.data
        else:
            incoming.next = target.data

    lowest, end = DROPPED + WIDTH - 1, spec.acc_width
    above = unsigned(end - lowest)
    ones = (1 << (end - lowest)) - 1

    look = ops.bits(acc, end, lowest, above)

    @always_comb
    def compare():
        beyond.next = above != 0 and above != ones

    @always(clk.posedge)
    def follow():
        over.next = beyond

    @always_comb
    def judge():
        of_theta.next = wrote and over and not result_top and result_low[theta_bit]

    sentence = ops.either(spoiled, of_theta, bad)

    @always(clk.posedge)
    def spoil():
        if opening:
            spoiled.next = False
        elif of_theta:
            spoiled.next = True

    @always_comb
    def measure():
        if target.theta:
            before_last.next = theta_less_two
        else:
            before_last.next = less_two

    # Equations and incoming theta use the same bank, so no equation starts during a transfer.
    @always_seq(clk.posedge, reset=rst)
    def note():
        if taken:
            putting.next = target.theta
            partly.next = target.theta and not target.last
        elif arrives:
            partly.next = False

    # After a frame, theta is sent through the second read port.
    @always_seq(clk.posedge, reset=rst)
    def tell():
        theta_leaves.next = telling
        if frame_finish:
            telling.next = True
            unread.next = 0
        elif telling:
            unread.next = unread + 1
            telling.next = unread != final and not arrives

    @always_comb
    def delay_equations():
        waits.next = stops or telling or partly

    count = ops.widen(unread, unread_place)
    point = ops.add(theta_low, unread_place, asked)
    # A word of theta goes to the bank that is not in use, as a result does.
    place_theta = ops.add(theta_low, target_place, theta_place)

    @always_comb
    def locate():
        if target_write:
            part_addr.next = theta_place
        else:
            part_addr.next = result_source

    # A word has come in as a sample does, and theta is in the format of what leaves.
    @always_comb
    def scale():
        put_word.next = concat(data[less:], nothing).signed()

    @always_comb
    def choose_word():
        if target_write and putting:
            kept_word.next = put_word
        else:
            kept_word.next = data

    control = (
        frame_check(
            clk,
            rst,
            in_,
            finish=frame_finish,
            start=frame_start,
            run=frame_run,
            write=sample_write,
            write_addr=sample_addr,
            frame_error=frame_error,
            spec=spec.frame_check,
        ),
        frame_guard(
            clk,
            rst,
            Stream(valid=taken, last=target.last),
            halt=halt,
            before_last=before_last,
            store=nothing,
            finish=keep_over,
            start=keep_start,
            run=keep_run,
            busy=keep_busy,
            write=target_write,
            write_addr=target_addr,
            frame_error=broken_targets,
            spec=spec.frame_guard,
        ),
        lesson_control(
            clk,
            rst,
            stops=stops,
            waits=waits,
            ready=ready,
            learn=learn,
            opening=opening,
            studying=studying,
            goes=goes,
            finish=finish,
            keep_run=keep_run,
            putting=putting,
            bad=bad,
            bank=bank,
            stepped=stepped,
            shown=shown,
            written=written,
            equation=equation,
            learn_error=learn_error,
            design=spec,
        ),
        lesson_memory(
            clk,
            rst,
            arrives=arrives,
            taken=taken,
            goes=goes,
            jump=jump,
            equation=equation,
            segment=segment,
            look_up=look_up,
            word=word,
            table_word=table_word,
            design=spec,
        ),
    )
    written_words = {"write": write, "write_addr": write_addr, "data": kept_word}
    memory = spec.operand_memory
    # Two memories with the same words, because two are read in a clock.
    memories = (
        operand_memory(clk, **written_words, read_addr=read_addr, word=read, spec=memory),
        operand_memory(clk, **written_words, read_addr=second_addr, word=second, spec=memory),
    )
    find_word = lesson_address(source, bank, shown, read_addr, places=places)
    find_second = lesson_address(second_source, bank, shown, second_addr, places=places)
    find_result = lesson_address(part_addr, write_bank, written, result_addr, places=places)
    late_intercept = delay(clk, None, intercept, take_intercept, clocks=2)
    find_segment = table_address(clk, read, segment, spec=spec.table_address)
    select = operand_select(clk, read, kind, operand, spec=spec.operand_select)
    accumulate = multiply_accumulate(
        clk,
        operand=operand,
        weight=weight,
        take_intercept=take_intercept,
        table_word=table_word,
        first=first,
        first_of_output=first_of_output,
        acc=acc,
        spec=spec.multiply_accumulate,
    )
    finish_sum = round_saturate(clk, active, acc, incoming, data, spec=spec.round_saturate)

    return instances()
