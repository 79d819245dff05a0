"""The properties of the parts of engine, for every word that comes.

z3 gives no answer within minutes about the words of ``program_ram``, and of a ``lane_memory`` that
is written. The proof for every frame judges these, and with ``ALL=1`` the bench of ``engine`` in
its case ``rails-lanes-reload``.
"""

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, SAMPLE_SHIFT, WIDTH, WORD, WORD_WIDTH
from golden.engine.graph import Kind
from tb.common.properties import Property
from tb.common.watch import past, pipe, table


def operand_memory(twin):
    """The properties of the part, which say all that it does."""
    late, width = twin.latency, twin.addr_width
    return [
        Property(
            name="what was written",
            sentence=f"The word that is read at each of {1 << width} addresses, {late} clock"
            f"{'s' * (late > 1)} later, is the one that was written there last, in a clock before "
            "that of the address.",
            states=(f"!there[{late - 1}] || !met_{late - 1} || word == kept_{late - 1}",),
            watch=f"""
                // Any one address, and the word that was written there last.
                (* anyconst *) reg [{width - 1}:0] place;
                reg known = 0;
                reg [17:0] kept;
                always @(posedge clk) if (write && write_addr == place) begin
                    known <= 1;
                    kept <= data;
                end
                wire met = known && read_addr == place;
            """
            + pipe("met", late, 1)
            + pipe("kept", late, 18, also=False),
            helps=(
                "!known || memory[place] == kept",
                *(("!there[0] || !met_0 || found == kept_0",) if late > 1 else ()),
            ),
            reached=(f"there[{late - 1}] && met_{late - 1}",),
            refuted_by=(
                (r"if \(write\)", "if (1)"),
                (r"memory\[read_addr\]", "memory[read_addr ^ 1]"),
                (r"memory\[write_addr\] <= data", "memory[write_addr >> 1] <= data"),
                (
                    r"found <= memory",
                    "if (write && write_addr == read_addr) found <= data; else found <= memory",
                ),
            ),
            clocks=late + 2,
            induction=late,
            arrays=True,
            whole=True,
        )
    ]


def program_memory(twin):
    """The properties of the part, which say all that it does."""
    width, words, late = twin.addr_width, len(twin.contents), twin.latency
    sentence = f"Each of the {words} addresses gives the twin's word. The counter's word comes "
    sentence += f"{late} clock{'s' * (late > 1)} later."
    return [
        counted(twin, words),
        Property(
            name="words",
            sentence=sentence,
            states=(f"!there[{late - 1}] || word == contents(here_{late - 1})",),
            watch=f"wire [{width}:0] here = counter;"
            + pipe("here", late, width + 1, also=False)
            + past(late)
            + table("contents", twin.contents, WORD_WIDTH),
            free=("counter",),
            reached=(f"there[{late - 1}] && here_{late - 1} == {words - 1}",),
            refuted_by=((r"(memory\[0\] <= \S+);", r"\1 ^ 1;"),),
            clocks=late + 2,
            induction=late + 1,
            whole=True,
        ),
    ]


def program_ram(twin):
    return [counted(twin, 1 << twin.addr_width)]


def counted(twin, words):
    """The properties of the counter that steps through a program."""
    return Property(
        name="counter",
        sentence="The counter stands at 0, the program's first word, after a reset, "
        "after finish, and after a clock with neither start nor run. Otherwise it steps to the "
        "next word.",
        states=("counter == expected",),
        watch=f"""
            reg [31:0] expected;
            always @(posedge clk) expected <= rst || finish || !(start || run) ? 0
                : (expected + 1) % {words};
        """,
        helps=(f"expected < {words}",),
        reached=("expected == 3",),
        refuted_by=(
            (r"stands = \(finish \|\| \(!\(start \|\| run\)\)\)", "stands = (!(start || run))"),
            (r"stands = \(finish \|\| \(!\(start \|\| run\)\)\)", "stands = (finish || (!run))"),
            (r"rst == 1", "0"),
            (r"counter \+ 1", "counter + 2"),
        ),
        clocks=6,
    )


def lane_memory(twin):
    """Its properties: all that it does, and of a memory that is written the address alone."""
    width, segments, half = twin.addr_width, twin.segments, 1 << twin.half_width
    here, looked, piece = "place", "", ""
    if twin.table:
        piece = f"""
            wire signed [31:0] whole = $signed(word);
            wire [31:0] piece = (whole < 0 ? -32'sd1 - whole : whole) / {1 << twin.segment_width};
        """
        where = f"piece % {segments}"
        looked = (
            " With kind 1 and 2 it is the intercept and the slope of the word's segment, counted "
            "from 0 up and from -1 down."
        )
        if twin.blocks > 1:
            piece += f"""
                wire [31:0] named = (place % {2 * twin.blocks}) / 2;
                wire [31:0] block = named % 2 == 0 && place % 2 == 1 && whole < 0
                    ? named + 1 : named;
            """
            where = f"block * {segments} + {where}"
            looked += (
                " Half the place names the block, and an odd place the next one for a word below 0."
            )
        slopes = segments * twin.blocks
        here = f"kind == 1 ? {where} : kind == 2 ? {slopes} + {where} : {half} + place"
        faults = (
            (r"if \(word\[17\]\)", "if (word[16])"),
            (r"looked = \{kind\[1\]", "looked = {kind[0]"),
            (r"looks = .*;", "looks = (kind == 1);"),
        )
        if twin.blocks > 1:
            faults += ((r"chosen = .*;", "chosen = place[1];"),)
    else:
        faults = ((r"address = place", "address = 0"),)
    if twin.written:
        return [written(f"{piece} wire [{width}:0] here = {here};", looked, faults)]
    return [
        Property(
            name="coefficient",
            sentence="One clock later the coefficient is the weight at the place, as in the twin."
            + looked,
            states=("!there[0] || coeff == contents(here_0)",),
            watch=f"{piece} wire [{width}:0] here = {here};"
            + pipe("here", 1, width + 1)
            + table("contents", twin.contents, WIDTH),
            reached=("there[0] && here_0 == 1",),
            refuted_by=((r"(memory\[1\] <= \S+);", r"\1 ^ 1;"), *faults),
            clocks=3,
            induction=2,
            whole=True,
        )
    ]


def written(here, looked, faults):
    """The address of a memory that is written; what is read there is left to the bench."""
    return Property(
        name="address",
        sentence="The word that is read is the one at the place." + looked,
        states=("address == here",),
        watch=here,
        reached=("here == 1",),
        refuted_by=faults,
        clocks=3,
        induction=2,
    )


def lane_accumulate(twin):
    """The properties of the part, which say all that it does."""
    return [products(twin), sums(twin)]


def products(twin):
    one, span = 1 << DROPPED, 1 << twin.segment_width
    operand = f"kind % 2 ? {one} : whole"
    kinds, faults = "the word, or the number one where the kind is odd", ()
    if twin.segment_width:
        operand = (
            f"kind == {Kind.WORD:d} ? whole : kind == {Kind.DISTANCE:d} ? inside - {span // 2} : "
            f"kind == {Kind.INTERCEPT:d} && whole < 0 ? -{one} : {one}"
        )
        kinds = (
            "what its kind says: the word, the number one with the word's sign, the word's "
            f"distance from the middle of a segment of {span} codes, or the number one"
        )
        faults = ((r"below = \(!word\[(\d+)\]\)", r"below = word[\1]"),)
    return Property(
        name="products",
        sentence=f"Each product is that of the operand three clocks before and of the coefficient "
        f"two clocks before. The operand is {kinds}.",
        states=(
            "!there[1] || ($signed(factor_late) == taken_1 && $signed(coeff_late) == code_0)",
            "!there[2] || $signed(product) == expected",
        ),
        watch=f"""
            wire signed [31:0] whole = $signed(word);
            wire signed [31:0] inside = whole & {span - 1};
            wire signed [31:0] taken = {operand};
            wire signed [{WIDTH - 1}:0] code = $signed(coeff);
        """
        + pipe("taken", 2, 32)
        + pipe("code", 1, WIDTH, also=False)
        + f"""
            reg signed [{2 * WIDTH - 1}:0] expected;
            always @(posedge clk) expected <= $signed(factor_late) * $signed(coeff_late);
        """,
        reached=("there[1] && taken_1 == -1 && code_0 == 3",),
        refuted_by=(
            (r"coeff_late <= .*;", "coeff_late <= 0;"),
            (r"product <= \(", "product <= 2 * ("),
            *faults,
        ),
        clocks=4,
    )


def sums(twin):
    half = 1 << (DROPPED - 1)
    output = half << OUTPUT_SHIFT
    own, joined, of_output = (half, half, output) if twin.leads else (half, 0, 0)
    named = "$signed(product)"
    for n in range(twin.partners):
        named = f"gather_0[{n}] ? $signed(other_{n}) : {named}"
    other = ", or of another sum in its place, the last that gather names" if twin.partners else ""
    low, high = WORD.low << DROPPED, ((WORD.high + 1) << DROPPED) - 1
    faults = [
        (r"above != 0\)", "above != 1)"),
        (rf"above != {(1 << (twin.acc_width - DROPPED - WIDTH + 1)) - 1}", "above != 0"),
        (r"base <= start", "base <= 0"),
    ]
    if twin.partners:
        faults.append((r"takes <= \(gather != 0\)", "takes <= 0"))
    return Property(
        name="sums",
        sentence=f"Each sum is that of the product before{other}, and of the sum before, or of the "
        f"number with which it starts: {own} where the lane's own sum starts, {joined} where that "
        f"of all lanes starts, {of_output} if it is that of an output. high and low say whether it "
        "is above or below every word.",
        states=(
            "!there[2] || acc == expected",
            f"!there[2] || high == (whole > 64'sd{high})",
            f"!there[2] || low == (whole < -64'sd{-low})",
        ),
        watch="wire [2:0] opens_now = opens; wire signed [63:0] whole = $signed(acc);"
        + pipe("opens_now", 3, 3)
        + (
            f"""
            wire [{twin.partners - 1}:0] gather_now = gather;
            reg [{twin.partners - 1}:0] gather_0;
            always @(posedge clk) gather_0 <= gather_now;
            """
            if twin.partners
            else ""
        )
        + f"""
            wire signed [{twin.acc_width - 1}:0] begun = opens_now_1 == 1 ? {own}
                : opens_now_1 == 2 ? {joined} : opens_now_1 == 3 ? {of_output} : acc;
            wire signed [{twin.acc_width - 1}:0] summand = {named};
            reg signed [{twin.acc_width - 1}:0] expected;
            always @(posedge clk) expected <= begun + summand;
        """,
        free=("product",),
        reached=("there[2] && high", "there[2] && low"),
        refuted_by=tuple(faults),
        clocks=6,
        induction=4,
        whole=True,
    )


def behind(twin, word, where):
    """A word with what becomes 0 where the flags of ``where`` say so."""
    for name, mask in twin.zeros.items():
        word = f"({where}_{name} ? {word} & 18'h{mask & 0x3FFFF:05x} : {word})"
    return word


def lane_round(twin):
    """The properties of the part, which say all that it does."""
    low, high = WORD.low, WORD.high
    least = f"(relu ? 0 : {low})" if twin.rectifies else f"{low}"
    with_relu, relu = "", ()
    if twin.rectifies:
        with_relu = " With relu a sum below 0 becomes 0."
        relu = ((r"relu && ", ""), (r"&& \(!relu\)", ""))
    shown = f"cut < {least} ? {least} : cut > {high} ? {high} : cut"
    also = ""
    if twin.cut:
        unit, end = 1 << twin.cut, high + 1 - (1 << twin.cut)
        even = f"sum % 64'sd{unit << DROPPED} == 0 ? 64'sd{2 * unit} : " if twin.even else ""
        with_relu += f" The word is then a multiple of {unit} and at most {end}."
        with_relu += " Of two that are equally near it is the even one." if twin.even else ""
        shown = f"!relu ? ({shown}) : cut < 0 ? 0 : cut > {high} ? {end} : cut - cut % step"
        also = f", its lowest {twin.cut} where next_cut is"
        also += f", and bit {twin.cut} where next_even is" if twin.even else ""
        relu += ((r"low_now \|\| zero0_now", "low_now"),)
        even_faults = (r"rest == 0", "rest == 1"), (r" && \(!high\)", "")
        relu += even_faults if twin.even else ()
    states = ["!after_reset || $signed(word) == expected"]
    if twin.leads:
        given = f"the word is {1 << SAMPLE_SHIFT} times the sample. In the clock before, next_word "
        given += "is the same, except that its lowest 17 bits are still to become 0 where next_low "
        given += f"is high{also}."
        states.append(f"$signed({behind(twin, 'next_word', 'next')}) == now")
        name, value = "eightfold", f"$signed(sample) * 32'sd{1 << SAMPLE_SHIFT}"
        wrong = (r"wide << 3", "wide << 2")
    else:
        given = "the word is that of the first lane, whose lowest 17 bits are 0 where other_low is "
        given += f"high{also.replace('next', 'other')}."
        name, value = "passed", f"$signed({behind(twin, 'other', 'other')})"
        wrong = (r"low_now = other_low", "low_now = 0")
    return [
        Property(
            name="word",
            sentence=f"One clock later the word is the sum without its lowest {DROPPED} bits, or "
            f"the end of the word's range where that lies beyond it.{with_relu} Without own "
            f"{given}",
            states=tuple(states),
            watch=f"""
                wire signed [63:0] sum = $signed(acc);
                wire signed [63:0] cut = sum >>> {DROPPED};
                wire signed [31:0] {name} = {value};
                wire signed [31:0] now = !own ? {name}
                    : {shown};
                reg signed [31:0] expected;
                always @(posedge clk) expected <= now;
            """
            + (f"wire signed [63:0] step = {even}64'sd{unit};" if twin.cut else ""),
            assumes={
                "high and low say whether the sum is above or below every word.": "high == (cut > "
                f"{high}) && low == (cut < {low})"
            },
            reached=(f"after_reset && expected == {low}", f"after_reset && expected == {high}"),
            refuted_by=(
                (r"kept = 131071", "kept = 131070"),
                wrong,
                (r"if \(low_now\)", "if (0)"),
                *relu,
            ),
            clocks=3,
            induction=2,
            whole=True,
        )
    ]
