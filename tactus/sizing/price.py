"""What hardware costs: its share of a device, or prices that a scene gives."""

from dataclasses import dataclass

from tactus.sizing.candidates import Cells


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
class Price:
    """The price of a LUT, of a multiplier and of a block RAM.

    lut, multiplier, block_ram: In any unit. Without prices of a scene, each is its share of all
        that the device has, in per cent.
    shares: Whether they are these shares.
    """

    device: Device
    lut: float
    multiplier: float
    block_ram: float
    shares: bool = True

    def of(self, cells: Cells) -> float:
        """The price of what a design takes."""
        parts = (
            self.lut * cells.size.luts,
            self.multiplier * cells.multipliers,
            self.block_ram * cells.block_rams,
        )
        return sum(parts)

    def text(self, cells: Cells) -> str:
        """A price for a reader."""
        found = self.of(cells)
        text = f"{found:.3g} % of {self.device.name}" if self.shares else f"a price of {found:.4g}"
        return text if self.fits(cells) else f"{text}, in which it does not fit"

    def fits(self, cells: Cells) -> bool:
        """Whether the device has all that a design takes, as far as prices are its shares."""
        device = self.device
        pairs = (
            (cells.size.luts, device.luts),
            (cells.multipliers, device.multipliers),
            (cells.block_rams, device.block_rams),
        )
        return not self.shares or all(taken <= there for taken, there in pairs)


def shares_of(name: str = DEFAULT) -> Price:
    """The prices that are shares of a device, in per cent; see ``Price``."""
    device = DEVICES[name]
    shares = 100 / device.luts, 100 / device.multipliers, 100 / device.block_rams
    return Price(device, *shares)


DEFAULT_PRICE = shares_of()
