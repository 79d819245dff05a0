"""A board file: the device, its clock, and the pin for each port of a design."""

import re
from dataclasses import dataclass
from pathlib import Path

from golden.input_error import InputError, suggest
from tactus.core.files import named_file
from tactus.core.schema import Rule, read_checked

# For each family: the name of a device by its maker, and its name in nextpnr.
DEVICES = {
    "ecp5": {
        "LFE5U-12F": "12k",
        "LFE5U-25F": "25k",
        "LFE5U-45F": "45k",
        "LFE5U-85F": "85k",
        "LFE5UM-25F": "um-25k",
        "LFE5UM-45F": "um-45k",
        "LFE5UM-85F": "um-85k",
        "LFE5UM5G-25F": "um5g-25k",
        "LFE5UM5G-45F": "um5g-45k",
        "LFE5UM5G-85F": "um5g-85k",
    },
    "ice40": {
        "iCE40UP5K": "up5k",
        "iCE40HX1K": "hx1k",
        "iCE40HX4K": "hx4k",
        "iCE40HX8K": "hx8k",
        "iCE40LP1K": "lp1k",
        "iCE40LP4K": "lp4k",
        "iCE40LP8K": "lp8k",
    },
}
# Speed grades that nextpnr knows: those of a family, and of the devices that are sold with only
# one.
SPEEDS: dict[str, tuple[int, ...]] = {"ecp5": (6, 7, 8), "ice40": ()}
FAST, FAST_SPEEDS = "LFE5UM5G", (8,)


FOLDER = Path(__file__).parent
# Ports of an instrument that leave the device: wires, without which it is of no use, and lamps.
WIRES = ("miso", "sclk", "cs_n", "mosi", "rx", "tx", "dac_x", "dac_y")
LAMPS = ("converter_error",)
PORTS = (*WIRES, *LAMPS)


def _table(**properties: Rule) -> Rule:
    return {"type": "object", "properties": properties}


_TEXT: Rule = {"type": "string"}
_FLAG: Rule = {"type": "boolean", "default": False}
_TEXTS = {"type": "array", "items": _TEXT | {"minLength": 1}, "minItems": 1}
PIN = _table(pin=_TEXT, at=_TEXT, pull_up=_FLAG)
LAMP = _table(**PIN["properties"], inverted=_FLAG)
BOARD = _table(
    title=_TEXT,
    sources=_TEXTS,
    load=_TEXT | {"default": ""},
    flash=_TEXT,
    device=_table(
        family=_TEXT | {"enum": list(DEVICES)},
        names=_TEXTS,
        package=_TEXT,
        speed={"type": "integer", "optional": True},
        configuration={"type": "object", "additionalProperties": _TEXT, "default": {}},
    ),
    clock=_table(pin=_TEXT, mhz={"type": "number", "exclusiveMinimum": 0}, pll_pad=_FLAG),
    pins=_table(
        **dict.fromkeys(WIRES, PIN | {"optional": True}),
        **dict.fromkeys(LAMPS, LAMP | {"optional": True}),
    ),
    high={"type": "object", "additionalProperties": PIN, "default": {}},
)
# The texts that are allowed in a pins file between quotes or in a command line, and as a name in
# Verilog.
PLAIN = re.compile(r"[A-Za-z0-9_.-]+")
NAME = re.compile(r"[a-z][a-z0-9_]*")


@dataclass(frozen=True)
class Pin:
    """One pin of the device.

    pin: Name of the pin in the package.
    at: Where the pin is on the board.
    pull_up: Whether the device's own resistor to its supply is switched on.
    inverted: Whether the pin drives a lamp that is lit by a 0.
    """

    pin: str
    at: str
    pull_up: bool = False
    inverted: bool = False


@dataclass(frozen=True)
class Board:
    """The contents of a board file.

    name: Name of the file.
    sources: The documents in which the pins were found.
    load, flash: Command, up to the bitstream's name, that programs the device until its supply is
        cut (empty if there is none), and that which programs it permanently.
    family: One of ``DEVICES``.
    device: The device for which a design is built, one of ``devices``.
    devices: The devices with which the board is sold.
    speed: Speed grade; 0 where the file states none.
    configuration: How the device must be configured, by the names that its pins file uses.
    clock_mhz: Frequency of the oscillator.
    pll_pad: Whether the clock's pin is the PLL's own input.
    pins: Pins by the name of a design's port.
    high: Outputs that must always be high, each with a name.
    """

    name: str
    path: Path
    title: str
    sources: tuple[str, ...]
    load: str
    flash: str
    family: str
    device: str
    devices: tuple[str, ...]
    package: str
    speed: int
    configuration: dict[str, str]
    clock_pin: str
    clock_mhz: float
    pll_pad: bool
    pins: dict[str, Pin]
    high: dict[str, Pin]


def board_names() -> list[str]:
    """The boards that tactus ships."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load_board(name: str, device: str = "") -> Board:
    """Read a board by its name, or by a path that ends in ``.toml``.

    device: One of the devices with which the board is sold; by default the first.
    """
    known = {board: FOLDER / f"{board}.toml" for board in board_names()}
    path = named_file("board", name, known, list(known))
    values = read_checked(path, BOARD)
    part, clock = values["device"], values["clock"]
    family, names = part["family"], tuple(part["names"])
    for name in names:
        if name not in DEVICES[family]:
            raise InputError(
                f"{path}: device.names: got {name!r}, expected one of {', '.join(DEVICES[family])}"
                f"{suggest(name, list(DEVICES[family]))}"
            )
    for name in names if "speed" in part else ():
        speeds = FAST_SPEEDS if name.startswith(FAST) else SPEEDS[family]
        if part["speed"] not in speeds:
            wanted = " or ".join(map(str, speeds)) or "no such key: the family has no speed grades"
            raise InputError(
                f"{path}: device.speed: got {part['speed']} for {name}, expected {wanted}"
            )
    if device and device not in names:
        raise InputError(
            f"DEVICE={device}: {path} has {', '.join(names)}{suggest(device, list(names))}"
        )
    pins = {name: Pin(**pin) for name, pin in values["pins"].items()}
    high = {name: Pin(**pin) for name, pin in values["high"].items()}
    for name in high:
        if not NAME.fullmatch(name) or name in PORTS:
            raise InputError(
                f"{path}: high.{name}: expected a name of small letters, digits and _ that no port "
                "has"
            )
    seen: dict[str, str] = {}
    for name, used in [("clock", clock["pin"]), *((n, p.pin) for n, p in (pins | high).items())]:
        if not PLAIN.fullmatch(used):
            raise InputError(
                f"{path}: {name}: got pin {used!r}, expected a name such as 'B11' or '4'"
            )
        if used in seen:
            raise InputError(f"{path}: {name}: got pin {used}, which {seen[used]} already has")
        seen[used] = name
    for key, text in {**part["configuration"], "package": part["package"]}.items():
        if not PLAIN.fullmatch(text) or not PLAIN.fullmatch(key):
            raise InputError(
                f"{path}: device: {key}: got {text!r}, expected text of letters, digits, _, . and -"
            )
    return Board(
        name=path.stem,
        path=path,
        title=values["title"],
        sources=tuple(values["sources"]),
        load=values["load"],
        flash=values["flash"],
        family=family,
        device=device or names[0],
        devices=names,
        package=part["package"],
        speed=part.get("speed", 0),
        configuration=part["configuration"],
        clock_pin=clock["pin"],
        clock_mhz=clock["mhz"],
        pll_pad=clock["pll_pad"],
        pins=pins,
        high=high,
    )
