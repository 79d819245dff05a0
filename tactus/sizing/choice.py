"""Chooses the smallest design that is fast enough, for ``design = "auto"``."""

from dataclasses import dataclass
from operator import attrgetter

from golden.input_error import InputError
from golden.networks.network import Network
from tactus.sizing.candidates import (
    Cells,
    Refused,
    Sized,
    SizingTask,
    all_sized,
)

# What a scene names in the place of a design.
UNDECIDED = "auto"


@dataclass(frozen=True)
class Demand:
    """How fast the networks of a scene must be; 0 stands for no limit.

    clocks: The most clocks from the last sample to the last output.
    interval: The most clocks from frame to frame.
    frames_a_second: The rate from which ``interval`` comes, where the scene gives one.
    """

    clocks: int = 0
    interval: int = 0
    frames_a_second: float = 0.0

    def misses(self, clocks: int, interval: int) -> list[str]:
        """What is too slow, as texts without the name of a key."""
        found = []
        if self.clocks and clocks > self.clocks:
            found.append(f"takes {clocks} clocks, {clocks - self.clocks} too many")
        if self.interval and interval > self.interval:
            over = interval - self.interval
            found.append(f"takes a frame every {interval} clocks, {over} too many")
        return found

    def excess(self, clocks: int, interval: int) -> float:
        """By which factor a design is too slow; 1 or less if it is fast enough."""
        pairs = ((clocks, self.clocks), (interval, self.interval))
        return max([got / most for got, most in pairs if most], default=0.0)

    def refuse(self, network: Network, design: str) -> None:
        clocks, interval = network.clocks_after_samples, network.interval
        if self.clocks and clocks > self.clocks:
            raise InputError(
                f"hardware.clocks: got {self.clocks}, expected {clocks} or more, which {design} "
                f"takes from the last sample to the last output"
            )
        if self.interval and interval > self.interval:
            given = f"hardware.interval: got {self.interval}"
            if self.frames_a_second:
                given = (
                    f"hardware.frames_a_second: got {self.frames_a_second:g}, a frame every "
                    f"{self.interval} clocks"
                )
            raise InputError(
                f"{given}, expected {interval} clocks or more, which {design} takes from frame to "
                "frame"
            )


NO_DEMAND = Demand()


@dataclass(frozen=True)
class Device:
    """What a device has.

    name: The maker's name.
    family: "xc2v" or "ecp5", as ``make designs`` names it.
    """

    name: str
    family: str
    luts: int
    multipliers: int
    block_rams: int

    def shares(self, cells: Cells) -> list[float]:
        """The shares of LUTs, multipliers and block RAMs that a design takes, in per cent."""
        pairs = (
            (cells.luts, self.luts),
            (cells.multipliers, self.multipliers),
            (cells.block_rams, self.block_rams),
        )
        return [100 * taken / there for taken, there in pairs]

    def price(self, row: Sized) -> float:
        return sum(self.shares(row.cells(self.family)))

    def text(self, row: Sized) -> str:
        fits = max(self.shares(row.cells(self.family))) <= 100
        text = f"{self.price(row):.3g} % of {self.name}"
        return text if fits else f"{text}, in which it does not fit"


# The device of the thesis, which is the default, and the ECP5 of the boards; an LFE5U-12F is an
# LFE5U-25F that is sold for half.
DEVICES = {
    device.name: device
    for device in (
        Device("XC2V3000", "xc2v", 28672, 96, 96),
        Device("LFE5U-12F", "ecp5", 12144, 28, 32),
        Device("LFE5U-25F", "ecp5", 24288, 28, 56),
        Device("LFE5U-45F", "ecp5", 43848, 72, 108),
        Device("LFE5U-85F", "ecp5", 83640, 156, 208),
    )
}
DEFAULT = "XC2V3000"


@dataclass(frozen=True)
class Choice:
    """The design that was chosen, and what is beside it.

    smaller, faster: The dearest design that is cheaper, which is too slow or coarse; and the
        cheapest that takes fewer clocks, or frames more often where there is only a limit to their
        interval.
    """

    row: Sized
    demand: Demand
    device: Device
    smaller: Sized | None
    faster: Sized | None

    def lines(self) -> list[str]:
        """What was chosen, by how much the next smaller one misses, and what would be faster."""
        smaller = "none, no other design is smaller"
        if one := self.smaller:
            missing = self.demand.misses(one.clocks, one.interval) or [
                f"is further from the networks: {_apart(one)}, not {self.row.mean:.3g}"
            ]
            smaller = f"{one.candidate.name} at {self.device.text(one)} {' and '.join(missing)}"
        faster = self._told(self.faster) if self.faster else "none, no other design is faster"
        return [
            f"chosen: {self._told(self.row)}",
            f"next smaller: {smaller}",
            f"next faster: {faster}",
        ]

    def _told(self, row: Sized) -> str:
        cells = row.cells(self.device.family)
        return (
            f"{row.candidate.name}: {row.clocks} clocks, a frame every {row.interval}; about "
            f"{cells.luts:.0f} LUTs, {_counted(cells.multipliers, 'multiplier')}, "
            f"{_counted(cells.block_rams, 'block RAM')}, {self.device.text(row)}"
            f"{f'; {_apart(row)}' if row.coarse else ''}"
        )


def choose(task: SizingTask, demand: Demand, device: Device) -> Choice:
    """The design of a task that meets a demand and takes the least of a device.

    A coarse design is taken only where no other one meets it.
    """
    found = all_sized(task)
    rows = [one for one in found if isinstance(one, Sized)]
    if not rows:
        raise InputError(
            "hardware.design: got 'auto', expected networks that some design takes: "
            + "; ".join(
                f"{one.candidate.name}: {one.reason}" for one in found if isinstance(one, Refused)
            )
        )
    rows.sort(key=lambda row: (device.price(row), row.clocks))
    fit = [row for row in rows if not demand.misses(row.clocks, row.interval)]
    if not fit:
        nearest = min(rows, key=lambda row: demand.excess(row.clocks, row.interval))
        name = f"the nearest design, {nearest.candidate.name},"
        demand.refuse(nearest.network, name)
    row = next((one for one in fit if not one.coarse), fit[0])
    place = rows.index(row)
    speed = attrgetter("clocks" if demand.clocks or not demand.interval else "interval")
    faster = [one for one in rows if speed(one) < speed(row)]
    return Choice(
        row, demand, device, rows[place - 1] if place else None, faster[0] if faster else None
    )


def _apart(row: Sized) -> str:
    return f"errors of 2^-13 times {row.mean:.3g} on average"


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
