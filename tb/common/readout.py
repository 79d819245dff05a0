"""Checks of what a readout shows besides its stream: held outputs, the winner and the profile."""

import numpy as np

from golden.numbers.precision import SIGNAL
from tb.common.bench import Bench, Recording
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


def check_values(bench: Bench, recording: Recording, readout) -> None:
    """Check the held outputs and the winner, where the readout has them."""
    if readout.holds:
        check_held(bench, recording)
    if readout.decides:
        check_winner(bench, recording, readout)


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


def winner_columns(recording: Recording, start: int) -> dict[str, np.ndarray]:
    """The ports of the winner as columns from clock ``start`` on, 0 where there is none."""
    at = recording.rows("winner_valid")
    columns = {name: np.zeros(recording.clocks - start, dtype=np.int64) for name in WINNER}
    for name, column in columns.items():
        column[at - start] = recording.unsigned(name, at)
    return columns


def check_held(bench: Bench, recording: Recording) -> None:
    """Check that each output is held, from the end of its frame to the next output of its kind."""
    ends, codes = frames_out(bench, recording)
    rows = recording.rows("out_valid")
    # The first output of a frame, or the first after a reset, is output 0.
    marks = np.sort(np.concatenate([[-1], recording.rows("out_last"), recording.resets()]))
    before = marks[np.searchsorted(marks, rows) - 1]
    kind = np.arange(len(rows)) - np.searchsorted(rows, before, side="right")
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
