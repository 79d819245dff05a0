"""Frames of right and wrong length, and what the twin of CONTROLLER 1 says of a recording."""

from collections.abc import Callable
from typing import Any

import numpy as np

from golden.layers.input_controller import FrameScan, InputController
from tb.common.bench import RESET_CLOCKS, Bench, Recording

LEAST_FRAMES = 30


def random_lengths(rng: np.random.Generator, inputs: int, samples: int) -> np.ndarray:
    """The ``last`` flags of frames, of which two in three have the right length.

    There are at least ``samples`` samples and at least ``LEAST_FRAMES`` frames, so that long frames
    too come in both kinds.
    """
    last: list[int] = []
    count = 0
    while len(last) < samples or count < LEAST_FRAMES:
        right = rng.random() < 2 / 3
        count += 1
        length = inputs if right else int(rng.integers(1, 3 * inputs + 1))
        last += [0] * (length - 1) + [1]
    return np.array(last, dtype=np.int64)


def whole(frames: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The elements and ``last`` flags of good frames."""
    last = np.zeros(frames.shape, dtype=np.int64)
    last[:, -1] = 1
    return frames.ravel(), last.ravel()


class Scans:
    """Which clock after a reset each row is, and which clock of a scan.

    A scan begins in the clock after a reset.
    """

    def __init__(self, recording: Recording, scan_clocks: int) -> None:
        self.marks = np.concatenate([[RESET_CLOCKS - 1], recording.resets()])
        self.rows = np.arange(RESET_CLOCKS, recording.clocks)
        self.since = self.rows - self.marks[np.searchsorted(self.marks, self.rows) - 1] - 1
        self.count = self.since % scan_clocks


def scan(
    controller: InputController, recording: Recording, last: str = "in_last"
) -> tuple[np.ndarray, FrameScan]:
    """The clocks of all samples that do not fall on a reset, and the twin's decision for each.

    ``last`` is the port that marks the last sample of a frame. After a reset the twin starts
    afresh, as the hardware does.
    """
    rows = np.setdiff1d(recording.rows("in_valid"), recording.resets())
    ends = np.isin(rows, recording.rows(last))
    since = np.searchsorted(recording.resets(), rows)
    parts = [
        controller.process(ends[since == epoch], rows[since == epoch]) for epoch in np.unique(since)
    ]
    return rows, FrameScan(
        *(
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("addr", "accept", "done", "error")
        )
    )


def yielding(
    recording: Recording,
    ended: np.ndarray,
    frames: np.ndarray,
    past: int,
    process: Callable[[np.ndarray], np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Which good frames yield results, and these results.

    The first ``past`` frames after each reset yield none. ``ended`` are the clocks of the last
    samples of the frames, and ``process`` is that of the twin.
    """
    if not past:
        return np.ones(len(frames), dtype=bool), process(frames)
    since = np.searchsorted(recording.resets(), ended)
    kept, results = np.zeros(len(frames), dtype=bool), [process(frames[:0])]
    for epoch in np.unique(since):
        inside = np.flatnonzero(since == epoch)
        kept[inside[past:]] = True
        results.append(process(frames[inside]))
    return kept, np.concatenate(results)


# A network, the rows of the first and of the last element of frames, and these frames.
Run = tuple[Any, np.ndarray, np.ndarray, np.ndarray]


def check_outputs(bench: Bench, recording: Recording, *runs: Run) -> None:
    """Compare the output stream with what networks compute from good frames.

    Outputs after the end of the recording are not expected, nor outputs of frames without a
    complete past, nor those between which and the begin of their frame a reset comes.
    """
    due = [np.empty((0, 3), dtype=np.int64)]
    of: list[np.ndarray] = []
    for network, started, ended, frames in runs:
        kept, results = yielding(recording, ended, frames, network.past, network.process)
        leave = ended[kept, np.newaxis] + np.array(network.output_clocks)
        final = np.zeros_like(leave)
        final[:, -1] = 1
        begun = np.repeat(started[kept], leave.shape[1])
        alive = recording.undisturbed(begun, leave.ravel() - 1) & (leave.ravel() < recording.clocks)
        due.append(np.stack([leave, results, final], axis=-1).reshape(-1, 3)[alive])
        of += [*np.repeat(frames[kept], leave.shape[1], axis=0)[alive]]
    rows, codes, last = np.concatenate(due).T
    bench.compare_stream(recording, rows, codes, last == 1, frame=of)
