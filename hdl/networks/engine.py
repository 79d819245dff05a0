"""Engine: multipliers side by side, and a program that computes a whole scene."""

from myhdl import Signal, always, always_comb, always_seq, block, concat, modbv

from golden.engine.formats import OUTPUT_SHIFT, WIDTH, WORD, WORD_WIDTH
from golden.engine.image import Sizes
from golden.engine.lane_groups import partners
from golden.networks.engine import Engine
from hdl.common import ops
from hdl.common.delay import connect, delay
from hdl.common.rom import Constants
from hdl.common.signals import Stream, Words, fixed, flag, signed, unsigned
from hdl.engine.frame_check import frame_check
from hdl.engine.frame_guard import frame_guard
from hdl.engine.image_loader import image_loader
from hdl.engine.lane_accumulate import lane_accumulate
from hdl.engine.lane_memory import lane_memory, row_of
from hdl.engine.lane_round import lane_round
from hdl.engine.operand_memory import operand_memory
from hdl.engine.program_memory import program_memory
from hdl.engine.program_ram import program_ram


@block
def lane_alone(clk, rst, *, start, run, finish, word, place, kind, read, coeff, design: Engine):
    """Two words of 18 bits a clock: that of a counter, and what the lane multiplies by.

    start, run, finish: The counter steps; it returns to the first word of the program.
    word: That of the counter, which steps through the program.
    place: Where it has bits, the block in which a function is looked up.
    kind, read: What is made of the word that was read. It says whether the table is looked up.
    coeff: The weight beside a word of the program, or the intercept or slope of a segment.

    One memory with two read ports: a block RAM of 1024 words. No address needs an addition. Reset
    puts the counter to the program's first word.
    """
    program = design.program
    begin, bits, top = program.begin, program.row_bits, program.counter_width
    memory = Constants(program.contents, WIDTH, program.meanings)
    counter = Signal(modbv(begin, min=0, max=1 << top))
    stands = flag()
    counted, step_addr, addr = unsigned(bits), unsigned(bits + 1), unsigned(bits + 1)
    fetched = unsigned(WIDTH)

    @always_comb
    def decide():
        stands.next = finish or not (start or run)

    @always_seq(clk.posedge, reset=rst)
    def step():
        if stands:
            counter.next = begin
        else:
            counter.next = counter + 1

    widen = ops.widen(counter, counted)
    join = ops.join(counted, False, step_addr)

    @always(clk.posedge)
    def fetch():
        fetched.next = memory[step_addr]

    @always(clk.posedge)
    def find():
        coeff.next = memory[addr]

    registers = program.pipeline.memory_registers
    late = delay(clk, None, fetched, word, clocks=1) if registers else connect(fetched, word)
    common = decide, step, widen, join, fetch, find, late
    if not design.looks_up:
        weigh = ops.join(counted, True, addr)

        kind.read = read.read = True  # The lane's accumulator alone reads these.
        return common, weigh

    looks, row, wide = flag(), unsigned(program.row_width), unsigned(bits)

    @always_comb
    def look():
        looks.next = kind == 1 or kind == 2

    if begin:
        put_below = ops.widen(row, wide)

        put = put_below
    else:
        put_above = ops.join(True, row, wide)

        put = put_above

    @always_comb
    def choose():
        if looks:
            addr.next = concat(wide, kind[1])
        else:
            addr.next = concat(counted, True)

    return (
        common,
        look,
        put,
        choose,
        row_of(read, place, row, low=program.segment_width, bits=program.segment_bits),
    )


@block
def lane_image(*, write, write_addr, word, row, put, lane_put, lane_addr, lane_word, sizes: Sizes):
    """A word of an image is written to the program, to all lanes or to two of them.

    write, write_addr, word, bool, unsigned, unsigned 36 bits: A word of the image, as the loader
        gives it.
    row, unsigned ``sizes.program_addr_width`` bits: The address in the program memory.
    put: The word is one of the program.
    lane_put, lane_word: Whether each lane takes a word, and which.
    lane_addr, unsigned: The address in the memory of a lane, whose lower half holds the tables.

    The tables come first, for every lane. Behind them the low bits of the address say where a word
    goes, 0 to the program and from 1 on to two lanes each, and the bits above are the address
    there. The tables have a power of two of words, so these bits need only 1 less in the high ones.
    """
    table, low = sizes.table_words.bit_length() - 1, sizes.columns.bit_length() - 1
    top, bits = len(write_addr), len(row)
    part, joined = unsigned(low), unsigned(top - low)
    behind = Signal(modbv(0, min=0, max=1 << (top - table)))
    looked = flag()

    @always_comb
    def split():
        part.next = write_addr[low:]
        looked.next = write_addr[top:table] == 0
        behind.next = write_addr[top:table] - 1

    @always_comb
    def join():
        joined.next = concat(behind, write_addr[table:low])

    @always_comb
    def place():
        row.next = joined[bits:]
        put.next = write and part == 0 and not looked

    @always_comb
    def choose():
        if looked:
            lane_addr.next = write_addr[bits:]
        else:
            lane_addr.next = concat(True, row)

    shares = [
        lane_share(
            write=write,
            looked=looked,
            part=part,
            word=word,
            put=lane_put[j],
            share=lane_word[j],
            pair=1 + j // 2,
            low=j % 2 * WIDTH,
        )
        for j in range(sizes.lanes)
    ]
    return split, join, place, choose, shares


@block
def lane_share(*, write, looked, part, word, put, share, pair: int, low: int):
    """What one lane takes: tables, and its half of the words with the weights of two lanes."""
    top = low + WIDTH
    assert top <= WORD_WIDTH, "the weights of two lanes share a word"

    @always_comb
    def take():
        put.next = write and (looked or part == pair)
        share.next = word[top:low]

    return take


@block
def engine(clk, rst, in_: Stream, out: Stream, *, frame_error, load=None, image=None, spec: Engine):
    """A frame of sensor samples in, a frame of outputs out, on one multiplier or several.

    The fields of a step stand in several words of the program, each where the clock of its use
    finds it; docs/instruction-set.md shows which. Clocks from the last sample to the outputs:
    ``spec.clocks_text``. Reset clears every flag and counter, and forgets a loaded image.
    """
    count = spec.lanes
    memories, accumulators, rounds = spec.lane_memories, spec.accumulators, spec.rounds
    fields = spec.program.layout
    place_width = fields["place"][1] if spec.alone else memories[0].place_width
    word = unsigned(WIDTH if spec.alone else WORD_WIDTH)
    start, run, finish, write = (flag() for _ in range(4))
    write_addr, source = unsigned(spec.addr_width), unsigned(spec.addr_width)
    kind, opens = unsigned(2), unsigned(2)
    place = unsigned(place_width) if place_width else None
    store, leaves, ends, together, own = (flag() for _ in range(5))
    # What the other lanes store with the first one, if there are others.
    next_word, next_low = fixed(WORD), flag()
    next_cut = flag() if rounds[0].cut else None
    next_even = flag() if rounds[0].even else None
    relu = flag() if spec.rectifies else None
    read, data = (Words(count, lambda: fixed(WORD)) for _ in range(2))
    coeff = Words(count, lambda: unsigned(WIDTH))
    # What is multiplied: with registers behind the memories, it is a clock later than what is read.
    factor, times, sort, late = read, coeff, kind, ()
    if spec.program.pipeline.memory_registers:
        factor, times = (
            Words(count, make) for make in (lambda: fixed(WORD), lambda: unsigned(WIDTH))
        )
        sort = unsigned(2)
        late = (
            delay(clk, None, kind, sort, clocks=1),
            [delay(clk, None, read[j], factor[j], clocks=1) for j in range(count)],
            [delay(clk, None, coeff[j], times[j], clocks=1) for j in range(count)],
        )
    acc = Words(count, lambda: signed(spec.acc_width))
    high, low = (Words(count, flag) for _ in range(2))
    first_data = data[0]
    # What an image writes into the memory of each lane, if one is loaded.
    lane_put, lane_word, lane_addr = (None,) * count, (None,) * count, None
    if spec.loaded:
        sizes, loader = spec.loaded.sizes, spec.image_loader
        halt, busy, put, put_program = (flag() for _ in range(4))
        put_addr, put_word = unsigned(loader.program_addr_width), unsigned(WORD_WIDTH)
        before_last, row = unsigned(spec.addr_width), unsigned(sizes.program_addr_width)
        lane_put, lane_addr = Words(count, flag), unsigned(memories[0].addr_width)
        lane_word = Words(count, lambda: unsigned(WIDTH))
    source_low, kind_low, opens_low = fields["source"][0], fields["kind"][0], fields["opens"][0]
    source_top, kind_top, opens_top = source_low + spec.addr_width, kind_low + 2, opens_low + 2
    store_bit, together_bit, output_bit, end_bit, relu_bit = (
        fields[name][0] for name in ("store", "together", "output", "end", "relu")
    )
    assert not fields["place"][0], "a place begins at the lowest bit"

    @always_seq(clk.posedge, reset=rst)
    def leave():
        out.valid.next = leaves
        finish.next = ends

    @always_comb
    def show():
        out.data.next = first_data[WIDTH:OUTPUT_SHIFT].signed()
        out.last.next = finish

    @always_comb
    def split():
        source.next = word[source_top:source_low]
        kind.next = word[kind_top:kind_low]
        opens.next = word[opens_top:opens_low]

    places = ops.bits(word, place_width, 0, place) if place_width else ()

    # These registers stand between a block RAM and counters. Words that were on their way when a
    # reset or the last output stopped the program do nothing.
    @always_seq(clk.posedge, reset=rst)
    def mark():
        store.next = run and word[store_bit]
        leaves.next = run and word[output_bit]
        ends.next = run and word[end_bit]

    # Only looked at with a result that is stored.
    if count > 1:

        @always(clk.posedge)
        def follow():
            together.next = word[together_bit]

        @always_comb
        def belong():
            own.next = run and not together

        shared = follow, belong
    else:
        shared = ()

    if spec.rectifies:

        @always(clk.posedge)
        def rectify():
            relu.next = word[relu_bit]

        rectified = rectify
    else:
        rectified = ()

    if spec.loaded:
        control = (
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
                spec=loader,
            ),
            lane_image(
                write=put,
                write_addr=put_addr,
                word=put_word,
                row=row,
                put=put_program,
                lane_put=lane_put,
                lane_addr=lane_addr,
                lane_word=lane_word,
                sizes=sizes,
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
            program_ram(
                clk,
                rst,
                start=start,
                run=run,
                finish=finish,
                write=put_program,
                write_addr=row,
                data=put_word,
                word=word,
                spec=spec.program_ram,
            ),
        )
    else:
        if spec.alone:
            steps = lane_alone(
                clk,
                rst,
                start=start,
                run=run,
                finish=finish,
                word=word,
                place=place,
                kind=kind,
                read=read[0],
                coeff=coeff[0],
                design=spec,
            )
        else:
            steps = program_memory(
                clk, rst, start=start, run=run, finish=finish, word=word, spec=spec.program_memory
            )
        control = (
            steps,
            frame_check(
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
            ),
        )

    return (
        leave,
        show,
        split,
        places,
        mark,
        shared,
        rectified,
        late,
        control,
        [
            operand_memory(
                clk,
                write=write,
                write_addr=write_addr,
                data=data[j],
                read_addr=source,
                word=read[j],
                spec=spec.operand_memory,
            )
            for j in range(count)
        ],
        [
            lane_memory(
                clk,
                place=place,
                coeff=coeff[j],
                word=read[j] if spec.looks_up else None,
                kind=kind if spec.looks_up else None,
                write=lane_put[j],
                write_addr=lane_addr,
                data=lane_word[j],
                spec=memories[j],
            )
            for j in range(len(memories))
        ],
        [
            accumulate(
                clk,
                word,
                acc,
                j,
                low_bit=fields["gather"][0],
                design=accumulators[j],
                read=factor[j],
                kind=sort,
                coeff=times[j],
                opens=opens,
                high=high[j],
                low=low[j],
            )
            for j in range(count)
        ],
        lane_round(
            clk,
            own=run,
            acc=acc[0],
            high=high[0],
            low=low[0],
            relu=relu,
            sample=in_.data,
            word=data[0],
            next_word=next_word,
            next_low=next_low,
            next_cut=next_cut,
            next_even=next_even,
            spec=rounds[0],
        ),
        [
            lane_round(
                clk,
                own=own,
                acc=acc[j],
                high=high[j],
                low=low[j],
                relu=relu,
                other=next_word,
                other_low=next_low,
                other_cut=next_cut,
                other_even=next_even,
                word=data[j],
                spec=rounds[j],
            )
            for j in range(1, count)
        ],
    )


@block
def accumulate(clk, word, acc, lane, *, read, kind, coeff, opens, high, low, low_bit, design):
    """The sum of a lane, with the sums of the lanes that it adds."""
    added = partners(lane, len(acc))
    joined: dict[str, object] = {}
    fetched = ()
    if added:
        gather = unsigned(len(added))
        others = (acc[other] for other in added.values())
        joined = {"gather": gather, "other": Words(len(added), lambda: next(others))}
        low_end = low_bit + min(added)
        fetched = ops.bits(word, low_end + len(added), low_end, gather)
    return fetched, lane_accumulate(
        clk,
        word=read,
        kind=kind,
        coeff=coeff,
        opens=opens,
        acc=acc[lane],
        high=high,
        low=low,
        spec=design,
        **joined,
    )
