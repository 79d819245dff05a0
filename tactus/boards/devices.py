"""The devices for which free tools make bitstreams."""

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


def speeds_of(family: str, device: str) -> tuple[int, ...]:
    """The speed grades of a device; none if its family has none."""
    return FAST_SPEEDS if device.startswith(FAST) else SPEEDS[family]
