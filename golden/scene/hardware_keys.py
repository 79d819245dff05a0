"""The keys of a scene's section ``[hardware]``."""

from __future__ import annotations

from golden.activation.schemes import SCHEMES
from golden.networks.designs import DESIGNS
from golden.precision import PRECISIONS
from golden.schema import Anything, Flag, Key, Map, Number, Span, Table, Text, Whole

HARDWARE = Table(
    {
        "design": Key(
            Text(tuple(DESIGNS)),
            meaning="[engine](blocks/engine.md): one multiplier and a program, in any arrangement, "
            "for `exact` precision and the activation `precise`; [hybrid](blocks/hybrid.md): "
            "folded over inputs and outputs; [parallel](blocks/parallel.md): every multiplication "
            "at once, for `single` alone; [adder_graph](blocks/adder_graph.md): a frame a clock "
            "without a multiplier, for `single` and `multiple`, `exact` precision and the "
            "activation `bipartite`",
        ),
        "activation": Key(
            Text(tuple(SCHEMES)),
            "",
            "[gradient](blocks/gradient.md), [gradient_parallel](blocks/gradient_parallel.md), "
            "[lut](blocks/lut.md), [pade](blocks/pade.md), [polynomial](blocks/polynomial.md), "
            "[precise](blocks/precise.md), which needs `exact` precision, or "
            "[bipartite](blocks/bipartite.md), which needs the design `adder_graph` too",
            "`precise` in `exact` precision, `gradient` in `thesis`",
        ),
        "activation_options": Key(
            Map(Anything()),
            {},
            "what the activation leaves open: `{ rho = 4.5, iterations = 32 }` for `pade`, "
            '`{ coefficients = "logic" }` or `"block_ram"` for `precise`, '
            '`{ memory = "block_ram" }` or `"logic"` for `bipartite`, nothing for the others',
        ),
        "precision": Key(
            Text(tuple(PRECISIONS)),
            meaning="`thesis` or `exact`, see [formats](formats.md#the-two-precisions)",
        ),
        "clock_mhz": Key(
            Number(Span(0.001, 10_000.0)),
            64.0,
            "turns clocks into times in the report of `make demo`, and is the period in the "
            "exported [ise.ucf](handover.md#constraints)",
        ),
        "interface": Key(
            Text(("stream", "axi_stream")),
            "stream",
            "`stream`: the ports of the network; `axi_stream`: the same behind AXI4-Stream with "
            "back-pressure, [axis_network](blocks/axis_network.md), for `engine` and `hybrid` "
            "without front end and visualisation",
        ),
        "multiplier": Key(
            Text(("dsp", "serial")),
            "",
            "of `engine` alone: `serial` does [without a "
            "multiplier](blocks/engine.md#without-a-multiplier), at ten times the clocks; its "
            "results are the same",
            "`dsp`",
        ),
        "pipeline": Key(
            Text(("short", "deep")),
            "",
            "of `engine` alone: `deep` puts a register behind each of its memories, for faster "
            "clocks; its frames take some clocks more",
            "`short`",
        ),
        "segment_width": Key(
            Whole(absent=True),
            0,
            "of `engine` alone: 9, 8 or 7 bits of a hidden sum within a [segment of "
            "tanh](blocks/engine.md#numeric-behaviour); fewer err less and take more words",
            "9",
        ),
        "clocks": Key(
            Whole(absent=True),
            0,
            "of `engine` alone: clocks from the last sample to the last output that a frame may "
            "take. The smallest hardware that keeps to them is taken, without a multiplier where "
            "there is time for it, and printed by `make vhdl` and `make demo`",
            "what a front end leaves",
        ),
        "reload": Key(
            Flag(),
            False,
            "of `engine`: the program is no part of the hardware but an image that is loaded, "
            "[image_loader](blocks/image_loader.md); the hardware then depends on the two keys "
            "below, `segment_width` and `pipeline` alone. Without front end, visualisation and "
            "`axi_stream`, but for a scene with a section [uart](#uart), which has a line "
            "to load it",
        ),
        "program_words": Key(
            Whole(absent=True),
            0,
            "with `reload`: words of the program memory, a power of two",
            "512",
        ),
        "operand_words": Key(
            Whole(absent=True),
            0,
            "with `reload`: words of the operand memory, a power of two",
            "128",
        ),
        "adders_per_clock": Key(
            Whole(absent=True),
            0,
            "of `adder_graph` alone: adders one behind the other between two registers; fewer make "
            "the clock faster and the latency longer",
            "5",
        ),
    },
    name="a section",
)
