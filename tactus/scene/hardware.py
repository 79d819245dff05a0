"""The section ``[hardware]`` of a scene: which of its keys go together."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from golden.activation.schemes import SCHEMES
from golden.input_error import InputError
from golden.networks.design import Design
from golden.networks.designs import DESIGNS
from golden.numbers.precision import EXACT, PRECISIONS
from tactus.core.schema import written
from tactus.sizing.choice import UNDECIDED, Demand


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
    count = len(values["data"]["outputs"])
    if hardware["argmax"] and count < 2:
        raise InputError(
            f"{path}: hardware.argmax: got true for {count} output, expected false: argmax "
            "compares 2 outputs or more"
        )
    unloaded = [*(["interface 'axi_stream'"] * framed), *(f"a section [{s}]" for s in around)]
    if hardware["reload"] and unloaded and "uart" not in values:
        raise InputError(
            f"{path}: hardware.reload: got true with {unloaded[0]}, expected false: only a "
            "section [uart] can load an engine that has something around it"
        )
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
    if scheme.half_codes and not design.known_activations:
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
        interval = int(1e6 * hardware["clock_mhz"] / rate)
        if interval < 1:
            raise InputError(
                f"{path}: hardware.frames_a_second: got {rate:g}, expected at most "
                f"{1e6 * hardware['clock_mhz']:g}, a frame in every clock"
            )
    return Demand(hardware["clocks"], interval, rate)


def check_learning(values: dict[str, dict[str, Any]], path: Path) -> None:
    hardware, network, data = (values[name] for name in ("hardware", "network", "data"))
    if not hardware["learning"]:
        return
    alone = network["arrangement"] == "single" and len(data["outputs"]) == 1
    if network["arrangement"] != "cascade" and not alone:
        raise InputError(
            f"{path}: network.arrangement: got {network['arrangement']!r} of "
            f"{len(data['outputs'])} outputs with learning {hardware['learning']!r}, expected "
            "cascade, or one output"
        )
    around = [section for section in ("front_end", "visualisation") if section in values]
    if around and "uart" not in values:
        raise InputError(
            f"{path}: hardware.learning: got {hardware['learning']!r} and a section "
            f"[{around[0]}], expected [uart] too, through which the known outputs come"
        )
