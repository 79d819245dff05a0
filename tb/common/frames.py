"""Frames of samples with the controls that CONTROLLER 1 would give the nodes."""

from __future__ import annotations

import numpy as np

from tb.common.bench import Recording
from tb.common.stimulus import spread


def node_timeline(rng: np.random.Generator, frames: np.ndarray, gap: float):
    """Samples of good frames with address and controls, each in its clock."""
    count, inputs = frames.shape
    items = {"in_data": frames.ravel(), "addr": np.tile(np.arange(inputs), count)}
    drive = spread(rng, items, "valid", gap, tail=6)
    valid = drive.pop("valid").astype(bool)
    drive["accumulate"] = np.roll(valid, 2).astype(np.int64)
    drive["preset"] = np.roll(valid & (drive["addr"] == 0), 2).astype(np.int64)
    drive["capture"] = np.roll(valid & (drive["addr"] == inputs - 1), 3).astype(np.int64)
    return drive


def captured_frames(recording: Recording, inputs: int):
    """The frames that stood on the ports, and the rows from which their sums must be held.

    A product enters the accumulator two clocks after its sample; ``capture`` takes the sum that
    the accumulator holds.
    """
    entered = recording.rows("accumulate") - 2
    data = recording.signed("in_data", entered)
    addr = recording.unsigned("addr", entered)
    first = recording.rows("preset") - 2
    assert np.array_equal(entered[::inputs], first), "preset does not open every frame"
    assert np.array_equal(addr, np.tile(np.arange(inputs), len(first))), "addr out of order"
    return data.reshape(-1, inputs), recording.rows("capture") + 1
