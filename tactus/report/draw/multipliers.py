"""Draws the multipliers of the folded networks: as the thesis prints them, and as ours take."""

from collections.abc import Sequence
from dataclasses import dataclass

from tactus.report.draw.drawing import ACCENT, FAINT, box, picture, text

ROW, BAR, LEFT, WIDE = 40.0, 12.0, 110.0, 420.0


@dataclass(frozen=True)
class Pair:
    """A network and its multipliers, in percent of those of the device.

    ruled: Three for each printed hidden node and one for each network.
    count: What ours takes: none for the factor of a network that is a power of two.
    """

    name: str
    printed: float
    ruled: float
    count: int
    ours: float


def drawn(pairs: Sequence[Pair], of: int) -> str:
    """Two bars for each network, one below the other."""
    body = [text((6, 18), f"Multipliers of the {of} of the thesis' device", 13, font_weight="bold")]
    for n, pair in enumerate(pairs):
        top = 34 + n * ROW
        body.append(text((6, top + BAR + 4), pair.name))
        shown = (
            (pair.printed, FAINT, f"{pair.printed:g} %, printed"),
            (pair.ours, ACCENT, f"{pair.ours:.1f} %, {pair.count} multipliers of ours"),
        )
        for k, (share, colour, words) in enumerate(shown):
            y, width = top + k * BAR, WIDE * share / 100
            body.append(box((LEFT, y), (width, BAR - 1), fill=colour, stroke="none"))
            body.append(text((LEFT + width + 6, y + BAR - 2), words))
    said = f"Multipliers of the folded networks. {sentence(pairs)}"
    return picture(said, (640, 44 + ROW * len(pairs)), body, widest=720)


def sentence(pairs: Sequence[Pair]) -> str:
    """The printed shares, and those by the rule of our blocks."""
    named = [f"{pair.ruled:.1f} for {pair.name} (printed {pair.printed:g})" for pair in pairs]
    return (
        "By the rule of our blocks, three multipliers for each hidden node and one for a network, "
        "the hidden nodes that the thesis prints take these % of the multipliers: "
        f"{'; '.join(named)}. Ours save one where the factor of a network is a power of two."
    )
