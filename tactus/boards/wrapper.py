"""The module around a design on a board: its clock and reset, and ports connected to pins."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from golden.common.port import CLOCKED
from golden.input_error import InputError
from golden.networks.network import Network
from tactus.boards import Board
from tactus.boards.board import LAMPS, WIRES
from tactus.core.cli import BETWEEN
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
    text: Verilog that connects the wires ``oscillator``, ``clk`` and ``locked``.
    pll: Whether it is a PLL; otherwise it is the oscillator itself.
    """

    mhz: Fraction
    text: str
    pll: bool = True


def clock_for(board: Board, clock_mhz: float) -> Clock:
    """The oscillator, or a PLL behind it."""
    source, wanted = Fraction(str(board.clock_mhz)), Fraction(str(clock_mhz))
    if source == wanted:
        return Clock(source, "  assign clk = oscillator;", pll=False)
    found = {"ecp5": _ecp5, "ice40": _ice40}[board.family](board, source, wanted)
    if found is None or found.mhz < wanted * (1 - SLOWER):
        nearest = f", the nearest is {float(found.mhz):g}" if found else ""
        raise InputError(
            f"hardware.clock_mhz: got {clock_mhz:g}, no PLL of {board.device} makes it of "
            f"{board.title}'s {board.clock_mhz:g} MHz{nearest}; expected {board.clock_mhz:g}, "
            "which needs none, or another"
        )
    return found


def _within(value: Fraction, limits: tuple[int | Fraction, int | Fraction]) -> bool:
    return limits[0] <= value <= limits[1]


def _ecp5(board: Board, source: Fraction, wanted: Fraction) -> Clock | None:
    """A PLL whose first output closes the loop and whose second is the clock, for finer steps."""
    best = min(_ecp5_settings(source, wanted), default=None)
    if best is None or not _within(source, ECP5_IN) or not _within(wanted, ECP5_OUT):
        return None
    off, _, divide_in, loop, divide_out, divide_loop = best
    # Charge pump and filter are set as ecppll sets them.
    text = f"""  wire looped;
  (* ICP_CURRENT="12" *) (* LPF_RESISTOR="8" *) (* MFG_ENABLE_FILTEROPAMP="1" *)
  (* MFG_GMCREF_SEL="2" *)
  EHXPLLL #(
    .CLKI_DIV({divide_in}), .CLKFB_DIV({loop // divide_loop}), .FEEDBK_PATH("CLKOP"),
    .CLKOP_ENABLE("ENABLED"), .CLKOP_DIV({divide_loop}), .CLKOP_CPHASE({divide_loop - 1}),
    .CLKOS_ENABLE("ENABLED"), .CLKOS_DIV({divide_out}), .CLKOS_CPHASE({divide_out - 1})
  ) pll (
    .CLKI(oscillator), .CLKFB(looped), .CLKOP(looped), .CLKOS(clk), .LOCK(locked),
    .RST(1'b0), .STDBY(1'b0), .PHASESEL0(1'b0), .PHASESEL1(1'b0), .PHASEDIR(1'b0),
    .PHASESTEP(1'b0), .PHASELOADREG(1'b0), .PLLWAKESYNC(1'b0), .ENCLKOP(1'b0), .ENCLKOS(1'b0)
  );"""
    return Clock(wanted - off, text)


def _ecp5_settings(
    source: Fraction, wanted: Fraction
) -> Iterator[tuple[Fraction, Fraction, int, int, int, int]]:
    """All settings; the least tuple is the best.

    Each is how much slower the clock is, how far the oscillator inside is from the middle of its
    range, and then the divisors.
    """
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


def _ice40(board: Board, source: Fraction, wanted: Fraction) -> Clock | None:
    if not _within(source, ICE40_IN):
        return None
    best = min(_ice40_settings(source, wanted), default=None)
    if best is None:
        return None
    off, divide_in, loop, halvings = best
    compared = source / divide_in
    setting = next(number for limit, number in ICE40_FILTERS if compared < limit)
    kind, port = ("PAD", "PACKAGEPIN") if board.pll_pad else ("CORE", "REFERENCECLK")
    text = f"""  SB_PLL40_{kind} #(
    .FEEDBACK_PATH("SIMPLE"), .DIVR(4'd{divide_in - 1}), .DIVF(7'd{loop - 1}), .DIVQ(3'd{halvings}),
    .FILTER_RANGE(3'd{setting})
  ) pll (
    .{port}(oscillator), .PLLOUTGLOBAL(clk), .LOCK(locked), .RESETB(1'b1), .BYPASS(1'b0)
  );"""
    return Clock(wanted - off, text)


def _ice40_settings(source: Fraction, wanted: Fraction) -> Iterator[tuple[Fraction, int, int, int]]:
    for divide_in in range(1, 17):
        if not _within(source / divide_in, ICE40_COMPARED):
            continue
        for loop in range(1, 129):
            inside = source / divide_in * loop
            for halvings in range(1, 7):
                reached = inside / (1 << halvings)
                fits = _within(inside, ICE40_INSIDE) and _within(reached, ICE40_OUT)
                if fits and reached <= wanted:
                    yield wanted - reached, divide_in, loop, halvings


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
    ports = [f"input {OSCILLATOR}"]
    ports += [f"{direction}put {name}" for name, direction in found.items()]
    ports += [f"output {name}" for name in board.high]
    lit = [name for name in found if board.pins[name].inverted]
    wires = [f"  wire {name}_inside;" for name in lit]
    assigns = [f"  assign {name} = !{name}_inside;" for name in lit]
    assigns += [f"  assign {name} = 1'b1;" for name in board.high]
    joined = [".clk(clk)", ".rst(rst)"]
    joined += [f".{name}({f'{name}_inside' if name in lit else name})" for name in found]
    joined += [
        f".{port.name}()" for port in design.ports if port not in CLOCKED and port.name not in found
    ]
    mhz = f"{float(clock.mhz):g} MHz"
    if clock.pll:
        wires += ["  wire locked;", "  reg [1:0] steady = 0;"]
        steps = [
            "    steady <= {steady[0], locked};",
            "    if (!steady[1]) count <= 0;",
            "    else if (rst) count <= count + 1'b1;",
        ]
        source = f"{mhz} by a PLL from {board.clock_mhz:g} MHz"
    else:
        steps = ["    if (rst) count <= count + 1'b1;"]
        source = f"{mhz}, the oscillator"
    return "\n".join(
        [
            f"// {design.entity} of scene {plain_name(scene.name)} on {board.title},",
            f"// {board.device}: clock of {source}. Generated by tactus, do not edit.",
            "",
            f"module {TOP} (",
            ",\n".join(f"  {port}" for port in ports),
            ");",
            "  wire clk, rst;",
            *wires,
            clock.text,
            "  // Registers begin at 0, so the design begins in reset.",
            f"  reg [{RESET_WIDTH}:0] count = 0;",
            f"  assign rst = !count[{RESET_WIDTH}];",
            "  always @(posedge clk) begin",
            *steps,
            "  end",
            *assigns,
            f"  {design.entity} inner (",
            ",\n".join(f"    {text}" for text in joined),
            "  );",
            "endmodule",
            "",
        ]
    )
