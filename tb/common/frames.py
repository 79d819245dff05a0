"""Frames of samples, with the control signals that CONTROLLER 1 would give to the nodes."""

import numpy as np

from tb.common.bench import Recording
from tb.common.stimulus import spread


def node_timeline(rng: np.random.Generator, items: dict[str, np.ndarray], gap: float):
    """Good frames as columns: the samples, what comes with them, and the control signals.

    items: For each port its values, shape (frames, inputs), which stand in the clock of the sample.
    gap: Probability of an idle clock before each sample.
    """
    count, inputs = items["in_data"].shape
    columns = {name: values.ravel() for name, values in items.items()}
    place = np.tile(np.arange(inputs), count)
    drive = spread(rng, columns | {"place": place}, "valid", gap, tail=6)
    valid, place = drive.pop("valid").astype(bool), drive.pop("place")
    drive["accumulate"] = np.roll(valid, 2).astype(np.int64)
    drive["preset"] = np.roll(valid & (place == 0), 2).astype(np.int64)
    drive["capture"] = np.roll(valid & (place == inputs - 1), 3).astype(np.int64)
    return drive


def captured_rows(recording: Recording, inputs: int):
    """The rows of the samples, shape (frames, inputs), and the rows from which sums are held.

    A product enters the accumulator two clocks after its sample. ``capture`` takes the sum that the
    accumulator holds.
    """
    entered = recording.rows("accumulate") - 2
    first = recording.rows("preset") - 2
    assert np.array_equal(entered[::inputs], first), "preset does not open every frame"
    return entered.reshape(-1, inputs), recording.rows("capture") + 1
