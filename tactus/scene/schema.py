"""Everything that a scene may hold: its sections and their keys."""

from pathlib import Path

from golden.networks.arrangement import ARRANGEMENTS
from golden.numbers.expression import ALLOWED
from golden.trained.dense import ACTIVATIONS
from golden.trained.function import TABLE
from tactus.core.schema import (
    Alternatives,
    Each,
    Flag,
    Key,
    KeyTable,
    List,
    Map,
    Number,
    Span,
    Text,
    Whole,
)
from tactus.scene.data_keys import DATA
from tactus.scene.disturbance import MOST
from tactus.scene.front_end import FRONT_END
from tactus.scene.hardware_keys import HARDWARE
from tactus.scene.uart import UART
from tactus.scene.visualisation import VISUALISATION

# The schema of SCENE for an editor, which finds it by the first line of a file that make scene has
# written. ``make pages`` writes it.
EDITOR_SCHEMA = Path(__file__).with_name("scene.schema.json")
FEWEST = "fewest"
# By which part of its error digits = "fewest" may increase the error of an output.
DIGITS_TOLERANCE = 0.02
# The numbers of intervals of splines that a search tries if the scene names none.
INTERVALS = [2, 4]
# More hidden layers than any network that the hardware was made for.
MOST_LAYERS = 8
# An engine's operand memory has so many words.
MOST_HIDDEN = 1024

_FUNCTION = (
    "an expression of x, points { x = [...], y = [...] }, or the file of such, "
    '{ points = "file.csv" }'
)
_PLACES = List(Number(finite=True), "two or more numbers", "a list of numbers", least=2)
_POINTS = {
    "x": Key(_PLACES, None, "Where the points lie, from left to right."),
    "y": Key(_PLACES, None, "The value at each point."),
    "points": Key(Text(some=True), None, "Instead: a CSV file with the columns x and y."),
}
NETWORK = KeyTable(
    {
        "arrangement": Key(
            Text(ARRANGEMENTS),
            meaning="`single` has one network for all outputs. `multiple` has one network for each "
            "output. `cascade` has one for each output too, and each network also gets the outputs "
            "of the networks before it.",
        ),
        "hidden": Key(
            Each(Whole(Span(0, MOST_HIDDEN))),
            0,
            "The number of hidden nodes. 0 means as many as the network file has, in as many "
            "layers; training then searches the range `training.hidden` and, where it is given, "
            "`training.layers`. For `classes` without `training.layers` it trains a network "
            "without a hidden layer. With `single`, a list has the number of nodes of "
            "each hidden layer, such as `[32, 16]`: [networks of several "
            "layers](networks.md#networks-of-several-layers).",
        ),
        "activations": Key(
            List(
                Text(tuple(ACTIVATIONS), begins=TABLE),
                "a list with an activation for each hidden layer",
                "a list of texts",
            ),
            [],
            'Of `single`: the activation of each hidden layer, such as `["relu", "relu"]`. Without '
            "it, the activations are those of the network file, and training takes "
            "`training.activation`. "
            f'`"{TABLE}"` and a name of `functions` is [a function of your own]'
            "(networks.md#functions-of-your-own).",
        ),
        "functions": Key(
            Map(Alternatives((Text(some=True), KeyTable(_POINTS, said=_FUNCTION)), _FUNCTION)),
            {},
            "Functions of x that `activations`, or those of the network file, can name. Each is an "
            "expression, points `{ x = , y = }`, or `{ points = }` with the name of a CSV file "
            f"whose columns x and y are the points. An expression holds {ALLOWED}.",
        ),
        "quantised": Key(
            Text(("exact", "nearest")),
            "exact",
            "Of a [quantised network](networks.md#quantised-networks): whether its codes must be "
            "those of its file, or may come from the nearest weights that the engine holds.",
        ),
        "weights": Key(
            Each(Text()),
            meaning="The files of the trained networks, `.npz`, `.mat` or `.onnx`, in the order of "
            "the outputs. `make train` writes them.",
        ),
    },
    name="a section",
)


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
SCENE = KeyTable(
    {
        "data": Key(DATA, {}, "Which recordings, sensors and outputs the scene has."),
        "network": Key(
            NETWORK, {}, "How many networks there are, of which size, and in which files."
        ),
        "hardware": Key(HARDWARE, {}, "In which form of hardware the networks are built."),
        "training": Key(TRAINING, {}, "How the networks are trained."),
        "front_end": Key(
            FRONT_END,
            None,
            "How the sensors are read. Without this section samples arrive as a stream.",
        ),
        "visualisation": Key(VISUALISATION, None, "Adds a profile of the load to the outputs."),
        "uart": Key(UART, None, "Adds a serial line to a computer."),
    },
    noun="section ",
)
