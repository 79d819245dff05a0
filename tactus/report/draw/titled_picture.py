"""A drawing with its title and a sentence on what it shows."""

import re
from dataclasses import dataclass

# The margins of the page at the left and right of a picture, in CSS pixels.
MARGINS = 32
# The page is at most 72 rem wide, even in a wider window.
WIDEST, ANY = 72 * 16, 1e5


@dataclass(frozen=True)
class Picture:
    """A drawing with a sentence below it.

    name: The file name without its suffix.
    svg: An ``<svg>`` element.
    sentence: Says what the drawing shows, or what its figures support.
    wide: Whether the drawing takes the whole width of a desktop. On a phone it scrolls sideways.
    """

    name: str
    title: str
    svg: str
    sentence: str
    wide: bool = False

    @property
    def scrolls_below(self) -> float:
        """The width of a window, in CSS pixels, below which the picture scrolls; 0 for never."""
        found = re.search(r"min-width:([\d.]+)px", self.svg) if self.wide else None
        if found is None:
            return 0.0
        least = float(found[1]) + MARGINS
        return least if least <= WIDEST else ANY
