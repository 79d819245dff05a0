"""What a scene may hold: every section with its keys."""

from __future__ import annotations

from pathlib import Path

from golden.dense import ACTIVATIONS
from golden.disturbance import MOST
from golden.networks.arrangement import ARRANGEMENTS
from golden.scene.data_keys import DATA
from golden.scene.front_end import FRONT_END
from golden.scene.hardware_keys import HARDWARE
from golden.scene.uart import UART
from golden.scene.visualisation import VISUALISATION
from golden.schema import Alternatives, Each, Flag, Key, List, Number, Span, Table, Text, Whole

# SCENE for an editor, which finds it by the first line of what make scene writes; ``make pages``
# writes it.
EDITOR_SCHEMA = Path(__file__).with_name("scene.schema.json")
FEWEST = "fewest"
# What digits = "fewest" lets an output err more, as a part of its error.
DIGITS_TOLERANCE = 0.02
# An engine's memory of operands has as many words.
MOST_HIDDEN = 1024

NETWORK = Table(
    {
        "arrangement": Key(
            Text(ARRANGEMENTS),
            meaning="`single`: one network for all outputs; `multiple`: one for each output; "
            "`cascade`: one for each output, which sees the sensors and the outputs before its own",
        ),
        "hidden": Key(
            Each(Whole(Span(0, MOST_HIDDEN))),
            0,
            "hidden nodes; 0 takes as many as the network file has, in as many layers, and "
            "training searches `training.hidden`. With `single` a list has the nodes of each "
            "hidden layer, such as `[32, 16]`: [networks of several "
            "layers](#networks-of-several-layers)",
        ),
        "activations": Key(
            List(
                Text(tuple(ACTIVATIONS)),
                "a list with an activation for each hidden layer",
                "a list of texts",
                least=0,
            ),
            [],
            'of `single`: the activation of each hidden layer, such as `["relu", "relu"]`; '
            "without it those of the network file, and training takes tanh",
        ),
        "weights": Key(
            Each(Text()),
            meaning="files of the trained networks, `.npz`, `.mat` or `.onnx`, in the order of the "
            "outputs; `make train` writes them",
        ),
    },
    name="a section",
)
_DISTURBANCE = Number(Span(0, MOST), f"a number from 0 to {MOST:g}")
_DRIFT = {
    "gain": Key(_DISTURBANCE, 0.0, "of a sensor's gain, as a part of it"),
    "offset": Key(_DISTURBANCE, 0.0, "of a sensor's offset, in the unit of the sensor columns"),
}
TRAINING = Table(
    {
        "optimiser": Key(
            Text(("levenberg-marquardt", "scg")),
            "levenberg-marquardt",
            "or `scg`, the scaled conjugate gradient of the thesis",
        ),
        "hidden": Key(
            List(
                Whole(Span(1, MOST_HIDDEN)),
                "the least and the largest number of hidden nodes, such as [4, 25], "
                f"{MOST_HIDDEN} at most",
                least=2,
                most=2,
                rising=True,
            ),
            [4, 25],
            "least and largest number of hidden nodes to search, where `network.hidden` is 0",
        ),
        "seed": Key(
            Whole(Span(0)), 1, "splits the rows, starts the weights and draws noise and drift"
        ),
        "restarts": Key(
            Whole(Span(above=0, most=100_000)), 8, "random starts for each number of hidden nodes"
        ),
        "weight_decay": Key(
            Number(Span(0)), 1e-4, "keeps weights small, and with them Q_j and Y_i", "1e-4"
        ),
        "steps": Key(
            Whole(Span(above=0, most=1_000_000)),
            200,
            "most evaluations of each descent; there are two per candidate, one where the "
            "activation is tanh itself",
        ),
        "patience": Key(
            Whole(Span(above=0)),
            40,
            "a descent ends early when so many points in a row, each with less training error than "
            "any before, have not lowered the validation error",
        ),
        "earlier_outputs": Key(
            Text(("bit-true", "float")),
            "bit-true",
            "what a network of a cascade trains on: the outputs of the networks before it as the "
            "hardware gives them (`bit-true`, the thesis' cascade B) or in floating point "
            "(`float`, cascade A)",
        ),
        "split": Key(
            Text(("random", "blocks", "groups")),
            "random",
            "which rows are held out: `random` ones, `blocks` of neighbours, or whole `groups`, "
            "see [which rows are held out](#which-rows-are-held-out)",
        ),
        "split_by": Key(
            List(Text(), "columns, each once", "a list of texts", least=0, once=True),
            [],
            "columns of `data.file`: rows with the same values in them are a group, and no block "
            "reaches over a change of one; needed for `groups`",
        ),
        "block_rows": Key(Whole(Span(above=0)), 5, "rows of a block, about"),
        "refit": Key(
            Flag(),
            False,
            "after the search the chosen network is [trained "
            "on](#trained-on-after-the-search), with all rows",
        ),
        "digits": Key(
            Alternatives((Whole(), Text((FEWEST,), said=f"a whole number or {FEWEST!r}"))),
            0,
            "signed digits that all weights of a network may have together, biases not counted, or "
            f'`"{FEWEST}"`: [weights of few digits](#weights-of-few-digits). At least one '
            "more than the network has outputs; 0 leaves the weights as they are. For `exact` "
            "precision",
        ),
        "digits_tolerance": Key(
            Number(Span(0)),
            DIGITS_TOLERANCE,
            f'of `"{FEWEST}"` alone: what the error of an output may grow by on the validation '
            "rows, as a part of it",
        ),
        "noise": Key(
            _DISTURBANCE,
            0.0,
            "standard deviation of the noise that is expected on every reading, in the unit of the "
            "sensor columns, with or without `data.scale`; see [what the sensors are expected to "
            "do](#what-the-sensors-are-expected-to-do)",
        ),
        "drift": Key(
            Table(_DRIFT, noun=""),
            {},
            "`{ gain = 0.01, offset = 0.005 }`, each 0 to 100 and 0 where it is left out: standard "
            "deviations of what a sensor's gain, as a part of it, and its offset, in the unit of "
            "the sensor columns, will be off",
        ),
    },
    name="a section",
)
SCENE = Table(
    {
        "data": Key(DATA, {}, "which recordings, sensors and outputs"),
        "network": Key(NETWORK, {}, "how many networks, of which size, and where they are"),
        "hardware": Key(HARDWARE, {}, "in which form of hardware"),
        "training": Key(TRAINING, {}, "how the networks are trained"),
        "front_end": Key(FRONT_END, None, "how the sensors are read; without it from a stream"),
        "visualisation": Key(VISUALISATION, None, "a profile of the load beside the outputs"),
        "uart": Key(UART, None, "a serial line to a computer"),
    },
    noun="section ",
)
