"""A VHDL package with the recorded frames and the outputs that the hardware gives for them."""

from string import Template

import numpy as np

from golden.networks.network import Network
from golden.numbers.fixed import Codes

# Longer recordings are cut to these lengths: any simulator elaborates so many constants in a
# second, and plays scans of so many clocks in a minute.
FRAMES = 4096
CLOCKS = 48_000

_TEXT = Template("""\
-- Recorded frames of scene $scene: sample codes and the output codes of the bit-true model.

package ${top}_vectors is

    constant inputs: positive := $inputs;
    constant outputs: positive := $outputs;
    constant frames: positive := $frames;
$past
    type codes is array (natural range <>) of integer;
$image
    -- One line a frame.
    constant samples: codes(0 to $last_sample) := (
$samples
    );

    constant results: codes(0 to $last_result) := (
$results
    );
$winners
end package ${top}_vectors;
""")


_PAST = Template("""\
    -- The first frames, of which no outputs come: those after them need them.
    constant past: positive := $past;
""")

_IMAGE = Template("""
    -- The image that makes the hardware run this scene, as it is loaded.
    constant image: codes(0 to $last) := (
$bytes
    );
""")


_WINNERS = Template("""
    -- Index and margin of the largest output of each frame.
    constant winners: codes(0 to $last) := (
$winners
    );
""")


def winners_of(design: Network, results: Codes) -> Codes | None:
    """Index and margin of the largest output of each frame, where the hardware gives them."""
    return np.stack(design.argmax.process(results), axis=1) if design.argmax else None


def vectors(
    scene: str,
    top: str,
    samples: Codes,
    results: Codes,
    past: int = 0,
    image: bytes = b"",
    winners: Codes | None = None,
) -> str:
    """The text of the package ``<top>_vectors``.

    samples, results: shape (frames, inputs), (frames - past, outputs).
    image: The image that is loaded before the first frame; empty where none is.
    winners, shape (frames - past, 2): See ``winners_of``.
    """
    decided = ""
    if winners is not None:
        decided = _WINNERS.substitute(last=winners.size - 1, winners=_table(winners))
    return _TEXT.substitute(
        scene=scene,
        top=top,
        inputs=samples.shape[1],
        outputs=results.shape[1],
        frames=len(samples),
        past=_PAST.substitute(past=past) if past else "",
        last_sample=samples.size - 1,
        last_result=results.size - 1,
        samples=_table(samples),
        results=_table(results),
        image=_image(image),
        winners=decided,
    )


def _image(image: bytes) -> str:
    """The constant that holds the image, in lines of 16 bytes."""
    if not image:
        return ""
    places = [f"{place} => {byte}" for place, byte in enumerate(image)]
    lines = (", ".join(places[at : at + 16]) for at in range(0, len(places), 16))
    return _IMAGE.substitute(
        last=len(image) - 1, bytes=",\n".join(f"        {line}" for line in lines)
    )


def _table(codes: Codes) -> str:
    """The codes with named association: without names a list of one value is no aggregate."""
    columns = codes.shape[1]
    lines = (
        ", ".join(f"{row * columns + c} => {code}" for c, code in enumerate(frame))
        for row, frame in enumerate(codes.tolist())
    )
    return ",\n".join(f"        {line}" for line in lines)
