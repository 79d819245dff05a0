"""Which sections and keys a scene may have, of which types, and with which choices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from golden.activation.schemes import SCHEMES
from golden.finding import Finding, refuse, told
from golden.input_error import InputError
from golden.networks.arrangement import ARRANGEMENTS
from golden.networks.designs import DESIGNS
from golden.precision import PRECISIONS
from golden.scene.front_end import CONVERTERS
from golden.scene.front_end import KEYS as FRONT_END_KEYS
from golden.scene.uart import KEYS as UART_KEYS
from golden.scene.visualisation import ANALOGUE
from golden.scene.visualisation import KEYS as VISUALISATION_KEYS
from golden.table import refuse_unknown, suggest

FEWEST = "fewest"
# What digits = "fewest" lets an output err more, as a part of its error.
DIGITS_TOLERANCE = 0.02

# Section, key, type, default; None as a default makes the key required. A type in brackets is one
# such value for all networks of the scene, or a list of one for each; several are alternatives.
KEYS: dict[str, dict[str, tuple[Any, Any]]] = {
    "data": {
        "file": (str, ""),
        "recordings": (list, []),
        "sensors": (list, None),
        "outputs": (list, None),
        "group_by": (str, ""),
        "where": (dict, {}),
        "window": ((list, dict), [0]),
        "full_scale": (dict, {}),
        "length_mm": (dict, {}),
        "scale": ((dict, str), {}),
        "units": (dict, {}),
        "reference": (str, ""),
    },
    "network": {
        "arrangement": (str, None),
        "hidden": ([int], 0),
        "weights": ([str], None),
    },
    "hardware": {
        "design": (str, None),
        "activation": (str, ""),
        "activation_options": (dict, {}),
        "precision": (str, None),
        "clock_mhz": (float, 64.0),
        "interface": (str, "stream"),
        "multiplier": (str, ""),
        "pipeline": (str, ""),
        "segment_width": (int, 0),
        "clocks": (int, 0),
        "reload": (bool, False),
        "program_words": (int, 0),
        "operand_words": (int, 0),
        "adders_per_clock": (int, 0),
    },
    "training": {
        "optimiser": (str, "levenberg-marquardt"),
        "hidden": (list, [4, 25]),
        "seed": (int, 1),
        "restarts": (int, 8),
        "weight_decay": (float, 1e-4),
        "steps": (int, 200),
        "patience": (int, 40),
        "earlier_outputs": (str, "bit-true"),
        "split": (str, "random"),
        "split_by": (list, []),
        "block_rows": (int, 5),
        "refit": (bool, False),
        "digits": ((int, str), 0),
        "digits_tolerance": (float, DIGITS_TOLERANCE),
        "noise": (float, 0.0),
        "drift": (dict, {}),
    },
    "front_end": FRONT_END_KEYS,
    "visualisation": VISUALISATION_KEYS,
    "uart": UART_KEYS,
}
# Sections without which a scene has no such thing; of the others the defaults stand.
OPTIONAL = ("front_end", "visualisation", "uart")
# Keys whose 0 stands for a key that is left out, and is no number that can be asked for.
NOT_ZERO = {
    *(("hardware", key) for key in ("segment_width", "clocks", "adders_per_clock")),
    *(("hardware", key) for key in ("program_words", "operand_words")),
    ("front_end", "reference"),
}
CHOICES = {
    ("network", "arrangement"): ARRANGEMENTS,
    ("hardware", "design"): tuple(DESIGNS),
    ("hardware", "activation"): tuple(SCHEMES),
    ("hardware", "precision"): tuple(PRECISIONS),
    ("hardware", "interface"): ("stream", "axi_stream"),
    ("hardware", "multiplier"): ("dsp", "serial"),
    ("hardware", "pipeline"): ("short", "deep"),
    ("training", "optimiser"): ("levenberg-marquardt", "scg"),
    ("training", "earlier_outputs"): ("bit-true", "float"),
    ("training", "split"): ("random", "blocks", "groups"),
    ("front_end", "converter"): CONVERTERS,
    ("visualisation", "analogue"): ANALOGUE,
}


def check_names(raw: dict[str, Any], path: Path) -> None:
    """Refuse a section or a key that is not known, and what is no section.

    Raises
    ------
    InputError
    """
    refuse_unknown(raw, KEYS, f"{path}: section")
    _refuse_long(raw, f"{path}: ")
    for section, given in raw.items():
        if not isinstance(given, dict):
            raise InputError(f"{path}: {section}: got {given!r}, expected a section")
        refuse_unknown(given, KEYS[section], f"{path}: {section}: key")


def checked(raw: dict[str, Any], path: Path) -> dict[str, dict[str, Any]]:
    """Every section with every key, types and choices checked, defaults filled in.

    Raises
    ------
    InputError
        For all keys that are missing or hold what they cannot.
    """
    found: list[Finding] = []
    values: dict[str, dict[str, Any]] = {}
    for section, keys in KEYS.items():
        if section in OPTIONAL and section not in raw:
            continue
        values[section] = {}
        for key in keys:
            with told(found):
                values[section][key] = _value(raw.get(section, {}), section, key, path)
    refuse(found)
    return values


def _value(given: dict[str, Any], section: str, key: str, path: Path) -> Any:
    """What a key of a section holds, or its default."""
    kind, default = KEYS[section][key]
    value = given.get(key, default)
    if value is None:
        raise InputError(f"{path}: {section}.{key}: missing, expected {_kind(kind)}")
    if kind is float and type(value) is int:
        value = float(value)
    if not _is(value, kind):
        raise InputError(f"{path}: {section}.{key}: got {value!r}, expected {_kind(kind)}")
    if (section, key) in NOT_ZERO and key in given and value == 0:
        raise InputError(
            f"{path}: {section}.{key}: got {value:g}, expected a number above 0, or no such key"
        )
    choices = CHOICES.get((section, key))
    if choices and key in given and value not in choices:
        raise InputError(
            f"{path}: {section}.{key}: got {value!r}, expected one of "
            f"{', '.join(choices)}{suggest(str(value), choices)}"
        )
    return value


def _refuse_long(value: Any, place: str) -> None:
    """Whole numbers have the 64 bits that TOML gives them, so that each is a float, too."""
    if isinstance(value, dict):
        for key, inner in value.items():
            _refuse_long(inner, f"{place}{'' if place.endswith(': ') else '.'}{key}")
    elif isinstance(value, list):
        for inner in value:
            _refuse_long(inner, place)
    elif isinstance(value, int) and not -(1 << 63) <= value < 1 << 63:
        raise InputError(f"{place}: got a number of {value.bit_length()} bits, expected 64 at most")


def _is(value: Any, kind: Any) -> bool:
    if isinstance(kind, list):
        values = value if isinstance(value, list) else [value]
        return all(type(v) is kind[0] for v in values)
    if isinstance(kind, tuple):
        return any(_is(value, one) for one in kind)
    return type(value) is kind


def _kind(kind: Any) -> str:
    if isinstance(kind, list):
        return f"{_kind(kind[0])}, or a list with one for each network"
    if isinstance(kind, tuple):
        return " or ".join(_kind(one) for one in kind)
    names = {
        str: "text",
        bool: "true or false",
        int: "a whole number",
        float: "a number",
        list: "a list",
        dict: "a table",
    }
    return names[kind]
