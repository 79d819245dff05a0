"""The frames of a certificate: packages for the VHDL test bench, files for the Verilog one."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.input_error import InputError
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from tactus.export.exporter import compile_order
from tactus.export.handover import (
    CLOCKS,
    FRAMES,
    hex_files,
    plain_name,
    vectors,
    verilog_bench,
    winners_of,
)
from tactus.export.ports import read_ports
from tactus.rig.smooth_map import thinned
from tactus.scene import Scene

# Random frames, where no number is given; fewer where a frame takes thousands of clocks.
RANDOM = 200
LEAST_RANDOM = 5


@dataclass(frozen=True)
class PlayedFrames:
    """The frames that are played.

    recorded, random, shape (frames, inputs): Codes of samples: recorded frames, and frames drawn
        from all codes with equal probability.
    seed: The seed of the random frames.
    left: The number of recorded frames that are not played.
    """

    recorded: Codes
    random: Codes
    seed: int
    left: int = 0

    def parts(self, past: int) -> Iterator[Codes]:
        """The frames in lengths that every simulator elaborates.

        Of the first ``past`` frames of a part no outputs come, so they are the last ones of the
        part before.
        """
        frames = np.concatenate([self.recorded, self.random])
        step = FRAMES - past
        for start in range(0, max(1, len(frames) - past), step):
            yield frames[start : start + step + past]


def frames_of(
    scene: Scene, design: Network, random: int | None, seed: int, recorded: int | None = None
) -> PlayedFrames:
    """The frames for a scene.

    Without a number of ``random`` frames there are as many as usual, and without one of
    ``recorded`` frames there are all; fewer are taken in equal distances from the whole recording.
    """
    if random is None:
        random = max(LEAST_RANDOM, min(RANDOM, CLOCKS // design.interval))
    drawn = np.random.default_rng(seed).integers(
        SIGNAL.low, SIGNAL.high + 1, (random, design.inputs)
    )
    every = np.concatenate(scene.vectors().recordings)
    played = every if recorded is None else thinned(every, recorded)
    if len(played) + random <= design.past:
        raise InputError(
            f"RECORDED={len(played)} FRAMES={random}: got {len(played) + random} frames, expected "
            f"more than {design.past}, for which the window of {scene.name} waits"
        )
    return PlayedFrames(played, drawn, seed, len(every) - len(played))


def write_recordings(scene: Scene, design: Network, frames: PlayedFrames, folder: Path) -> None:
    """Write ``bench/vhdl`` and ``bench/verilog`` below a folder that holds ``design``."""
    name, top = plain_name(scene.name), design.entity
    for number, samples in enumerate(frames.parts(design.past), start=1):
        place = folder / "bench" / "verilog" / str(number)
        results, winners = _write_verilog(design, samples, place)
        vhdl = folder / "bench" / "vhdl" / str(number)
        vhdl.mkdir(parents=True)
        (vhdl / f"{top}_vectors.vhd").write_text(
            vectors(name, design, samples, results, winners),
            encoding="utf-8",
        )
    exported = folder / "design" / "verilog"
    last = compile_order(exported)[-1]
    ports = read_ports(design, (exported / last).read_text(encoding="utf-8"), "verilog")
    (folder / "bench" / "verilog" / f"{top}_tb.v").write_text(
        verilog_bench(name, design, ports, FRAMES), encoding="utf-8"
    )


def _write_verilog(design: Network, samples: Codes, place: Path) -> tuple[Codes, Codes | None]:
    """Write a recording for the Verilog test bench; return the outputs, and the winners if any."""
    results = design.process(samples)
    winners = winners_of(design, results)
    place.mkdir(parents=True)
    for file, text in hex_files(design, samples, results, winners).items():
        (place / file).write_text(text, encoding="ascii")
    (place / "due.txt").write_text(f"{len(results)}\n", encoding="ascii")
    return results, winners
