"""The module around a design on a board: its clock and reset, and ports connected to pins."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from golden.common.port import CLOCKED
from golden.input_error import InputError
from golden.networks.network import Network
from tactus.boards import Board
from tactus.boards.board import LAMPS, WIRES
from tactus.core.cli import BETWEEN
from tactus.core.templates import environment
from tactus.export.handover import plain_name
from tactus.scene import Scene

TOP, OSCILLATOR = "board", "oscillator"
# For some microseconds after configuration, 36 clocks of 12 MHz, block RAMs of an iCE40 read zeros
# (github.com/YosysHQ/icestorm, issue 76). The design is reset for 2**RESET_WIDTH clocks.
RESET_WIDTH = 10

# How much slower than wanted a clock may be. It may never be faster, because the limits of the
# converter hold only up to the wanted clock.
SLOWER = Fraction(1, 200)
# The limits in MHz of the clock that enters a PLL, of the divided clock that is compared, of the
# oscillator inside, and of the clock that leaves. They are those of ecppll in
# github.com/YosysHQ/prjtrellis and of icepll in github.com/YosysHQ/icestorm.
ECP5_IN, ECP5_COMPARED = (8, 400), (Fraction(25, 8), 400)
ECP5_INSIDE, ECP5_OUT = (400, 800), (10, 400)
ECP5_MIDDLE = 600
ICE40_IN, ICE40_COMPARED, ICE40_INSIDE, ICE40_OUT = (10, 133), (10, 133), (533, 1066), (16, 275)
# The setting of the iCE40's filter, behind the limit below which the compared clock lies.
ICE40_FILTERS = ((17, 1), (26, 2), (44, 3), (66, 4), (101, 5), (134, 6))


@dataclass(frozen=True)
class Clock:
    """The source of a design's clock.

    mhz: The clock that is reached.
    pll: The settings of a PLL, as board.v.jinja takes them; none for the oscillator itself.
    """

    mhz: Fraction
    pll: tuple[int, ...] = ()


def clock_for(board: Board, clock_mhz: float) -> Clock:
    """The oscillator, or a PLL behind it."""
    source, wanted = Fraction(str(board.clock_mhz)), Fraction(str(clock_mhz))
    if source == wanted:
        return Clock(source)
    settings = {"ecp5": _ecp5_settings, "ice40": _ice40_settings}[board.family]
    off, _, *pll = min(settings(source, wanted), default=(wanted, 0))
    if off > wanted * SLOWER:
        nearest = f", the nearest is {float(wanted - off):g}" if pll else ""
        raise InputError(
            f"hardware.clock_mhz: got {clock_mhz:g}, no PLL of {board.device} makes it of "
            f"{board.title}'s {board.clock_mhz:g} MHz{nearest}; expected {board.clock_mhz:g}, "
            "which needs none, or another"
        )
    return Clock(wanted - off, tuple(pll))


# How much slower the clock is than wanted, how far the oscillator inside is from the middle of its
# range, and the settings. The least is the best.
Settings = tuple[Fraction, Fraction, int, int, int, int]


def _within(value: Fraction, limits: tuple[int | Fraction, int | Fraction]) -> bool:
    return limits[0] <= value <= limits[1]


def _ecp5_settings(source: Fraction, wanted: Fraction) -> Iterator[Settings]:
    """Settings whose first output closes the loop, and whose second is the clock: finer steps."""
    if not (_within(source, ECP5_IN) and _within(wanted, ECP5_OUT)):
        return
    for divide_in in range(1, 129):
        compared = source / divide_in
        if not _within(compared, ECP5_COMPARED):
            continue
        low, high = (int(limit / compared) for limit in ECP5_INSIDE)
        for loop in range(max(1, low), high + 1):
            inside = compared * loop
            divide_out = -int(-inside // wanted)
            if not _within(inside, ECP5_INSIDE) or not 1 <= divide_out <= 128:
                continue
            # The output that closes the loop has the limits of any output, and the factor of the
            # loop has a limit, too.
            closing = next(
                (
                    n
                    for n in range(1, 129)
                    if loop % n == 0 and loop // n <= 80 and _within(inside / n, ECP5_OUT)
                ),
                None,
            )
            if closing is not None:
                off = wanted - inside / divide_out
                yield off, abs(inside - ECP5_MIDDLE), divide_in, loop, divide_out, closing


def _ice40_settings(source: Fraction, wanted: Fraction) -> Iterator[Settings]:
    if not _within(source, ICE40_IN):
        return
    for divide_in, loop, halvings in product(range(1, 17), range(1, 129), range(1, 7)):
        compared = source / divide_in
        inside = compared * loop
        reached = inside / (1 << halvings)
        fits = _within(compared, ICE40_COMPARED) and _within(inside, ICE40_INSIDE)
        if fits and _within(reached, ICE40_OUT) and reached <= wanted:
            setting = next(number for limit, number in ICE40_FILTERS if compared < limit)
            yield wanted - reached, Fraction(), divide_in, loop, halvings, setting


def outside(scene: Scene, design: Network, board: Board) -> dict[str, str]:
    """The direction of each port of the design that has a pin, by name."""
    ports = [port for port in design.ports if port not in CLOCKED]
    others = [port.name for port in ports if port.direction == "in" and port.name not in WIRES]
    wrong = []
    if others:
        wrong.append(
            f"{scene.path}: front_end.converter: got none, expected one: a board cannot drive "
            f"{', '.join(others)} of {design.entity}"
        )
    if "tx" not in {port.name for port in ports}:
        wrong.append(
            f"{scene.path}: uart: got none, expected a section [uart]: without it nothing that "
            f"{design.entity} computes leaves the board"
        )
    wrong += [
        f"{board.path}: pins.{port.name}: missing, expected a pin: {design.entity} of scene "
        f"{scene.name} has that port"
        for port in ports
        if port.name in WIRES and port.name not in board.pins
    ]
    if wrong:
        raise InputError(BETWEEN.join(wrong))
    return {
        port.name: port.direction
        for port in ports
        if port.name in (*WIRES, *LAMPS) and port.name in board.pins
    }


def wrapper(scene: Scene, design: Network, board: Board, clock: Clock) -> str:
    """The top module of a bitstream, in Verilog.

    No input needs registers here: the receiver of the serial line has its own, and ``miso`` changes
    only when ``sclk`` falls, a whole period before it is read.
    """
    found = outside(scene, design, board)
    joined = [port.name for port in design.ports if port not in CLOCKED]
    return (
        environment("tactus.boards")
        .get_template("board.v.jinja")
        .render(
            top=TOP,
            scene=plain_name(scene.name),
            design=design,
            board=board,
            mhz=f"{float(clock.mhz):g}",
            pll=clock.pll,
            reset_width=RESET_WIDTH,
            ports={OSCILLATOR: "in", **found, **dict.fromkeys(board.high, "out")},
            lit=[name for name in found if board.pins[name].inverted],
            # Those with a pin come first, and the others stay open.
            joined=sorted(joined, key=lambda name: name not in found),
        )
    )
