"""A board file: which device, which clock, and which pin is which port of a design."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from golden.boards.devices import DEVICES, speeds_of
from golden.files import check_file
from golden.input_error import InputError, MissingFileError
from golden.schema import Flag, Key, List, Map, Number, Span, Table, Text, Whole, read_checked
from golden.table import suggest

FOLDER = Path(__file__).parent
# Ports of an instrument that leave the device: wires, without which it is of no use, and lamps.
WIRES = ("miso", "sclk", "cs_n", "mosi", "rx", "tx", "dac_x", "dac_y")
LAMPS = ("converter_error",)
PORTS = (*WIRES, *LAMPS)
_TEXTS = List(Text(some=True), "a list of texts", "a list of texts")
PIN = Table(
    {
        "pin": Key(Text()),
        "at": Key(Text()),
        "pull_up": Key(Flag(), False),
        "inverted": Key(Flag(), False),
    }
)
BOARD = Table(
    {
        "title": Key(Text()),
        "sources": Key(_TEXTS),
        "load": Key(Text(), ""),
        "flash": Key(Text()),
        "device": Key(
            Table(
                {
                    "family": Key(Text(tuple(DEVICES))),
                    "names": Key(_TEXTS),
                    "package": Key(Text()),
                    "speed": Key(Whole(), None),
                    "configuration": Key(Map(Text()), {}),
                }
            )
        ),
        "clock": Key(
            Table(
                {
                    "pin": Key(Text()),
                    "mhz": Key(Number(Span(above=0))),
                    "pll_pad": Key(Flag(), False),
                }
            )
        ),
        "pins": Key(Table({port: Key(PIN, None) for port in PORTS}, noun="port ")),
        "high": Key(Map(PIN), {}),
    }
)
# What may stand in a pins file between quotes, in a command line or as a name in Verilog.
PLAIN = re.compile(r"[A-Za-z0-9_.-]+")
NAME = re.compile(r"[a-z][a-z0-9_]*")


@dataclass(frozen=True)
class Pin:
    """One pin of the device.

    Attributes
    ----------
    pin : str
        Its name in the package.
    at : str
        Where the board has it.
    pull_up : bool
        The device's own resistor to its supply is on.
    inverted : bool
        A lamp that is lit by a 0.
    """

    pin: str
    at: str
    pull_up: bool = False
    inverted: bool = False


@dataclass(frozen=True)
class Board:
    """What a board file says.

    Attributes
    ----------
    name : str
        Of the file.
    path : Path
    title : str
    sources : tuple of str
        Where the pins were read.
    load, flash : str
        What stands before the bitstream's name in the command that programs the device until its
        supply is cut (empty where there is no such), and for good.
    family : str
        Of ``DEVICES``.
    device : str
        The one that is built for, of ``devices``, which the board is sold with.
    devices : tuple of str
    package : str
    speed : int
        Grade; 0 where the file names none.
    configuration : dict
        How the device is to be configured, by the name that its pins file has for it.
    clock_pin : str
    clock_mhz : float
        Of the oscillator.
    pll_pad : bool
        The clock's pin is the PLL's own input.
    pins : dict
        By the name of a design's port.
    high : dict
        Outputs that are always high, by a name.
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

    Parameters
    ----------
    name : str
    device : str
        Of those that the board is sold with; empty takes the first.

    Raises
    ------
    InputError
        For an unknown board; the message lists those there are. For one that cannot be read.
        For a fault in the file, and for a device that the board has not; the message names file,
        key, what was got and what was expected.
    """
    known = board_names()
    path = FOLDER / f"{name}.toml" if name in known else Path(name)
    try:
        if path.suffix != ".toml":
            raise FileNotFoundError
        check_file(path)
    except FileNotFoundError:
        raise MissingFileError(
            f"board {name!r}: no such board, expected a path to a .toml file or one of "
            f"{', '.join(known)}{suggest(name, known)}"
        ) from None
    return _board(read_checked(path, BOARD), path, device)


def _board(values: dict[str, Any], path: Path, device: str) -> Board:
    part, clock = values["device"], values["clock"]
    family, names = part["family"], tuple(part["names"])
    for name in names:
        if name not in DEVICES[family]:
            raise InputError(
                f"{path}: device.names: got {name!r}, expected of {', '.join(DEVICES[family])}"
                f"{suggest(name, list(DEVICES[family]))}"
            )
    for name in names if "speed" in part else ():
        speeds = speeds_of(family, name)
        if part["speed"] not in speeds:
            known = " or ".join(map(str, speeds)) or "no such key: the family has no speed grades"
            raise InputError(
                f"{path}: device.speed: got {part['speed']} for {name}, expected {known}"
            )
    if device and device not in names:
        raise InputError(
            f"DEVICE={device}: {path} has {', '.join(names)}{suggest(device, list(names))}"
        )
    pins = {name: Pin(**pin) for name, pin in values["pins"].items()}
    high = {name: Pin(**PIN.filled(pin)) for name, pin in values["high"].items()}
    for name in high:
        if not NAME.fullmatch(name) or name in PORTS:
            raise InputError(
                f"{path}: high.{name}: expected a name of small letters, digits and _ that no port "
                "has"
            )
    for name, pin in {**pins, **high}.items():
        if pin.inverted and name not in LAMPS:
            raise InputError(f"{path}: pins.{name}.inverted: got true, expected it of a lamp alone")
    _refuse_twice({"clock": clock["pin"]} | {n: p.pin for n, p in {**pins, **high}.items()}, path)
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


def _refuse_twice(pins: dict[str, str], path: Path) -> None:
    seen: dict[str, str] = {}
    for name, pin in pins.items():
        if not PLAIN.fullmatch(pin):
            raise InputError(f"{path}: {name}: got pin {pin!r}, expected such as 'B11' or '4'")
        if pin in seen:
            raise InputError(f"{path}: {name}: got pin {pin}, which {seen[pin]} has")
        seen[pin] = name
