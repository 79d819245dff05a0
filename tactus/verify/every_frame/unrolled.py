"""A run of hardware clock by clock, in which samples are symbols.

Registers and memories begin as X. What is known is computed; what hangs on samples becomes an
expression, which nobody evaluates before it is asked for. A select or an address that hangs on
samples is allowed; a write whose address or enable does is not.
"""

from collections import defaultdict
from collections.abc import Mapping
from graphlib import CycleError, TopologicalSorter
from typing import Any

from tactus.verify.every_frame.bits import (
    Bits,
    Expression,
    Words,
    X,
    abstract,
    cut,
    extended,
    join,
    part,
    unknown,
)
from tactus.verify.every_frame.netlist import Cell, Memory, Net, Netlist, NotReadableError, Port
from tactus.verify.every_frame.operators import CELLS, MODULAR, read_signed, signed
from tactus.verify.every_frame.sums import UnsupportedError

# How deep choices inside choices are searched for the same select.
NESTED = 6

# Registers, and memories that are written.
State = list[Bits]


class Unrolled:
    """One run; `step` gives the inputs of a clock, `clock` is its rising edge."""

    def __init__(self, hardware: Netlist):
        self.hardware = hardware
        # What nothing has set yet is X.
        self.now: dict[Net, Bits] = defaultdict(lambda: X)
        for m in hardware.memories:
            # What a memory that is written held at the start is not known.
            self.now[m.words] = Words([X] * len(m.start) if m.write else m.start)
        self.written = [m for m in hardware.memories if m.write]
        self.held = [r.output for r in hardware.registers] + [m.words for m in self.written]
        self.made: dict[Any, Expression] = {}
        self.clocks = 0
        self.order = [*_ordered(hardware), *hardware.registers]
        # Which cells read a word, and which wait because one has changed.
        self.readers: dict[Net, list[int]] = defaultdict(list)
        for k, cell in enumerate(self.order):
            for net in _sources(cell):
                self.readers[net].append(k)
        self.waiting = bytearray(b"\1" * len(self.order))
        # What registers take at the next edge.
        self.taken: dict[Net, Bits] = {}
        self._settle()

    def get(self, port: Port) -> Bits:
        source, _, count = port[0]
        if len(port) == 1 and count == getattr(source, "width", 0):
            return self.now[source]
        return join(
            part
            for s, low, n in port
            for part in (cut(self.now[s], low, n) if isinstance(s, Net) else ((s, low, n),))
        )

    def expression(
        self, kind: str, width: int, arguments: tuple[Any, ...], name: str, extra: Any = None
    ) -> Expression:
        key = kind, width, arguments, extra
        if key not in self.made:
            name = f"{name}, clock {self.clocks}"
            self.made[key] = Expression(kind, width, arguments, extra, name)
        return self.made[key]

    def sample(self, name: str, width: int) -> Expression:
        return self.expression("sample", width, (), name, name)

    def _set(self, net: Net, v: Bits) -> None:
        if self.now[net] is not v and self.now[net] != v:
            self.now[net] = v
            for k in self.readers[net]:
                self.waiting[k] = 1

    def step(self, inputs: Mapping[str, Bits]) -> None:
        """The inputs of this clock, and all wires settled."""
        for name, net in self.hardware.inputs.items():
            self._set(net, inputs.get(name, 0))
        self._settle()

    def _settle(self) -> None:
        k = self.waiting.find(1)
        while k >= 0:
            self.waiting[k], cell = 0, self.order[k]
            if cell.kind == "$dff":
                self.taken[cell.output] = self.get(cell.inputs["D"])
            else:
                self._set(cell.output, self._cell(cell))
            k = self.waiting.find(1, k)

    def clock(self) -> None:
        """The rising edge."""
        new = [self.taken[r.output] for r in self.hardware.registers]
        self.restore(new + [self._behind(m) for m in self.written])
        self.clocks += 1

    def _behind(self, memory: Memory) -> Words:
        """The words of a memory behind this clock."""
        words: Words = self.now[memory.words]
        address, data, enable = map(self.get, memory.write or ())
        if enable == 0:
            return words
        if unknown(enable) or unknown(address):
            return Words([X] * len(words))
        if enable != (1 << memory.words.width) - 1 or not isinstance(address, int):
            raise UnsupportedError(
                f"memory {memory.words.name}, clock {self.clocks}: a write of a "
                "part of a word, or whose address or enable hangs on samples"
            )
        return Words(data if place == address else old for place, old in enumerate(words))

    def out(self, name: str) -> Bits:
        return self.get(self.hardware.outputs[name])

    def state(self) -> State:
        return [self.now[net] for net in self.held]

    def restore(self, state: State) -> None:
        for net, v in zip(self.held, state, strict=True):
            self._set(net, v)

    def abstracted(self) -> State:
        """The state with X in place of all that hangs on samples."""
        return [abstract(v) for v in self.state()]

    def _chosen(self, cell: Cell) -> Bits:
        """The part of B whose bit of S is 1, or A."""
        s, b = (self.get(cell.inputs[port]) for port in "SB")
        width = cell.output.width
        selects = [part(s, k, 1) for k in range(_width(cell.inputs["S"]))]
        if 1 in selects:
            return part(b, selects.index(1) * width, width) if selects.count(1) == 1 else X
        # What is chosen by itself is chosen where no bit of it is 1.
        v = 0 if cell.inputs["A"] == cell.inputs["S"] else self.get(cell.inputs["A"])
        for k, select in reversed([*enumerate(selects)]):
            yes = v if select == 0 else part(b, k * width, width)
            if select is X:
                v = yes if yes == v else X
            elif yes != v:
                branches = self._within(yes, select, 1), self._within(v, select, 0)
                v = self.expression("$mux", width, (select, *branches), cell.output.name)
        return v

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
        return self.expression("$mux", v.width, (select, *inner), v.name)

    def _cell(self, cell: Cell) -> Bits:
        kind, inputs = cell.kind, cell.inputs
        name, width = cell.output.name, cell.output.width
        if kind in ("$mux", "$pmux"):
            return self._chosen(cell)
        if kind == "read":
            words, address = self.get(inputs["M"]), self.get(inputs["A"])
            if isinstance(address, int):
                return words[address] if address < len(words) else X
            count = _width(inputs["A"])
            read = (address, count, False)
            return X if unknown(address) else self.expression(kind, width, (read,), name, words)
        if kind not in CELLS:
            raise NotReadableError(f"cell {name}: {kind} is not known")
        ports = [p for p in "AB" if p in inputs]
        sign = read_signed(kind, all(cell.signed[p] for p in ports))
        given = [(self.get(inputs[p]), _width(inputs[p]), sign) for p in ports]
        if kind in MODULAR:
            # An operand counts in as many bits as the result has.
            given = [(extended(v, n, width, sign), width, sign) for v, n, _ in given]
        values = [v for v, _, _ in given]
        if all(isinstance(v, int) for v in values):
            numbers = [signed(v, n) if sign else v for v, n, _ in given]
            return int(CELLS[kind](*numbers)) & (1 << width) - 1
        if kind in ("$mul", "$and", "$logic_and") and 0 in values:
            return 0
        if kind == "$logic_or" and any(isinstance(v, int) and v for v in values):
            return 1
        return X if any(map(unknown, values)) else self.expression(kind, width, tuple(given), name)


def _width(port: Port) -> int:
    return sum(count for _, _, count in port)


def _sources(cell: Cell) -> set[Net]:
    return {s for port in cell.inputs.values() for s, _, _ in port if isinstance(s, Net)}


def _ordered(hardware: Netlist) -> list[Cell]:
    """The cells, each behind those that it hangs on."""
    cells = {cell.output: cell for cell in hardware.cells}
    sources = {net: _sources(cell) & cells.keys() for net, cell in cells.items()}
    try:
        return [cells[net] for net in TopologicalSorter(sources).static_order()]
    except CycleError as loop:
        name = loop.args[1][0].name
        raise NotReadableError(f"a loop of combinational cells through {name}") from None
