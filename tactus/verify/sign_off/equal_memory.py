"""Finds the memories of a netlist: GHDL makes one wire of all words of a list, and shifts it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from tactus.verify.sign_off.equal_gates import UNNAMED, Gate, Net, constant, wire_range


@dataclass(frozen=True)
class Access:
    """A read or a write of one word; ``index`` counts the words from the right."""

    index: Net
    data: Net
    clock: Net | None = None
    enable: Net | None = None


@dataclass
class Memory:
    """A list of words that is read or written one at a time; a table has a ``content``, too."""

    name: str
    count: int
    width: int
    content: int | None = None
    reads: list[Access] = field(default_factory=list)
    writes: list[Access] = field(default_factory=list)


def split_memories(gates: list[Gate], lists: dict[str, int]) -> tuple[list[Memory], list[Gate]]:
    """The memories among gates, and the other gates."""
    maker = {net: gate for gate in gates for net in gate.outputs.values()}
    memories: dict[Net, Memory] = {}
    gone: list[Gate] = []
    for insert in gates:
        if insert.kind == "$dyn_insert":
            held, index = insert.inputs["v"], insert.inputs["i"]
            signal, place = maker[held], maker[index]
            register = maker[signal.inputs["i"]]
            choice = maker[register.inputs["d"]]
            if (choice.kind, choice.inputs["i0"], choice.inputs["i1"]) != (
                "$mux2",
                held,
                insert.outputs["o"],
            ):
                raise ValueError(f"{signal.name}: a memory, expected one write under one condition")
            count = lists[signal.name]
            memory = Memory(signal.name, count, held.width // count)
            _check_index(place, insert, memory)
            memory.writes.append(
                Access(
                    place.inputs["i"],
                    insert.inputs["d"],
                    register.inputs["clk"],
                    choice.inputs["s"],
                )
            )
            memories[held] = memory
            gone += [insert, signal, place, register, choice]
    for extract in gates:
        if extract.kind == "$dyn_extract":
            held, place = extract.inputs["v"], maker[extract.inputs["i"]]
            if held not in memories:
                width = extract.outputs["o"].width
                table = maker[held]
                name = f"{UNNAMED}table{table.name.strip('%')}"
                memories[held] = Memory(name, held.width // width, width, constant(table))
                gone.append(table)
            _check_index(place, extract, memories[held])
            memories[held].reads.append(Access(place.inputs["i"], extract.outputs["o"]))
            gone += [extract, place]
    left = [gate for gate in gates if not any(gate is other for other in gone)]
    missing = {net for gate in gone for net in gate.outputs.values()}
    missing -= {read.data for memory in memories.values() for read in memory.reads}
    for gate in left:
        if missing & set(gate.inputs.values()):
            raise ValueError(f"{gate.name}: {gate.kind}: got all words of a memory, expected one")
    return list(memories.values()), left


def _check_index(place: Gate, access: Gate, memory: Memory) -> None:
    if place.kind != "$memidx" or place.parameters[0] != memory.width or access.parameters != [0]:
        raise ValueError(
            f"{memory.name}: got {place.kind} {place.parameters}, expected whole words"
        )


def write_memory(
    memory: Memory,
    name_of: Callable[[Net], str],
    clock_of: Callable[[Net], str],
    from_left: Callable[[Net, int], str],
) -> Iterator[str]:
    """The Verilog of a memory, whose first word stands at the left.

    ``from_left`` gives the address of a word from its index, which counts from the right, and the
    index of the first word.
    """
    name, last = memory.name, memory.count - 1
    yield f"reg {wire_range(memory.width)}{name} [0:{last}];"
    if memory.content is not None:
        yield "initial begin"
        for n in range(memory.count):
            word = (memory.content >> (last - n) * memory.width) & ((1 << memory.width) - 1)
            yield f"    {name}[{n}] = {memory.width}'h{word:x};"
        yield "end"
    for n, access in enumerate((*memory.reads, *memory.writes)):
        place = f"{name}_place{n}"
        yield f"wire {wire_range(access.index.width)}{place} = {from_left(access.index, last)};"
        if access.clock is None or access.enable is None:
            yield f"assign {name_of(access.data)} = {name}[{place}];"
        else:
            yield (
                f"always @(posedge {clock_of(access.clock)}) if ({name_of(access.enable)}) "
                f"{name}[{place}] <= {name_of(access.data)};"
            )
