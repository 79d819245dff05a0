"""The section ``[training]`` of a scene: its keys, and what they rule out elsewhere."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from golden.numbers.precision import PRECISIONS
from golden.trained.dense import ACTIVATIONS
from tactus.core.schema import Alternatives, Flag, Key, KeyTable, List, Number, Span, Text, Whole
from tactus.network_files.parsed import file_of
from tactus.scene.disturbance import MOST, Disturbance
from tactus.scene.network import MOST_HIDDEN, listed

FEWEST = "fewest"
# By which part of its error digits = "fewest" may increase the error of an output.
DIGITS_TOLERANCE = 0.02
# The numbers of intervals of splines that a search tries if the scene names none.
INTERVALS = [2, 4]
# More hidden layers than any network that the hardware was made for.
MOST_LAYERS = 8


def _ends(what: str, example: str, least: int, most: int) -> List:
    """A list of the least and the largest number of something that a search tries."""
    return List(
        Whole(Span(least, most)),
        f"the least and the largest number of {what}, such as {example}, {most} at most",
        "a list of whole numbers",
        least=2,
        most=2,
        rising=True,
    )


_DISTURBANCE = Number(Span(0, MOST), f"a number from 0 to {MOST:g}")
_DRIFT = {
    "gain": Key(
        _DISTURBANCE, 0.0, "The standard deviation of a sensor's gain, as a part of the gain."
    ),
    "offset": Key(
        _DISTURBANCE,
        0.0,
        "The standard deviation of a sensor's offset, in the unit of the sensor columns.",
    ),
}
TRAINING = KeyTable(
    {
        "optimiser": Key(
            Text(("levenberg-marquardt", "scg")),
            "levenberg-marquardt",
            "The optimiser of each descent: `levenberg-marquardt`, or `scg`, the scaled conjugate "
            "gradient of the thesis.",
        ),
        "hidden": Key(
            _ends("hidden nodes", "[4, 25]", 1, MOST_HIDDEN),
            [4, 25],
            "The least and the largest number of hidden nodes to search, if `network.hidden` is 0. "
            "With `layers`, these are the nodes of each hidden layer.",
        ),
        "layers": Key(
            _ends("hidden layers", "[1, 3]", 0, MOST_LAYERS),
            None,
            "The least and the largest number of hidden layers to search. The arrangement must be "
            "`single` and `network.hidden` 0. See [a search for the layers]"
            "(networks.md#a-search-for-the-layers).",
            "none",
        ),
        "activation": Key(
            Text(tuple(ACTIVATIONS)),
            "tanh",
            "Only with `layers`: the activation of every hidden layer.",
        ),
        "functions": Key(
            Text(("spline",)),
            "",
            "`spline` trains [networks of learned functions](learned-functions.md) in the place of "
            "networks of tanh: `hidden` is then the number of hidden sums. The design must be "
            "`engine` or `table_graph`, and the weights are NPZ files. A scene with `data.classes` "
            "may have them too.",
            "none",
        ),
        "intervals": Key(
            List(
                Whole(Span(0, 32)), "whole numbers from 0 to 32", "a list of whole numbers", least=1
            ),
            None,
            "Only with `functions`: the numbers of intervals that the splines of an input may "
            "have. Each is tried. With 0, the functions of inputs are straight lines.",
            str(INTERVALS),
        ),
        "seed": Key(
            Whole(Span(0)),
            1,
            "The seed of all random choices: the split of the rows, the first weights, noise and "
            "drift.",
        ),
        "restarts": Key(
            Whole(Span(above=0, most=100_000)),
            8,
            "How many random starts are tried for each number of hidden nodes.",
        ),
        "weight_decay": Key(
            Number(Span(0)),
            1e-4,
            "A penalty on large weights. It keeps the weights small, and with them Q_j and Y_i.",
            "1e-4",
        ),
        "steps": Key(
            Whole(Span(above=0, most=1_000_000)),
            200,
            "The most evaluations of a descent. A candidate takes two descents, or one if the "
            "activation is tanh itself.",
        ),
        "patience": Key(
            Whole(Span(above=0)),
            40,
            "When a descent ends early. The points that count are those whose training error is "
            "less than that of every point before. After so many of them in a row without a lower "
            "validation error, the descent ends.",
        ),
        "earlier_outputs": Key(
            Text(("bit-true", "float")),
            "bit-true",
            "Which outputs of earlier networks a network of a cascade is trained on: those of the "
            "hardware (`bit-true`, cascade B of the thesis) or those in floating point (`float`, "
            "cascade A).",
        ),
        "split": Key(
            Text(("random", "blocks", "groups")),
            "random",
            "Which rows are held out: `random` rows, `blocks` of neighbours, or whole `groups`. "
            "See [which rows are held out](networks.md#which-rows-are-held-out).",
        ),
        "split_by": Key(
            List(Text(some=True), "columns, each once", "a list of texts", once=True),
            [],
            "Columns of numbers or texts. Rows with the same values in these columns "
            "are a group, and "
            "no block continues where one of the values changes. `groups` needs this key.",
        ),
        "block_rows": Key(Whole(Span(above=0)), 5, "About how many rows a block has."),
        "refit": Key(
            Flag(),
            False,
            "With `true` the training of the chosen network [continues after the "
            "search](networks.md#trained-on-after-the-search), with all rows.",
        ),
        "digits": Key(
            Alternatives((Whole(), Text((FEWEST,), said=f"a whole number or {FEWEST!r}"))),
            0,
            "How many signed digits all weights of a network may have together; biases do not "
            "count. It must exceed the number of outputs of a network for numbers; "
            f'`"{FEWEST}"` finds the least. 0 leaves the weights as they are. The precision must '
            "be `exact`. See [weights of few digits](networks.md#weights-of-few-digits).",
        ),
        "digits_tolerance": Key(
            Number(Span(0)),
            DIGITS_TOLERANCE,
            f'Only with `"{FEWEST}"`. By which part of itself the error of an output may grow on '
            "the validation rows.",
        ),
        "noise": Key(
            _DISTURBANCE,
            0.0,
            "The standard deviation of the noise that is expected on every reading. Its unit is "
            "that of the sensor columns, with or without `data.scale`. See [what the sensors are "
            "expected to do](networks.md#what-the-sensors-are-expected-to-do).",
        ),
        "drift": Key(
            KeyTable(_DRIFT, noun=""),
            {},
            "How far the sensors are expected to drift, such as `{ gain = 0.01, offset = 0.005 }`: "
            "the standard deviation of a sensor's gain, as a part of the gain, and that of its "
            "offset, in the unit of the sensor columns. Each is from 0 to 100, and 0 if it is left "
            "out.",
        ),
    },
    name="a section",
)


@dataclass(frozen=True)
class Training:
    """How a scene's networks are trained: the keys of ``TRAINING``; see ``tactus.train``.

    layers: Empty where training does not search for them.
    disturbance: ``noise`` and ``drift``.
    """

    optimiser: str
    hidden: tuple[int, int]
    layers: tuple[int, ...]
    activation: str
    functions: str
    intervals: tuple[int, ...]
    seed: int
    restarts: int
    weight_decay: float
    steps: int
    patience: int
    earlier_outputs: str
    split: str
    split_by: tuple[str, ...]
    block_rows: int
    refit: bool
    digits: int | str
    digits_tolerance: float
    disturbance: Disturbance


def training(scene: dict[str, dict[str, Any]], path: Path) -> Training:
    check_digits(scene, path)
    check_search(scene, path)
    check_functions(scene, path)
    values = scene["training"]
    kept = {key: values[key] for key in values if key not in ("noise", "drift")}
    read = {
        "hidden": tuple(values["hidden"]),
        "layers": tuple(values.get("layers", ())),
        "intervals": tuple(values.get("intervals", INTERVALS)),
        "split_by": _split_by(values, path),
        "disturbance": Disturbance(values["noise"], **values["drift"]),
    }
    return Training(**(kept | read))


def _split_by(values: dict[str, Any], path: Path) -> tuple[str, ...]:
    names, split = values["split_by"], values["split"]
    if names and split == "random":
        raise InputError(
            f"{path}: training.split_by: got {names!r} with split 'random', expected 'blocks' or "
            "'groups'"
        )
    if split == "groups" and not names:
        raise InputError(
            f"{path}: training.split_by: got none with split 'groups', expected the columns whose "
            "values are held out together"
        )
    return tuple(names)


def check_search(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse a search for the hidden layers of a network whose layers are fixed otherwise."""
    training, network = values["training"], values["network"]
    layers, place = training.get("layers"), f"{path}: training.layers"
    if layers is None:
        if training["activation"] != "tanh":
            raise InputError(
                f"{path}: training.activation: got {training['activation']!r} without layers, "
                "expected training.layers, or network.hidden and network.activations instead"
            )
        return
    if network["arrangement"] != "single":
        raise InputError(
            f"{place}: got {layers} with arrangement {network['arrangement']!r}, expected 'single'"
        )
    if network["hidden"] != 0:
        raise InputError(
            f"{place}: got {layers} with network.hidden {network['hidden']}, expected "
            "network.hidden 0, because training chooses the nodes of each layer"
        )
    if network["activations"]:
        raise InputError(
            f"{place}: got {layers} with network.activations {network['activations']}, expected "
            "training.activation instead, which is that of every layer"
        )


def check_functions(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse networks of learned functions in a scene that cannot train or keep them."""
    training, network = values["training"], values["network"]
    place = f"{path}: training.functions: got {training['functions']!r}"
    if not training["functions"]:
        if "intervals" in training:
            raise InputError(
                f"{path}: training.intervals: got {training['intervals']} without "
                "training.functions, expected functions = 'spline', or no such key"
            )
        return
    for key in ("layers", "digits"):
        if training.get(key):
            raise InputError(f"{place} with training.{key}, expected one of them")
    if training["optimiser"] == "scg":
        raise InputError(f"{place} with training.optimiser 'scg', expected levenberg-marquardt")
    if network["activations"]:
        raise InputError(f"{place} with network.activations, expected none: functions are learned")
    others = [w for w in listed(network["weights"]) if file_of(Path(w)).suffix != ".npz"]
    if others:
        raise InputError(f"{place} with network.weights {others[0]!r}, expected an NPZ file")


def check_digits(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse a number of signed digits that no network of the scene can have."""
    digits, tolerance = (values["training"][key] for key in ("digits", "digits_tolerance"))
    place, fewest = f"{path}: training.digits", digits == FEWEST
    if tolerance != DIGITS_TOLERANCE and not fewest:
        raise InputError(
            f"{place}_tolerance: got {tolerance!r} with digits {digits!r}, expected digits 'fewest'"
        )
    if digits == 0:
        return
    precision = values["hardware"]["precision"]
    if PRECISIONS[precision].normalise:
        raise InputError(
            f"{place}: got {digits!r} with precision {precision!r}, which gives normalised weights "
            "digits of their own, expected 'exact'"
        )
    single = values["network"]["arrangement"] == "single"
    outputs = len(values["data"]["outputs"]) if single else 1
    if not fewest and digits <= outputs:
        raise InputError(
            f"{place}: got {digits}, expected at least {outputs + 1}: one for each output of a "
            "network and one for a hidden node"
        )
