"""The networks of a scene as the prover reads them, from what `golden` says that they are.

Taken are integer networks, weights, formats and tables as arrays. Nothing here is a program or was
scheduled. Of a graph of adders the sums themselves are taken, because they say which bits are
dropped.
"""

from collections.abc import Callable, Sequence
from functools import partial, singledispatch
from typing import Any

import numpy as np

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, RESULT, SAMPLE_SHIFT, WIDTH
from golden.engine.function_table import table_of
from golden.engine.integer_network import IntegerLayer, IntegerNetwork
from golden.engine.quantise import integer_networks
from golden.input_error import InputError
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.shift_add import Constant, Input
from golden.learning.corrected import Corrected
from golden.networks.adder_graph import AdderGraph
from golden.networks.cascade import Cascade
from golden.networks.engine import Engine
from golden.networks.hybrid import Hybrid
from golden.networks.learning_engine import LearningEngine
from golden.networks.multiple import Multiple
from golden.networks.network import Network
from golden.networks.parallel import Parallel
from golden.networks.table_graph import TableGraph
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import SIGNAL
from golden.trained.function import Function
from tactus.scene.disturbance import expected_drift
from tactus.scene.image import hardware_of, scene_image
from tactus.scene.scene import Scene


class Words:
    """The description while it grows: `add` gives the number of the new word."""

    def __init__(self, samples: int):
        self.samples, self.words = samples, list[dict[str, Any]]()
        self.tables: dict[str, dict[str, Any]] = {}
        # Network, layer and node of the words that are added.
        self.place = [-1, 0, 0]

    def begin(self) -> None:
        """What follows is the next network."""
        self.place = [self.place[0] + 1, 0, 0]

    def at(self, layer: int, node: int) -> "Words":
        self.place = [self.place[0], layer, node]
        return self

    def add(self, **word: Any) -> int:
        self.words.append({**word, "place": self.place})
        return self.samples + len(self.words) - 1

    def values(self, fmt: Fix, function: Callable[[Codes], Codes], of: int) -> int:
        """Look up the values of a function of the codes of a format."""
        values = [int(v) for v in function(np.arange(fmt.low, fmt.high + 1))]
        return self._look_up("table", {"first": fmt.low, "values": values}, of)

    def _look_up(self, name: str, table: dict[str, Any], of: int) -> int:
        found = next((n for n, t in self.tables.items() if t == table), "")
        if not found:
            found = f"{len(self.tables)}: {name}"
            self.tables[found] = table
        return self.add(table=found, of=of)

    def lines(self, function: Function, segment: int, clipped: bool, of: int) -> int:
        table, kind = table_of(function, segment), "result" if clipped else "line"
        made = {
            "intercepts": [int(v) for v in table.intercepts],
            "slopes": [int(v) for v in table.slopes],
            "both": bool(table.both),
            "segment": segment,
            "shift": DROPPED,
            **({"clip": [RESULT.low, RESULT.high]} if clipped else {}),
        }
        return self._look_up(f"{function.name} {kind}", made, of)


def description(
    scene: Scene, theta: Sequence[int] = (), rig: Scene | None = None
) -> dict[str, Any]:
    """What `network.py` reads, with ports and clocks that the hardware publishes.

    theta: What is put into an engine that learns before the frames, in the codes of its ports.
    rig: The scene whose hardware runs the image of this one, if that is another one.
    """
    top = (rig or scene).twin()
    built, whole = top.core, scene.twin(lean=False).core
    if rig:
        built = hardware_of(rig).running(scene_image(scene, hardware_of(rig)))
    if built.stream not in ("serial", "words"):
        raise InputError(f"{scene.name}: every frame is not proved yet for {built.entity}")
    words, outputs = Words(built.inputs), list[int]()
    before, said = list[dict[str, Any]](), ""
    if theta and (rig or not isinstance(whole, LearningEngine)):
        raise InputError(f"{scene.name}: got theta, expected an engine that learns")
    if rig:
        met, width = scene.settings().met, hardware_of(rig).program.segment_width
        integers = integer_networks(scene.arrangement, scene.networks(), met, width)
        outputs = _engine(integers, words, _inputs(words))
    elif isinstance(whole, LearningEngine):
        said, whole = ", learn and target_valid low", whole.engine
        if theta:
            said += f" behind theta {', '.join(map(str, theta))}"
            one = {"data": [0] * built.inputs, "clocks": built.interval}
            codes = {"data": [code & (1 << SIGNAL.width) - 1 for code in theta]}
            before = [{"name": "in", **one}, {**one, "name": "target", **codes}]
            before[1]["beside"] = {"target_theta": 1}
            taught = Corrected.of(scene.mlps(), *expected_drift(scene))
            outputs = _engine(whole.integers, words, _corrected(taught, theta, words))
    outputs = outputs or of(whole, words, list(range(built.inputs)))
    if built.image:
        said = ", its image loaded between frames in one piece, once or again"
        before = [{"name": "load", "data": list(built.image), "clocks": 0}]
    if top.entity != built.entity:
        said += f" inside {top.entity}, which is not proved"
    others = [p for p in (*built.load_ports, *built.lesson_ports) if p.direction == "in"]
    return {
        "scene": scene.name,
        "entity": built.entity,
        "around": said,
        "before": before,
        # Inputs besides those of frames, with their bits, and those that stay 0 during frames.
        "ports": {p.name: p.width for p in others},
        "still": [p.name for p in others if p.name in ("load_valid", "target_valid", "learn")],
        "stream": built.stream,
        "samples": built.inputs,
        "elements": built.input_controller.inputs if built.stream == "serial" else 1,
        "bits": SIGNAL.width,
        "interval": built.interval,
        "output_clocks": list(built.output_clocks),
        "tables": words.tables,
        "words": words.words,
        "outputs": outputs,
    }


@singledispatch
def of(network: Network, words: Words, samples: list[int]) -> list[int]:
    """The words of the outputs."""
    raise InputError(f"{network.entity}: every frame is not proved yet for this design")


@of.register
def _(network: Engine, words: Words, samples: list[int]) -> list[int]:
    return _engine(network.integers, words, _inputs(words))


def _inputs(words: Words) -> list[int]:
    return [words.add(sum=[[k, 1]], left=SAMPLE_SHIFT) for k in range(words.samples)]


def _corrected(taught: Corrected, theta: Sequence[int], words: Words) -> list[int]:
    """z = x + x g + o of each sensor, as a word of an engine."""
    word, one = Fix(WIDTH, 0), 1 << DROPPED
    units = [int(u) for u in (*taught.gains, *taught.offsets)]
    if len(theta) != len(units):
        raise InputError(f"theta: got {len(theta)} elements, expected {len(units)}")
    products = [(t << OUTPUT_SHIFT) * u for t, u in zip(theta, units, strict=True)]
    learned = [min(max(p + one // 2 >> DROPPED, word.low), word.high) for p in products]
    return [
        words.add(
            sum=[[k, (one << SAMPLE_SHIFT) + learned[k]]],
            start=learned[taught.sensors + k] * one,
            shift=DROPPED,
            round="up",
            clip=[word.low, word.high],
        )
        for k in range(taught.sensors)
    ]


def _engine(networks: Sequence[IntegerNetwork], words: Words, inputs: list[int]) -> list[int]:
    outputs: list[int] = []
    for integers in networks:
        taken = [*inputs[: integers.samples], *outputs[: integers.earlier]]
        outputs += _integer(integers, words, taken)
    results = []
    for k in outputs:
        words.place = words.words[k - words.samples]["place"]
        results.append(words.add(sum=[[k, 1]], shift=OUTPUT_SHIFT))
    return results


def _integer(network: IntegerNetwork, words: Words, now: list[int]) -> list[int]:
    words.begin()
    for n, layer in enumerate(network.layers):
        following = []
        for j in range(layer.nodes):
            code = _node(network, layer, j, words.at(n, j), now)
            following.append(code)
            if layer.leaky:
                following.append(words.add(sum=[[code, 1]], clip=[0, RESULT.high]))
            elif layer.functions:
                following[-1] = words.lines(layer.functions[j], network.segment_width, True, code)
        now = following
    return now


def _node(
    network: IntegerNetwork, layer: IntegerLayer, j: int, words: Words, now: list[int]
) -> int:
    terms = [[k, int(w)] for k, w in zip(now, layer.weights[j], strict=True) if w]
    for k, function in layer.added_to(j):
        terms.append([words.lines(function, network.segment_width, False, now[k]), 1])
    return words.add(
        sum=terms,
        start=int(layer.starts[j]),
        shift=layer.shift,
        round=layer.rounding.name.lower(),
        clip=[int(layer.low), int(layer.high)],
        left=layer.cut,
    )


def _sum(node: tuple[Any, ...], words: Words, now: list[int]) -> int:
    """A node of `golden.layers.weighted_sum`: products lose their lowest bits one by one, then
    factor and rounding."""
    layer, weights, bias, factor = node
    products = [[k, int(w)] for k, w in zip(now, weights, strict=True) if w]
    if layer.product_shift:
        products = [[words.add(sum=[one], shift=layer.product_shift), 1] for one in products]
    return words.add(
        sum=[[k, w * factor] for k, w in products],
        start=(int(bias) << layer.bias_shift) * factor,
        shift=layer.out_shift,
        round="up",
        clip=[layer.out_fmt.low, layer.out_fmt.high],
    )


@of.register(Hybrid)
@of.register(Parallel)
def _(network: Any, words: Words, samples: list[int]) -> list[int]:
    nodes: list[list[tuple[Any, ...]]]
    if isinstance(network, Parallel):
        layers = network.hidden_neurons, network.output_neurons
        nodes = [[(n, n.weights, n.bias, n.factor or 1) for n in layer] for layer in layers]
    else:
        last = network.output_integral
        factors = (1,) * len(network.activations), last.factors or (1,) * last.outputs
        both = zip((network.input_integral, last), factors, strict=True)
        nodes = [
            [(one, *node) for node in zip(one.weights, one.biases, f, strict=True)]
            for one, f in both
        ]
    words.begin()
    hidden = enumerate(zip(nodes[0], network.activations, strict=True))
    now = [
        words.values(a.in_fmt, a.process, _sum(node, words.at(0, j), samples))
        for j, (node, a) in hidden
    ]
    return [_sum(node, words.at(1, j), now) for j, node in enumerate(nodes[1])]


@of.register
def _(network: Multiple, words: Words, samples: list[int]) -> list[int]:
    return [y for one in network.networks for y in of(one, words, samples)]


@of.register
def _(network: Cascade, words: Words, samples: list[int]) -> list[int]:
    outputs: list[int] = []
    for one in network.networks:
        outputs += of(one, words, [*samples, *outputs])
    return outputs


@of.register
def _(network: AdderGraph, words: Words, samples: list[int]) -> list[int]:
    now = samples
    words.begin()
    for n, matrix in enumerate(network.layers):
        now = _matrix(matrix, words, now, n)
        tables = network.activations[n] if n < len(network.activations) else ()
        if tables:
            nodes = zip(tables, now, strict=True)
            now = [words.at(n, j).values(t.in_fmt, t.process, q) for j, (t, q) in enumerate(nodes)]
    return now


@of.register
def _(network: TableGraph, words: Words, samples: list[int]) -> list[int]:
    fmt = network.sample_fmt
    words.begin()
    now = [words.add(sum=[[k, 1]], shift=SIGNAL.width - fmt.width) for k in samples]
    parts = (
        (network.first, network.hidden, fmt),
        (network.second, network.output, network.hidden.out_fmt),
    )
    for n, (tables, matrix, form) in enumerate(parts):
        words.at(n, 0)
        read = [words.values(form, partial(t.process, fmt=form), now[t.source]) for t in tables]
        now = _matrix(matrix, words, read, n)
    return now


def _matrix(matrix: ConstantMatrix, words: Words, samples: list[int], layer: int) -> list[int]:
    """The sums of a graph of adders, with the bits that each operand loses.

    What several rows share counts as part of the first.
    """
    words.at(layer, 0)
    graph, found = matrix.graph, list[Any]()
    for place, node in enumerate(graph.nodes):
        if isinstance(node, Input):
            found.append(samples[node.number])
        elif isinstance(node, Constant):
            found.append(words.add(sum=[], start=int(node.value)))
        else:
            terms = []
            for operand, step in zip(node.operands, graph.steps(place), strict=True):
                k = found[operand.node]
                if step.cut:
                    k = words.add(sum=[[k, 1]], shift=step.cut)
                terms.append([k, operand.sign << step.move])
            found.append(words.add(sum=terms))
    results = []
    finished = zip(graph.rows, matrix.row_finishes, matrix.result_lows, strict=True)
    for j, (row, finish, low) in enumerate(finished):
        words.at(layer, j)
        drop, clip = matrix.drop(row), [int(low), int(matrix.out_fmt.high)]
        sign, start = (-1, -1) if row.minus else (1, 0)
        node, up, word = found[row.node], max(0, -drop), dict[str, Any]()
        if finish.even:
            # Half a unit is part of the sum, and halves go to the even result.
            start -= 1 << drop - 1
            word = {"sum": [[node, sign]], "start": start, "shift": drop, "round": "even"}
        else:
            word = {"sum": [[node, sign << up]], "start": start << up, "shift": max(0, drop)}
        results.append(words.add(**word, clip=clip))
    return results
