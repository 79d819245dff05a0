"""Checks of what a readout shows besides its stream: held outputs, the winner and the profile."""

import numpy as np

from golden.numbers.precision import SIGNAL
from tb.common.bench import RESET_CLOCKS, Bench, Recording
from tb.common.profile import check_profile

WINNER = ["winner_valid", "winner_index", "winner_margin"]
PROFILE = ["profile_valid", "profile_x", "profile_y", "profile_last"]


def ports(readout) -> list[str]:
    """The ports of a readout's twin that are checked here."""
    held = [f"held_{i}" for i in range(readout.outputs)] if readout.holds else []
    return held + (WINNER if readout.decides else []) + (PROFILE if readout.load_profile else [])


def frames_out(bench: Bench, recording: Recording) -> tuple[np.ndarray, np.ndarray]:
    """The complete frames on the output stream: their last rows and their codes.

    Other checks compare these. A frame that ends with the recording is left out, because nothing is
    recorded after it.
    """
    ends = recording.rows("out_last")
    ends = ends[ends < recording.clocks - 1]
    rows = recording.rows("out_valid")
    at = np.searchsorted(rows, ends)[:, np.newaxis] + np.arange(1 - bench.twin.outputs, 1)
    return ends, recording.signed("out_data", rows)[at]


def check_shown(bench: Bench, recording: Recording, readout) -> np.ndarray:
    """Check the held outputs, the winner and the profile, where the readout has them.

    Returns: What ``check_profile`` returns, or nothing.
    """
    if readout.holds:
        check_held(bench, recording)
    if readout.decides:
        check_winner(bench, recording, readout)
    if readout.load_profile:
        return check_drawn(bench, recording, readout)
    return np.empty(0, dtype=np.int64)


def check_winner(bench: Bench, recording: Recording, readout) -> None:
    """Check index and margin of every frame of outputs, and that none come at another time."""
    ends, results = frames_out(bench, recording)
    kept = recording.undisturbed(ends, ends)
    at, frames = ends[kept] + readout.argmax.latency, results[kept]
    index, margin = readout.argmax.process(frames)
    bench.compare("clocks of winner_valid", recording.rows("winner_valid"), at)
    got = recording.unsigned("winner_index", at)
    bench.compare("winner_index", got, index, clock=at, outputs=frames)
    got = recording.unsigned("winner_margin", at)
    bench.compare("winner_margin", got, margin, clock=at, outputs=frames)


def columns(bench: Bench, recording: Recording, ports: list[str]) -> dict[str, np.ndarray]:
    """The ports of a stream behind the initial reset, 0 where the first one, its flag, is low."""
    at = recording.rows(ports[0])
    found = {name: np.zeros(recording.clocks, dtype=np.int64) for name in ports}
    for name, column in found.items():
        column[at] = bench.read(recording, name, at)
    return {name: column[RESET_CLOCKS:] for name, column in found.items()}


def places(recording: Recording, rows: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """The place in its frame of each output, from the rows of all outputs and of the last ones.

    The first output of a frame, or the first after a reset, is output 0.
    """
    marks = np.sort(np.concatenate([[-1], ends, recording.resets()]))
    before = marks[np.searchsorted(marks, rows) - 1]
    return np.arange(len(rows)) - np.searchsorted(rows, before, side="right")


def check_held(bench: Bench, recording: Recording) -> None:
    """Check that each output is held, from the end of its frame to the next output of its kind."""
    ends, codes = frames_out(bench, recording)
    rows = recording.rows("out_valid")
    kind = places(recording, rows, recording.rows("out_last"))
    for i in range(bench.twin.outputs):
        # An output in the clock of a reset is held too. None of these benches ends in a reset.
        starts = np.append(rows[kind == i], recording.clocks - 1)
        until = starts[np.searchsorted(starts, ends, side="right")]
        for when, at in (("first", ends + 1), ("until the next", until)):
            got = recording.signed(f"held_{i}", at)
            bench.compare(f"held_{i}, {when}", got, codes[:, i], clock=at)


def extremes(bench: Bench, readout, times: int) -> np.ndarray:
    """Of many random frames, those with the highest and the deepest profile, and their past.

    Each frame is repeated ``times`` times, because of the frames that come during a ramp only the
    last is drawn.
    """
    codes = bench.rng.integers(SIGNAL.low, SIGNAL.high + 1, (4096, readout.inputs))
    _, heights = readout.profile(readout.process(codes))
    ends = (heights.max(axis=1).argmax(), heights.min(axis=1).argmin())
    return np.concatenate([np.tile(codes[at : at + readout.past + 1], (times, 1)) for at in ends])


def check_drawn(bench: Bench, recording: Recording, readout) -> np.ndarray:
    """Check the profile of every frame of outputs, and return what ``check_profile`` returns."""
    ends, results = frames_out(bench, recording)
    kept = recording.undisturbed(ends, ends)
    latency = readout.load_profile.latency
    return check_profile(
        bench, recording, "profile", ends[kept] + 1, results[kept], latency, readout.profile
    )
