"""The shipped scenes and those for comparison, and the clocks of a frame."""

from golden.networks.network import Network
from tactus.scene import Scene, comparison_names, load_scene, scene_names

FAMILY = "xc2v"


def clocks_per_frame(design: Network) -> int:
    """The clocks from the first sample of a frame, which counts too, to its last output.

    One element of a frame comes in each clock; for a parallel network all come at once. The frame
    of an instrument begins with its scan.
    """
    return design.frame_clocks + design.output_clocks[-1]


def scenes() -> list[Scene]:
    """The shipped scenes, then those for comparison."""
    return [load_scene(name) for name in [*scene_names(), *comparison_names()]]
