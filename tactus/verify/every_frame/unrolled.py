"""A run of hardware clock by clock, in which samples are symbols.

Registers and memories begin as X. What is known is computed; what hangs on samples becomes an
expression, which nobody evaluates before it is asked for. A clock enable, a select or an address
that hangs on samples is allowed; a write whose address or enable does is not.
"""

import heapq
from collections.abc import Mapping
from typing import Any

from tactus.verify.every_frame.bits import (
    Bits,
    Expression,
    X,
    abstract,
    cut,
    extended,
    join,
    part,
    unknown,
)
from tactus.verify.every_frame.netlist import Cell, Memory, Netlist, NotReadableError, Run
from tactus.verify.every_frame.operators import MODULAR, ONE, SHIFTS, TWO, UNSIGNED, signed
from tactus.verify.every_frame.sums import UnsupportedError

# How deep choices inside choices are searched for the same select.
NESTED = 6

State = tuple[list[Bits], list[Any]]


class Table:
    """The known words of a memory, one object for each content."""

    def __init__(self, words: list[int | None], offset: int):
        self.words, self.offset = words, offset


class Unrolled:
    """One run; `step` gives the inputs of a clock, `clock` is its rising edge."""

    def __init__(self, hardware: Netlist):
        self.hardware = hardware
        self.now: list[Bits] = [X] * len(hardware.widths)
        self.words: list[Any] = [
            # What a memory that is written held at the start is not known.
            [X if w is None or m.writes else w for w in m.start]
            for m in hardware.memories
        ]
        self.made: dict[Any, Expression] = {}
        self.tables: dict[int, tuple[list[Bits], Table]] = {}
        self.clocks = 0
        self.order = _ordered(hardware)
        self.users: list[list[int]] = [[] for _ in hardware.widths]
        self.readers: list[list[int]] = [[] for _ in hardware.memories]
        for place, item in enumerate(self.order):
            runs = (
                [r for p in item.inputs.values() for r in p]
                if isinstance(item, Cell)
                else item[0].reads[item[1]][0]
            )
            for word in {r.word for r in runs if r.word is not None}:
                self.users[word].append(place)
            if not isinstance(item, Cell):
                self.readers[hardware.memories.index(item[0])].append(place)
        self.waiting = list(range(len(self.order)))
        self.queued = set(self.waiting)

    # Values.

    def get(self, runs: tuple[Run, ...]) -> Bits:
        if len(runs) == 1:
            run = runs[0]
            if run.word is None:
                return X if run.bits is None else run.bits
            v = self.now[run.word]
            return v if run.count == self.hardware.widths[run.word] else part(v, run.low, run.count)
        return join(
            p
            for r in runs
            for p in (
                ((X if r.bits is None else r.bits, 0, r.count),)
                if r.word is None
                else cut(self.now[r.word], r.low, r.count)
            )
        )

    def expression(
        self, kind: str, width: int, arguments: tuple[Any, ...], extra: Any, name: str
    ) -> Expression:
        key = kind, width, arguments, extra
        found = self.made.get(key)
        if found is None:
            found = self.made[key] = Expression(
                kind, width, arguments, extra, f"{name}, clock {self.clocks}"
            )
        return found

    def sample(self, name: str, width: int) -> Expression:
        return self.expression("sample", width, (), name, name)

    # A clock.

    def _set(self, word: int, v: Bits) -> None:
        old = self.now[word]
        if old is v or (type(old) is type(v) and old == v):
            return
        self.now[word] = v
        for place in self.users[word]:
            if place not in self.queued:
                self.queued.add(place)
                heapq.heappush(self.waiting, place)

    def step(self, inputs: Mapping[str, Bits]) -> None:
        """The inputs of this clock, and all wires settled."""
        for name, word in self.hardware.inputs.items():
            self._set(word, inputs.get(name, 0))
        while self.waiting:
            place = heapq.heappop(self.waiting)
            self.queued.discard(place)
            item = self.order[place]
            if isinstance(item, Cell):
                self._set(item.output, self._cell(item))
            else:
                memory, port = item
                runs, output = memory.reads[port]
                self._set(output, self._read(memory, self.get(runs)))

    def clock(self) -> None:
        """The rising edge."""
        new = [(r.output, self._next(r)) for r in self.hardware.registers]
        writes = [w for m in range(len(self.hardware.memories)) for w in self._written(m)]
        for word, v in new:
            self._set(word, v)
        for m, address, v in writes:
            words = (
                list(self.words[m]) if address is not None else [X] * self.hardware.memories[m].size
            )
            if address is not None and words[address] == v:
                continue
            if address is not None:
                words[address] = v
            self._fill(m, words)
        self.clocks += 1

    def _fill(self, m: int, words: list[Bits]) -> None:
        self.words[m] = words
        for place in self.readers[m]:
            if place not in self.queued:
                self.queued.add(place)
                heapq.heappush(self.waiting, place)

    def out(self, name: str) -> Bits:
        return self.get(self.hardware.outputs[name])

    # The state: registers, and words of memories that are written.

    def state(self) -> State:
        return [self.now[r.output] for r in self.hardware.registers], list(self.words)

    def restore(self, state: State) -> None:
        for register, v in zip(self.hardware.registers, state[0], strict=True):
            self._set(register.output, v)
        for m, words in enumerate(state[1]):
            if self.words[m] is not words:
                self._fill(m, words)

    def abstracted(self, state: State) -> State:
        """The state with X in place of all that hangs on samples."""
        return [abstract(v) for v in state[0]], [
            [abstract(v) for v in words] if m.writes else words
            for m, words in zip(self.hardware.memories, state[1], strict=True)
        ]

    # Cells.

    def _next(self, r: Cell) -> Bits:
        old, v = self.now[r.output], self.get(r.inputs["D"])
        enable: Bits = self._flag(r, "EN") if "EN" in r.inputs else 1
        reset: Bits = self._flag(r, "SRST") if "SRST" in r.inputs else 0
        if r.kind == "$sdffce":
            return self._mux(enable, self._mux(reset, r.parameters["SRST_VALUE"], v, r), old, r)
        v = self._mux(enable, v, old, r)
        return self._mux(reset, r.parameters.get("SRST_VALUE", 0), v, r)

    def _flag(self, r: Cell, name: str) -> Bits:
        v = self.get(r.inputs[name])
        if r.flag(name + "_POLARITY") or v is X:
            return v
        return (
            1 - v
            if isinstance(v, int)
            else self.expression("$logic_not", 1, ((v, 1, False),), None, r.name)
        )

    def _mux(self, s: Bits, yes: Bits, no: Bits, cell: Cell) -> Bits:
        if isinstance(s, int):
            return yes if s else no
        if yes is no or (type(yes) is type(no) and yes == no):
            return yes
        if s is X:
            return X
        if isinstance(yes, int) and isinstance(no, int) and cell.width == 1 and yes and not no:
            return s
        return self.expression(
            "$mux",
            cell.width,
            (s, self._within(yes, s, 1), self._within(no, s, 0)),
            None,
            self.hardware.names[cell.output],
        )

    def _within(self, v: Bits, s: Bits, chosen: int, depth: int = NESTED) -> Bits:
        """A branch of a choice: choices by the same select inside it are decided."""
        if not isinstance(v, Expression) or v.kind != "$mux" or not depth:
            return v
        select, yes, no = v.arguments
        if select == s:
            return self._within(yes if chosen else no, s, chosen, depth)
        inner = [self._within(b, s, chosen, depth - 1) for b in (yes, no)]
        if inner[0] is yes and inner[1] is no:
            return v
        return self.expression("$mux", v.width, (select, *inner), None, v.name)

    def _read(self, memory: Memory, address: Bits) -> Bits:
        m = self.hardware.memories.index(memory)
        words = self.words[m]
        if isinstance(address, int):
            place = address - memory.offset
            return words[place] if 0 <= place < memory.size else X
        if unknown(address):
            return X
        found = self.tables.get(m)
        if found is None or found[0] is not words:
            found = self.tables[m] = (
                words,
                Table([w if isinstance(w, int) else None for w in words], memory.offset),
            )
        width = sum(r.count for r in memory.reads[0][0])
        return self.expression(
            "read", memory.width, ((address, width, False),), found[1], memory.name
        )

    def _written(self, m: int) -> list[tuple[int, int | None, Bits]]:
        """The writes of this clock: memory, place (None: anywhere) and word."""
        memory, found = self.hardware.memories[m], list[tuple[int, int | None, Bits]]()
        for address, data, enable in memory.writes:
            e, a = self.get(enable), self.get(address)
            if e == 0:
                continue
            if unknown(e) or unknown(a):
                found.append((m, None, X))
            elif not isinstance(e, int) or not isinstance(a, int):
                raise UnsupportedError(
                    f"memory {memory.name}, clock {self.clocks}: a write whose address or "
                    "enable hangs on samples"
                )
            elif 0 <= a - memory.offset < memory.size:
                place, new = a - memory.offset, self.get(data)
                if e != (1 << memory.width) - 1:
                    old = self.words[m][place]
                    new = join(
                        cut(new if e >> k & 1 else old, k, 1)[0] for k in range(memory.width)
                    )
                if any(w[1] == place for w in found):
                    raise UnsupportedError(
                        f"memory {memory.name}, clock {self.clocks}: two writes to one word"
                    )
                found.append((m, place, new))
        return found

    def _cell(self, cell: Cell) -> Bits:
        kind, width = cell.kind, cell.width
        if kind == "$mux":
            s = self.get(cell.inputs["S"])
            if isinstance(s, int):
                return self.get(cell.inputs["B" if s else "A"])
            # What is chosen by itself is known where it is chosen.
            no = 0 if cell.inputs["A"] == cell.inputs["S"] else self.get(cell.inputs["A"])
            return self._mux(s, self.get(cell.inputs["B"]), no, cell)
        if kind == "$pmux":
            return self._pmux(cell)
        given = [
            (
                self.get(cell.inputs[p]),
                sum(r.count for r in cell.inputs[p]),
                cell.flag(p + "_SIGNED"),
            )
            for p in "AB"
            if p in cell.inputs
        ]
        both = all(g[2] for g in given) and kind not in UNSIGNED
        if kind in SHIFTS or kind in ("$shift", "$shiftx"):
            return self._shifted(cell, given)
        if kind not in ONE and kind not in TWO:
            raise NotReadableError(f"cell {cell.name}: {kind} is not known")
        if kind in MODULAR:
            # An operand counts in as many bits as the result has.
            given = [(extended(v, n, width, both), width, both) for v, n, _ in given]
        else:
            given = [(v, n, both) for v, n, _ in given]
        values = [g[0] for g in given]
        if all(isinstance(v, int) for v in values):
            numbers = [signed(v, n) if s else v for v, n, s in given]
            found = ONE[kind](numbers[0], given[0][1]) if len(given) == 1 else TWO[kind](*numbers)
            return int(found) & (1 << width) - 1
        simple = _simple(kind, values, width)
        if simple is not None:
            return simple
        if any(unknown(v) for v in values):
            return X
        if kind in ("$eq", "$eqx", "$ne", "$nex") and values[0] == values[1]:
            return int(kind in ("$eq", "$eqx"))
        return self.expression(kind, width, tuple(given), None, self.hardware.names[cell.output])

    def _pmux(self, cell: Cell) -> Bits:
        v, width = self.get(cell.inputs["A"]), cell.width
        s, b = self.get(cell.inputs["S"]), self.get(cell.inputs["B"])
        count = sum(r.count for r in cell.inputs["S"])
        selects = [part(s, k, 1) for k in range(count)]
        if sum(x == 1 for x in selects if isinstance(x, int)) > 1:
            return X
        for k in range(count):
            if isinstance(selects[k], int) and selects[k]:
                return part(b, k * width, width)
        for k in reversed(range(count)):
            v = self._mux(selects[k], part(b, k * width, width), v, cell)
        return v

    def _shifted(self, cell: Cell, given: list[tuple[Bits, int, bool]]) -> Bits:
        (a, n, a_signed), (b, m, b_signed) = given
        kind, width = cell.kind, cell.width
        fill = a_signed and kind in (*SHIFTS, "$shift")
        if unknown(b):
            return X
        if not isinstance(b, int):
            if unknown(a) or kind in ("$shift", "$shiftx"):
                return X
            size = max(n, width)
            return self.expression(
                kind,
                width,
                ((extended(a, n, size, fill), size, fill and kind == "$sshr"), (b, m, False)),
                None,
                cell.name,
            )
        by = signed(b, m) if b_signed and kind in ("$shift", "$shiftx") else b
        left = kind in ("$shl", "$sshl") or by < 0
        by = abs(by)
        size = max(n, width)
        a = extended(a, n, size, fill)
        if left:
            return part(join(((0, 0, min(by, width)), *cut(a, 0, max(width - by, 0)))), 0, width)
        top = extended(a, size, size + by, fill and kind == "$sshr") if by <= 4 * size else 0
        return part(top, by, width)


def _simple(kind: str, values: list[Bits], width: int) -> Bits | None:
    """What is known though not every operand is, or is one of the operands."""
    for k, v in enumerate(values):
        other = values[1 - k] if len(values) == 2 else None
        if not isinstance(v, int):
            continue
        if (kind in ("$mul", "$and", "$logic_and") and v == 0) or (kind == "$logic_or" and v):
            return int(kind == "$logic_or")
        if (kind == "$add" or (kind == "$sub" and k == 1)) and v == 0:
            return other
        if kind in ("$and", "$or"):
            # A known bit passes the other operand's bit, or decides alone.
            passes, fixed = (1, 0) if kind == "$and" else (0, 1)
            return join(
                cut(other, b, 1)[0] if v >> b & 1 == passes else (fixed, 0, 1) for b in range(width)
            )
    if kind == "$pos":
        return values[0]
    if kind in ("$and", "$or") and values[0] == values[1]:
        return values[0]
    return None


def _ordered(hardware: Netlist) -> list[Any]:
    """Cells and reads of memories, each behind those that it hangs on."""
    items: dict[int, Any] = {c.output: c for c in hardware.cells}
    items |= {output: (m, k) for m in hardware.memories for k, (_, output) in enumerate(m.reads)}

    def sources(item: Any) -> list[int]:
        runs = (
            [r for p in item.inputs.values() for r in p]
            if isinstance(item, Cell)
            else item[0].reads[item[1]][0]
        )
        return [r.word for r in runs if r.word in items]

    order, state = [], dict.fromkeys(items, 0)
    for first in items:
        stack = [(first, False)]
        while stack:
            word, done = stack.pop()
            if done:
                state[word] = 2
                order.append(items[word])
            elif state[word] == 0:
                state[word] = 1
                stack.append((word, True))
                for source in sources(items[word]):
                    if state[source] == 1:
                        raise NotReadableError(
                            f"a loop of combinational cells through {hardware.names[source]}"
                        )
                    if state[source] == 0:
                        stack.append((source, False))
    return order
