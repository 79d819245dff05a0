"""The properties of constant_matrix, for all samples: no sum of its graph overflows."""

from golden.layers.shift_add import Constant, Input, Sum
from golden.numbers.fixed import signed_width
from tb.common.properties import Property

BEGUN = "reg begun = 0; always @(posedge clk) begun <= 1;"


class Signals:
    """The block's signals, named in the order in which it makes them.

    there: For each node and clock, the signal that holds the node then.
    late: For each delayed signal, the signal that holds the same value a clock earlier.
    constants: For each register that holds a constant row, its number. It is unknown in the first
        clock.
    results: The signals that hold the rows in the clock before the results.
    """

    def __init__(self, twin):
        self.graph = twin.graph
        self.made, self.there, self.late, self.constants = {}, {}, {}, {}
        for place, node in enumerate(self.graph.nodes):
            clock = twin.clocks[place]
            if isinstance(node, Input):
                self.there[place, 0] = f"in_data_{node.number}"
            elif isinstance(node, Sum):
                for one in node.operands:
                    self.at(one.node, clock)
                self.there[place, clock] = self._total(place, node)
        self.results = [self._row(row.node, twin.latency - 1) for row in self.graph.rows]

    def at(self, place, clock):
        node = self.graph.nodes[place]
        if isinstance(node, Constant):
            return f"{node.value}"
        if (place, clock) not in self.there:
            before = self.at(place, clock - 1)
            self.there[place, clock] = self._name("delay", "data_late")
            self.late[self.there[place, clock]] = before
        return self.there[place, clock]

    def _row(self, place, clock):
        node = self.graph.nodes[place]
        if not isinstance(node, Constant):
            return self.at(place, clock)
        signal = self._name("constant", "number")
        self.constants[signal] = node.value
        return signal

    def _total(self, place, node):
        first, *others = node.operands
        constants = [isinstance(self.graph.nodes[one.node], Constant) for one in node.operands]
        if others[1:]:
            total = self._name("add_two_and_constant" if any(constants) else "add_three", "total")
            return self._name("append", "total") if self.graph.passing(place) else total
        if any(constants):
            return self._name("add_constant", "total")
        if self.graph.passing(place):
            return self._name("add_above", "total")
        return self._name("add" if first.sign == others[0].sign else "subtract", "total")

    def _name(self, kind, signal):
        self.made[kind] = self.made.get(kind, -1) + 1
        return f"{kind}{self.made[kind]}_{signal}"


def apart(graph):
    """The sums, divided into lists so that no list holds both a sum and its operand."""
    lists = {}
    for place, node in enumerate(graph.nodes):
        if isinstance(node, Sum):
            taken = {lists.get(one.node) for one in node.operands}
            lists[place] = next(n for n in range(4) if n not in taken)
    return [[p for p, n in lists.items() if n == number] for number in sorted(set(lists.values()))]


def wrong(twin, signals, places):
    """Copies in which the largest possible sum is inverted, or has two bits fewer.

    If all sums have their last bits from an operand, either part of the largest one is inverted.
    """
    reaches = twin.graph.reaches
    totals = {place: signals.there[place, twin.clocks[place]] for place in places}
    whole = [place for place, total in totals.items() if not total.startswith("append")]
    largest = max(whole or places, key=lambda place: reaches[place].most - reaches[place].least)
    total = totals[largest]
    if not whole:
        return (
            (rf"({total} = \$signed\(\{{)(\w+, )", r"\1~\2"),
            (rf"({total} = \$signed\(\{{\w+, )(\w+)", r"\1~\2"),
        )
    return (
        (rf"({total} =) (\$signed\(\{{?result)", r"\1 ~\2"),
        (rf"({total} = \$signed\(\{{?result\[\d+)-1", r"\1-3"),
    )


def literal(value):
    """A number in Verilog, with its sign, in as many bits as it needs."""
    return f"({'-' if value < 0 else ''}{abs(value).bit_length() + 1}'sd{abs(value)})"


def within(value, least, most):
    return f"{value} >= {literal(least)} && {value} <= {literal(most)}"


def sums(twin, signals, places, number):
    """The property that each of some sums is right if its operands, which may be anything, are.

    Operand k is a signal less an error, and a sum takes ``signal >> cut << move`` of it. So the
    exact sum is what the sum must be, ``sum_p``, less ``lost_p``: all errors, and all bits that are
    cut. Said so, nothing is left for the solver but equal sums, and bounds of words of few bits.
    """
    graph = twin.graph
    watch, states, errors = [], [], set()
    for place in places:
        node, clock, reach = graph.nodes[place], twin.clocks[place], graph.reaches[place]
        total, lost, most, given = literal(0), literal(0), 0, []
        for one, step in zip(node.operands, graph.steps(place), strict=True):
            known, sign = graph.nodes[one.node], "-" if one.sign < 0 else "+"
            constant = isinstance(known, Constant)
            value = literal(known.value) if constant else signals.at(one.node, clock)
            total += f" {sign} ((({value}) >>> {step.cut}) <<< {step.move})"
            error, cut = literal(0), (1 << step.cut) - 1
            ends = graph.reaches[one.node].below, graph.reaches[one.node].above
            if any(ends):
                error = f"error_{one.node}"
                given.append(within(error, *ends))
                if error not in errors:
                    watch.append(f"(* anyseq *) reg signed [{signed_width(ends) - 1}:0] {error};")
                errors.add(error)
            rest = f"({value} & {literal(cut)}) <<< {graph.lows[one.node]}"
            lost += f" {sign} (({error} - ({rest})) <<< {one.shift})"
            most += (max(map(abs, ends)) + (cut << graph.lows[one.node])) << one.shift
        # What is lost never wraps. The other two may, but not while the exact sum is where it is
        # asked for: then each of them has room for more than its bounds.
        bits, low = graph.widths[place] + 2, graph.lows[place]
        watch += [
            f"wire signed [{bits - 1}:0] sum_{place} = {total};",
            f"wire signed [{most.bit_length()}:0] lost_{place} = {lost};",
            f"wire signed [{bits + low - 1}:0] exact_{place} = "
            f"(sum_{place} <<< {low}) - lost_{place};",
        ]
        given.append(within(f"exact_{place}", reach.least, reach.most))
        own = f"{signals.there[place, clock]} == sum_{place}"
        own += f" && {within(f'lost_{place}', reach.below, reach.above)}"
        states.append(f"!({' && '.join(given)}) || ({own})")
    own = {signals.there[place, twin.clocks[place]] for place in places}
    # The last bits of these are those of their operands, so freeing one would free them too.
    kept = ("in_data", "add_above", "append")
    return Property(
        name=f"sums {number}",
        sentence=f"Each of {len(places)} sums differs from the exact sum of products that it "
        "stands for by no more than the twin allows for the bits that are cut, if the same holds "
        "for all its operands, and if the exact sum lies between the ends that weights and "
        "samples give it. So no sum wraps.",
        states=tuple(states),
        watch="\n".join(watch),
        free=tuple(s for s in signals.there.values() if s not in own and not s.startswith(kept)),
        refuted_by=wrong(twin, signals, places),
        clocks=1,
        induction=1,
    )


def results(twin, signals):
    """The property that each result is that of its row, and that delayed signals keep values."""
    fmt, graph = twin.out_fmt, twin.graph
    watch, states = [BEGUN], []
    for number, (row, signal) in enumerate(zip(graph.rows, signals.results, strict=True)):
        drop, invert = twin.drop(row), "~" if row.minus else ""
        moved = f">>> {drop}" if drop >= 0 else f"<<< {-drop}"
        even, low = twin.row_finishes[number].even, twin.result_lows[number]
        rest = f"({invert}row_{number} & {(1 << max(0, drop)) - 1})"
        # Where all dropped bits are 0, the last bit becomes 0.
        kept = f" & ({rest} == 0 ? -64'sd2 : -64'sd1)" if even else ""
        watch.append(
            f"""
                wire signed [63:0] row_{number} = {signal};
                reg signed [63:0] due_{number};
                always @(posedge clk) due_{number} <= (({invert}row_{number}) {moved}){kept};
            """
        )
        due = f"due_{number}"
        ends = f"{due} < {low} ? {low} : {due} > {fmt.high} ? {fmt.high} : {due}"
        states.append(f"!begun || out_data_{number} == ({ends})")
    for late, early in signals.late.items():
        watch.append(f"reg signed [63:0] ago_{late}; always @(posedge clk) ago_{late} <= {early};")
        states.append(f"!begun || {late} == ago_{late}")
    for signal, value in signals.constants.items():
        states.append(f"!begun || {signal} == {value}")
    rectified = any(finish.rectified for finish in twin.row_finishes)
    finished = "saturated"
    broken = ((r"\(top == 0\) \|\| ", ""), (r"else if \(word\[(\d+)\]\)", r"else if (!word[\1])"))
    if all(graph.widths[row.node] - twin.drop(row) <= fmt.width for row in graph.rows):
        # No result saturates, so there is no saturation to break.
        broken = ((r"\(word << ", "(~word << "),)
    if rectified:
        finished = "0 instead of negative, and saturated"
        broken = ((r"if \(word\[(\d+)\]\)", r"if (!word[\1])"),)
    if any(finish.even for finish in twin.row_finishes):
        finished += "; half way between two results it is the even one"
        broken = (*broken, (r"(?s)(tie_to_even0_clear.*?) == 0\)", r"\1 == 1)"))
    return Property(
        name="results",
        sentence="Each result is the number of its row one clock before, without its last bits and "
        f"{finished}. {len(signals.late)} numbers that a later clock needs are kept as they were.",
        states=tuple(states),
        watch="\n".join(watch),
        refuted_by=(*broken, *((rf"({late} <=)", r"\1 ~") for late in list(signals.late)[:1])),
        free=tuple(s for (_, clock), s in signals.there.items() if not clock and "total" in s),
        clocks=3,
        induction=1,
        whole=True,
    )


def constant_matrix(twin):
    signals = Signals(twin)
    lists = apart(twin.graph)
    return [
        *(sums(twin, signals, places, number) for number, places in enumerate(lists)),
        results(twin, signals),
    ]
