"""Which share of the thesis' device a scene takes, compared with the printed one."""

from typing import Any

from golden.networks.network import Network
from tactus.scene import Scene, thesis_table
from tactus.synth.budget import Cells

# The networks of Table 6.1. Other scenes name their table themselves, for the errors, too.
SWING = {
    f"swing-{kind}{form}": f"swing.{kind}"
    for kind in ("single", "multiple", "cascade")
    for form in ("", "-thesis")
}


def shares(scene: Scene, design: Network, cells: Cells) -> dict[str, Any]:
    """Percentages of the thesis' device, and the printed percentages where there are any."""
    device = thesis_table("device")
    top = cells["xc2v"][design.entity]
    found = {
        "device": device["name"],
        "luts_percent": 100 * top["LUT"] / device["luts4"],
        "mult18x18_percent": 100 * top["multiplier"] / device["mult18x18"],
    }
    key = SWING.get(scene.name, scene.reference)
    if key:
        printed = thesis_table(key)
        found["thesis"] = {"table": key} | {
            name: printed[name] for name in ("luts_percent", "mult18x18_percent") if name in printed
        }
    return found
