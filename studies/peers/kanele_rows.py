"""KANELÉ: writes its published networks as plain Verilog, simulates it, and counts the cells.

A network of KANELÉ is a table for each input of each node and a sum for each node, which saturates.
Its own VHDL needs a vendor's library for its memories. So only its data are taken: the widths, the
words of the tables, and frames with their outputs. The registers are where its VHDL has them:
behind each table, behind each sum of up to four, and behind each layer but the last.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from golden.numbers.fixed import Codes
from studies.peers.cells import in_one_piece
from studies.peers.cloned import cloned
from studies.peers.comparison import BEANS, JETS, WINE, Row, Task
from studies.peers.simulated import assert_equal_outputs, check

REPOSITORY = "https://github.com/Duchstf/KANELE"
COMMIT = "9b9621f15e5a2a2a2e688e2060fcb8b75e548e8f"
# For each network its folder, and the accuracy in percent that its authors publish.
NETWORKS = {
    JETS: ("benchmarks/JSC_OpenML/models/official", 76.0),
    BEANS: ("benchmarks/Tran_study/DryBean/models/20250913_102228", 92.05),
    WINE: ("benchmarks/Tran_study/Wine/models/20250914_110625", 98.15),
}
FILES = (
    "config.json",
    "truth_tables.json",
    "firmware/sim/vectors_in.txt",
    "firmware/sim/vectors_out.txt",
)
# The most operands between two registers.
OPERANDS = 4
RANDOM_FRAMES = 2000


@dataclass(frozen=True)
class Layer:
    """One layer.

    width: Bits of an input and of the address of a table.
    signed: Whether an input is signed; words are in the order of the numbers that an input can be.
    out_width: Bits of a word and of an output, both signed.
    tables: The words by node and input; an input that a node does not use has none.
    """

    width: int
    signed: bool
    out_width: int
    tables: dict[int, dict[int, list[int]]]

    @property
    def lowest(self) -> int:
        """The least number that an input can be."""
        return -(1 << (self.width - 1)) if self.signed else 0

    @property
    def stages(self) -> int:
        """Sums of up to four, one behind the other, as the node with the most inputs needs."""
        most, stages = max(map(len, self.tables.values())), 1
        while most > OPERANDS**stages:
            stages += 1
        return stages

    def process(self, codes: Codes) -> Codes:
        """The outputs, shape (frames, nodes), for inputs, shape (frames, inputs)."""
        high = (1 << (self.out_width - 1)) - 1
        sums = [
            sum(np.take(words, codes[:, i] - self.lowest) for i, words in node.items())
            for _, node in sorted(self.tables.items())
        ]
        result: Codes = np.clip(np.stack(sums, axis=-1), -high - 1, high)
        return result


def download(folder: Path) -> Path:
    """A folder with the files of every network; see ``cloned``."""
    files = {
        f"{network}/{Path(file).name}": f"{path}/{file}"
        for network, (path, _) in NETWORKS.items()
        for file in FILES
    }
    return cloned(folder, REPOSITORY, COMMIT, files)


def processed(layers: list[Layer], codes: Codes) -> Codes:
    """The outputs of a network, shape (frames, outputs)."""
    for layer in layers:
        codes = layer.process(codes)
    return codes


def clocks_of(layers: list[Layer]) -> int:
    """One clock for the tables of each layer, those of its sums, and one from layer to layer."""
    return sum(layer.stages + 2 for layer in layers) - 1


def layers_of(config: Mapping[str, Any], tables: Mapping[str, Any]) -> list[Layer]:
    """The layers in the files ``config.json`` and ``truth_tables.json`` of a network."""
    sizes, widths = config["layers"], config["layers_bitwidth"]
    found = [
        Layer(widths[n], n > 0, widths[n + 1], {node: {} for node in range(sizes[n + 1])})
        for n in range(len(sizes) - 1)
    ]
    for name, table in tables.items():
        layer, taken, node = map(int, name.split("_"))
        # The key is spelt like this in its files.
        if table["acive"]:
            found[layer].tables[node][taken] = table["values_int"]
    return found


def written(layers: list[Layer], inputs: int) -> str:
    """A module ``peer`` with ports ``clk``, ``model_inp`` and ``model_out``."""
    first, last = layers[0], layers[-1]
    lines = [
        "module peer (",
        f"    input clk, input [{first.width * inputs - 1}:0] model_inp,",
        f"    output [{last.out_width * len(last.tables) - 1}:0] model_out",
        ");",
    ]
    for i in range(inputs):
        lines.append(
            f"wire [{first.width - 1}:0] x0_{i} = model_inp[{i * first.width} +: {first.width}];"
        )
    for n, layer in enumerate(layers):
        for node, tables in layer.tables.items():
            lines += _node(f"{n}_{node}", n, layer, tables)
        kind = "wire" if layer is last else "reg"
        for node in layer.tables:
            lines.append(
                _passed(kind, f"[{layer.out_width - 1}:0] x{n + 1}_{node}", f"r{n}_{node}")
            )
    outputs = ", ".join(f"x{len(layers)}_{node}" for node in reversed(last.tables))
    return "\n".join([*lines, f"assign model_out = {{{outputs}}};", "endmodule", ""])


def _node(name: str, number: int, layer: Layer, tables: Mapping[int, list[int]]) -> Iterator[str]:
    """The tables, the sums and the saturated result of a node."""
    width, ones = layer.out_width, (1 << layer.out_width) - 1
    terms = []
    for i, words in tables.items():
        # The word of address 0 is that of the number 0, in the lowest bits.
        packed = np.roll(words, layer.lowest)
        text = "".join(f"{int(word) & ones:0{width}b}" for word in packed[::-1])
        terms.append(f"t{name}_{i}")
        yield f"localparam [{len(text) - 1}:0] T{name}_{i} = {len(text)}'b{text};"
        yield _passed(
            "reg signed",
            f"[{width - 1}:0] {terms[-1]}",
            f"T{name}_{i}[x{number}_{i} * {width} +: {width}]",
        )
    width += (len(terms) - 1).bit_length()
    for stage in range(layer.stages):
        groups = [terms[n : n + OPERANDS] for n in range(0, len(terms), OPERANDS)]
        terms = [f"s{name}_{stage}_{n}" for n in range(len(groups))]
        for term, group in zip(terms, groups, strict=True):
            yield _passed("reg signed", f"[{width - 1}:0] {term}", " + ".join(group))
    high = ones >> 1
    (total,) = terms
    yield f"wire signed [{layer.out_width - 1}:0] r{name} = "
    yield f"    {total} > {high} ? {high} : {total} < -{high + 1} ? -{high + 1} : {total};"


def _passed(kind: str, name: str, value: str) -> str:
    """A wire or a register with a value."""
    if kind == "wire":
        return f"wire {name} = {value};"
    return f"{kind} {name}; always @(posedge clk) {name.split()[-1]} <= {value};"


def rows(place: Path, _tasks: Mapping[str, Task], folder: Path) -> Iterator[Row]:
    """The row of each network."""
    for network, (_, right) in NETWORKS.items():
        texts = [(place / network / Path(file).name).read_text("utf-8") for file in FILES]
        config, tables = map(json.loads, texts[:2])
        theirs, expected = (
            np.array([line.split() for line in text.splitlines()], int) for text in texts[2:]
        )
        layers = layers_of(config, tables)
        name = f"KANELÉ, {network}"
        assert_equal_outputs(name, processed(layers, theirs), expected)
        more = np.random.default_rng(1).integers(
            0, 1 << layers[0].width, (RANDOM_FRAMES, theirs.shape[1])
        )
        frames = np.concatenate([theirs, more])
        verilog = folder / network
        verilog.mkdir()
        (verilog / "peer.v").write_text(written(layers, theirs.shape[1]), encoding="utf-8")
        clocks = clocks_of(layers)
        widths = layers[0].width, layers[-1].out_width
        check(name, verilog, frames, processed(layers, frames), clocks, widths)
        shape = ":".join(map(str, config["layers"]))
        cells = in_one_piece(verilog, "peer")
        yield Row(network, f"KANELÉ, {shape}", cells, clocks, 1, right=right)
