"""The section ``[hardware]`` of a scene: its keys, and which of them go together."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from golden.activation.schemes import SCHEMES
from golden.input_error import InputError
from golden.networks.design import Design
from golden.networks.designs import DESIGNS
from golden.networks.engine import Engine
from golden.numbers.precision import EXACT, PRECISIONS
from tactus.core.schema import (
    Anything,
    Flag,
    Key,
    KeyTable,
    Map,
    Number,
    Span,
    Text,
    Whole,
    written,
)
from tactus.scene.data import read_window
from tactus.sizing.choice import DEFAULT, DEVICES, UNDECIDED, Demand, Price, shares_of

_PRICE = Number(Span(0.0, 1e9))
HARDWARE = KeyTable(
    {
        "design": Key(
            Text((*DESIGNS, UNDECIDED)),
            meaning="How the networks are built. [engine](blocks/engine.md) has a program and one "
            "multiplier, or as many as `lanes` says; it takes any arrangement in `exact` precision "
            "with the activation `precise`. "
            "[hybrid](blocks/hybrid.md) is folded over inputs and outputs. "
            "[parallel](blocks/parallel.md) does every multiplication at once, and takes only the "
            "arrangement `single`. [adder_graph](blocks/adder_graph.md) takes a frame every clock "
            "and needs no multiplier; it takes networks of any depth as `single`, and one hidden "
            "layer of tanh as `multiple`, in `exact` precision with the activation `bipartite`. "
            "[table_graph](blocks/table_graph.md) does the same for networks of learned functions, "
            "which it looks up in small tables. "
            "`auto` is the smallest of them that is fast enough, see "
            "[designs](designs.md#the-smallest-that-is-fast-enough); in `thesis` precision that is "
            "`hybrid` or `parallel`, with the activation that the scene names.",
        ),
        "activation": Key(
            Text(tuple(SCHEMES)),
            "",
            "The approximation of tanh: [gradient](blocks/gradient.md), "
            "[gradient_parallel](blocks/gradient_parallel.md), [lut](blocks/lut.md), "
            "[pade](blocks/pade.md), [polynomial](blocks/polynomial.md), "
            "[precise](blocks/precise.md) or [bipartite](blocks/bipartite.md). `precise` and "
            "`bipartite` need `exact` precision, and `bipartite` needs the design `adder_graph` "
            "as well.",
            "`bipartite` with `adder_graph`; else `precise` in `exact` precision, `gradient` in "
            "`thesis`",
        ),
        "activation_options": Key(
            Map(Anything()),
            {},
            "The options of the activation. `pade` has `{ rho = 4.5, iterations = 32 }`. "
            '`precise` has `{ coefficients = "logic" }` or `"block_ram"`. `bipartite` has '
            '`{ memory = "block_ram" }` or `"logic"`. The other activations have none.',
        ),
        "precision": Key(
            Text(tuple(PRECISIONS)),
            meaning="The number formats and rounding, `thesis` or `exact`. See "
            "[formats](formats.md#the-two-precisions).",
        ),
        "clock_mhz": Key(
            Number(Span(0.001, 10_000.0)),
            64.0,
            "The frequency of the clock. The report of `make demo` turns clocks into times with "
            "it, and the exported [ise.ucf](handover.md#constraints) states its period.",
        ),
        "interface": Key(
            Text(("stream", "axi_stream")),
            "stream",
            "The ports of the top entity. `stream` gives it the ports of the network. `axi_stream` "
            "puts the network behind AXI4-Stream with back-pressure "
            "([axis_network](blocks/axis_network.md)), for `engine` and `hybrid` "
            "without front end and visualisation.",
        ),
        "argmax": Key(
            Flag(),
            False,
            "With `true` the top entity has the ports `winner_index`, `winner_margin` and "
            "`winner_valid` beside its stream of outputs: the number of the largest output, how "
            "far the second largest is below it, and when both are there "
            "([argmax](blocks/argmax.md)). This is the class that a network for classes decides "
            "for. It is for two outputs or more. `engine` and `hybrid` have it with any "
            "front end. `adder_graph` and `table_graph` give their outputs in one clock and have a "
            "tree ([adder_graph](blocks/adder_graph.md)). Behind `axi_stream` both "
            "numbers are `m_axis_tuser` of the last output "
            "([axis_network](blocks/axis_network.md)).",
        ),
        "lanes": Key(
            Whole(),
            None,
            "Only for `engine`. The number of multipliers, 1 to 16. The results are the same with "
            "any. More lanes take fewer clocks.",
            "1",
        ),
        "learning": Key(
            Text(("lms",)),
            "",
            "Only for `engine`, with a cascade or one network of one output. With `lms` the engine "
            "[learns gains and offsets of its sensors](blocks/learning_engine.md) from frames "
            "whose outputs are known. It has one multiplier and the pipeline `short`, no reload, "
            "no `axi_stream` and no `argmax`. A front end or a visualisation asks for a section "
            "`[uart]` too, through which the known outputs come.",
            "it does not learn",
        ),
        "pipeline": Key(
            Text(("short", "deep")),
            "",
            "Only for `engine`. `deep` puts registers behind its memories. The clock "
            "can then be faster, and a frame takes some clocks more.",
            "`short`",
        ),
        "segment_width": Key(
            Whole(absent=True),
            0,
            "Only for `engine`. The number of bits of a hidden sum, 9, 8 or 7, that "
            "lie within a [segment of tanh](blocks/engine.md#numeric-behaviour); 7 to 13 where "
            "every table is that of another function. With fewer bits the error is smaller and the "
            "table has more words.",
            "9",
        ),
        "clocks": Key(
            Whole(absent=True),
            0,
            "The most clocks that a frame may take from the last sample to the last output. With "
            "`auto` the smallest design within this limit is chosen. Any other design that takes "
            "more is refused.",
            "with `auto`, what a front end leaves; else no limit",
        ),
        "interval": Key(
            Whole(absent=True),
            0,
            "The most clocks from one frame to the next. A design that takes more is refused, and "
            "`auto` chooses another one.",
            "no limit",
        ),
        "frames_a_second": Key(
            Number(finite=True, absent=True),
            0.0,
            "The least number of frames a second, at the clock of `clock_mhz`: another way to "
            "give `interval`.",
            "no limit",
        ),
        "device": Key(
            Text(tuple(DEVICES)),
            "",
            "Only for `auto`. The device whose share is the price of a design.",
            f"`{DEFAULT}`",
        ),
        "prices": Key(
            KeyTable({"lut": Key(_PRICE), "multiplier": Key(_PRICE), "block_ram": Key(_PRICE)}),
            None,
            "Only for `auto`. What a LUT, a multiplier and a block RAM cost, in any unit, such as "
            "`{ lut = 1, multiplier = 50, block_ram = 80 }`.",
            "each is its share of the device",
        ),
        "reload": Key(
            Flag(),
            False,
            "Only for `engine`. With `true` the program is not part of the hardware: "
            "it is an image that is loaded ([engine](instruction-set.md#images)). The hardware "
            "then depends only on `program_words`, `operand_words`, `table_blocks`, "
            "`segment_width`, `pipeline` and `lanes`, on whether the scene's own network has ReLU, "
            "and on the kinds of its quantisers. A scene with a section [uart](#uart) loads the "
            "image over that line. Any other scene must have no front end, no visualisation and "
            "no `axi_stream`.",
        ),
        "program_words": Key(
            Whole(absent=True),
            0,
            "Only with `reload`. The number of words of the program memory, a power of two. Each "
            "half of a lane's memory has as many: 8192 at most, and no fewer than the tables take, "
            "which for tanh are 512.",
            "512",
        ),
        "operand_words": Key(
            Whole(absent=True),
            0,
            "Only with `reload`. The number of words of the operand memory, a power of two.",
            "128",
        ),
        "table_blocks": Key(
            Whole(absent=True),
            0,
            "Only with `reload`. The number of blocks for [tables of functions]"
            "(networks.md#functions-of-your-own) in the memory of each lane. "
            "With any blocks, each image brings the functions of its own network, as many as the "
            "blocks hold; without them there is the table of tanh alone.",
            "what the scene's own functions take",
        ),
        "adders_per_clock": Key(
            Whole(Span(1, 100), absent=True),
            0,
            "Only for `adder_graph` and `table_graph`. How many adders stand one behind the other "
            "between two registers. Fewer adders make the clock faster and the latency longer.",
            "5",
        ),
        "adder_operands": Key(
            Whole(absent=True),
            0,
            "Only for `adder_graph` and `table_graph`. How many numbers an adder adds, 2 or 3. "
            "With 3 the hardware "
            "is smaller where LUTs have six inputs, as in Series 7 and UltraScale, and larger "
            "where they have four.",
            "2",
        ),
        "word_width": Key(
            Whole(Span(3, 18), absent=True),
            0,
            "Only for `adder_graph`, behind layers of ReLU or other layers without a table. How "
            "many bits a word from layer to layer has. Each bit less makes every adder "
            "behind it shorter. A network for classes often decides the same with 8.",
            "15",
        ),
        "search_runs": Key(
            Whole(Span(1, 10_000), absent=True),
            0,
            "Only for `adder_graph`. How often the [search for sums that results share]"
            "(blocks/adder_graph.md) is run for each matrix. More runs "
            "take longer, and their graph never has more bits of adders in as many clocks.",
            "up to 40, fewer for a large matrix",
        ),
        "sample_bits": Key(
            Whole(absent=True),
            0,
            "Only for `table_graph`. How many of the upper bits of a sample its tables read, 4 to "
            "14. A bit that is below the noise of the readings only makes tables larger.",
            "10",
        ),
        "hidden_bits": Key(
            Whole(absent=True),
            0,
            "Only for `table_graph`. How many bits a hidden sum has for the tables behind it, 4 to "
            "14.",
            "10",
        ),
        "output_bits": Key(
            Whole(absent=True),
            0,
            "Only for `table_graph`. How many bits of an output its tables give, 4 to 14. The bits "
            "below them are 0.",
            "10",
        ),
    },
    name="a section",
)


def check_hardware(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse a combination of design, arrangement, interface and surrounding sections."""
    hardware, arrangement = values["hardware"], values["network"]["arrangement"]
    design = DESIGNS.get(hardware["design"])
    if design and arrangement not in design.arrangements:
        raise InputError(
            f"{path}: network.arrangement: got {arrangement!r} with design {design.block!r}, "
            f"expected {' or '.join(design.arrangements)}"
        )
    if design and hardware["precision"] not in design.precisions:
        raise InputError(
            f"{path}: hardware.precision: got {hardware['precision']!r} with design "
            f"{design.block!r}, expected {' or '.join(design.precisions)}"
        )
    framed = hardware["interface"] == "axi_stream"
    around: list[str] = [s for s in ("front_end", "visualisation") if s in values]
    if framed and around:
        raise InputError(
            f"{path}: hardware.interface: got 'axi_stream' with a section [{around[0]}], "
            "expected stream"
        )
    count = len(values["data"]["outputs"])
    if hardware["argmax"] and count < 2:
        raise InputError(
            f"{path}: hardware.argmax: got true for {count} output, expected false: argmax "
            "compares 2 outputs or more"
        )
    check_uart(values, path)
    unloaded = [*(["interface 'axi_stream'"] * framed), *(f"a section [{s}]" for s in around)]
    check_reload(hardware, [] if "uart" in values else unloaded, path)
    if design is None or design.stream == "serial":
        return
    reasons = {
        "front_end": "because the front end sends a stream of samples",
        "visualisation": "because the visualisation takes a stream of outputs",
        "argmax": "because argmax takes the outputs one after the other, or those of a design that "
        "has its own",
    }
    wanted = ["with interface 'axi_stream'"] if framed else []
    wanted += [f"with a section [{section}]" for section in around]
    if hardware["argmax"] and not design.decides_itself:
        around.append("argmax")
        wanted.append("with argmax")
    if wanted:
        serial = " or ".join(
            name
            for name, other in DESIGNS.items()
            if other.stream == "serial" or (other.decides_itself and around == ["argmax"])
        )
        reason = f", {reasons[around[0]]}" if around else ""
        raise InputError(
            f"{path}: hardware.design: got {design.block!r} {wanted[0]}, expected {serial}{reason}"
        )


def check_uart(values: dict[str, dict[str, Any]], path: Path) -> None:
    """Refuse a serial line without an instrument for it, and settings that need such a line."""
    lined, drawn = "uart" in values, values.get("visualisation", {})
    if lined and not values.get("front_end", {}).get("converter"):
        raise InputError(
            f"{path}: front_end.converter: got none with a section [uart], expected a part: the "
            "line is that of an instrument with a converter of its own"
        )
    if drawn.get("analogue") and not lined:
        raise InputError(
            f"{path}: visualisation.analogue: got {drawn['analogue']!r} without a section [uart], "
            "expected one: it belongs to the same instrument"
        )


def check_reload(hardware: dict[str, Any], around: list[str], path: Path) -> None:
    """Refuse settings that cannot be combined with an engine that can be reloaded."""
    if hardware["reload"] and around:
        raise InputError(
            f"{path}: hardware.reload: got true with {around[0]}, expected false: only a "
            "section [uart] can load an engine that has something around it"
        )
    for key in ("program_words", "operand_words", "table_blocks"):
        if hardware[key] and not hardware["reload"]:
            raise InputError(
                f"{path}: hardware.{key}: got {hardware[key]} without reload, expected "
                "hardware.reload = true, or no such key"
            )


def design_options(values: dict[str, dict[str, Any]], path: Path) -> dict[str, Any]:
    """The design's own options that the scene sets, if it fits the rest of the scene."""
    check_hardware(values, path)
    check_learning(values, path)
    hardware = values["hardware"]
    known = sorted({name for other in DESIGNS.values() for name in other.options})
    if hardware["design"] == UNDECIDED:
        refuse_choices(hardware, known, path)
        return {}
    design = DESIGNS[hardware["design"]]
    given = {name: hardware[name] for name in known if _given(hardware, name)}
    for name in given:
        if name not in design.options:
            fitting = " or ".join(n for n, other in DESIGNS.items() if name in other.options)
            raise InputError(
                f"{path}: hardware.{name}: got {written(given[name])} with design "
                f"{design.block!r}, "
                f"expected design {fitting}"
            )
    return {n: hardware[n] for n in design.options if _given(hardware, n)}


def _given(hardware: dict[str, Any], name: str) -> bool:
    """Whether the scene sets an option; lanes = 0 is set, and refused."""
    return bool(hardware.get(name)) or (name == "lanes" and hardware.get(name) is not None)


def refuse_choices(hardware: dict[str, Any], names: Sequence[str], path: Path) -> None:
    # In thesis precision the activation is part of what is asked for.
    own = ["activation", "activation_options"] if hardware["precision"] == EXACT.name else []
    for name in (*names, *own):
        if _given(hardware, name):
            raise InputError(
                f"{path}: hardware.{name}: got {written(hardware[name])} with design "
                f"{UNDECIDED!r}, expected none: it is chosen with the design"
            )


def check_activation(hardware: dict[str, Any], path: Path) -> str:
    """The activation's name; where the scene names none, that of the precision."""
    precision = PRECISIONS[hardware["precision"]]
    # Of the design that is to be chosen, nothing is known yet.
    design = DESIGNS.get(hardware["design"], Design)
    # A design that knows one activation has it without being asked.
    alone = len(design.known_activations) == 1 and precision.name in design.precisions
    usual = design.known_activations if alone else ()
    activation: str = hardware["activation"] or (*usual, precision.activation)[0]
    place = f"{path}: hardware.activation_options"
    scheme = SCHEMES[activation].configured(hardware["activation_options"], place)
    if precision not in scheme.precisions:
        fitting = ", ".join(name for name, s in SCHEMES.items() if precision in s.precisions)
        raise InputError(
            f"{path}: hardware.activation: got {activation!r} with precision {precision.name!r}, "
            f"expected one of {fitting}"
        )
    if design.known_activations and activation not in design.known_activations:
        raise InputError(
            f"{path}: hardware.activation: got {activation!r} with design {design.block!r}, "
            f"expected {' or '.join(design.known_activations)}"
        )
    options = hardware["activation_options"]
    if options and not design.activation_choices:
        raise InputError(
            f"{place}: got {', '.join(options)} with design {design.block!r}, expected none: its "
            f"{activation} has one form"
        )
    if scheme.half_codes and not design.half_codes:
        fitting = ", ".join(
            name
            for name, other in SCHEMES.items()
            if precision in other.precisions and not other.half_codes
        )
        raise InputError(
            f"{path}: hardware.activation: got {activation!r}, whose codes stand for the middle of "
            f"their step, with design {design.block!r}, expected one of {fitting}"
        )
    return activation


def demand(hardware: dict[str, Any], path: Path) -> Demand:
    rate, interval = hardware["frames_a_second"], hardware["interval"]
    if rate:
        if interval:
            raise InputError(
                f"{path}: hardware.frames_a_second: got {rate:g} with interval {interval}, "
                "expected one of the two"
            )
        interval = int(1e6 * hardware["clock_mhz"] / rate)
        if interval < 1:
            raise InputError(
                f"{path}: hardware.frames_a_second: got {rate:g}, expected at most "
                f"{1e6 * hardware['clock_mhz']:g}, a frame in every clock"
            )
    return Demand(hardware["clocks"], interval, rate)


def price(hardware: dict[str, Any], path: Path) -> Price:
    for key in ("device", "prices"):
        if hardware.get(key) and hardware["design"] != UNDECIDED:
            raise InputError(
                f"{path}: hardware.{key}: got {written(hardware[key])} with design "
                f"{hardware['design']!r}, expected design {UNDECIDED!r}"
            )
    found, prices = shares_of(hardware["device"] or DEFAULT), hardware.get("prices")
    if prices is None:
        return found
    if not any(prices.values()):
        raise InputError(f"{path}: hardware.prices: got 0 for all, expected one above 0")
    return Price(DEVICES[found.device.name], **prices, shares=False)


# What an engine that learns has, for each key of [hardware] that could ask for something else.
ONLY: dict[str, tuple[object, ...]] = {
    "design": (Engine.block,),
    "interface": ("stream",),
    "argmax": (False,),
    "lanes": (None, 1),
    "pipeline": ("", "short"),
    "reload": (False,),
    "segment_width": (0,),
}


def check_learning(values: dict[str, dict[str, Any]], path: Path) -> None:
    hardware, network, data = (values[name] for name in ("hardware", "network", "data"))
    if not hardware["learning"]:
        return
    got = f"with learning {hardware['learning']!r}"
    for key, known in ONLY.items():
        if hardware.get(key) not in known:
            raise InputError(
                f"{path}: hardware.{key}: got {written(hardware[key])} {got}, expected "
                f"{written(known[-1])}"
            )
    alone = network["arrangement"] == "single" and len(data["outputs"]) == 1
    if network["arrangement"] != "cascade" and not alone:
        raise InputError(
            f"{path}: network.arrangement: got {network['arrangement']!r} of "
            f"{len(data['outputs'])} outputs {got}, expected cascade, or one output"
        )
    around = [section for section in ("front_end", "visualisation") if section in values]
    if around and "uart" not in values:
        raise InputError(
            f"{path}: hardware.learning: got {hardware['learning']!r} and a section "
            f"[{around[0]}], expected [uart] too, through which the known outputs come"
        )
    past = [*["window"] * (not read_window(data, path).plain), *["classes"] * bool(data["classes"])]
    if past:
        raise InputError(
            f"{path}: data.{past[0]}: got {written(data[past[0]])} {got}, expected none"
        )
