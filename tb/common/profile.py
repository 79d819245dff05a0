"""When the points of a profile appear, and the check that they are right."""

from collections.abc import Callable

import numpy as np

from tb.common.bench import Bench, Recording


def ramps(recording: Recording, entered: np.ndarray, latency: int, points: int):
    """For every point that must appear: the number of its frame, its own number, and its row.

    entered: The rows in which the results of a frame enter.
    latency: The clocks from the results to the first point, and from each point to the next.
    points: The number of points of a ramp.
    """
    resets = set(recording.resets().tolist())
    frame_at = {int(row): number for number, row in enumerate(entered)}
    found: list[tuple[int, int, int]] = []
    waiting, free = None, 0
    for row in range(recording.clocks):
        if row in resets:
            while found and found[-1][2] > row:
                found.pop()
            waiting, free = None, 0
            continue
        if waiting is not None and row >= free:
            # A ramp starts in the clock after the results entered, or after the last point before
            # it.
            rows = row - 1 + latency * np.arange(1, points + 1)
            found += [(waiting, number, int(at)) for number, at in enumerate(rows)]
            waiting, free = None, int(rows[-1]) + 1
        waiting = frame_at.get(row, waiting)
    found = [point for point in found if point[2] < recording.clocks]
    return np.array(found, dtype=np.int64).reshape(-1, 3).T


def check_profile(
    bench: Bench,
    recording: Recording,
    prefix: str,
    entered: np.ndarray,
    frames: np.ndarray,
    latency: int,
    profile: Callable,
) -> np.ndarray:
    """Compare the points on the ports ``<prefix>_valid``, ``_x``, ``_y`` and ``_last``.

    entered, frames: The rows in which results enter, and the results.
    latency: The latency of load_profile.
    profile: A function from frames to positions and heights.

    Returns: The numbers of the frames that were drawn, once for each point.
    """
    positions, heights = profile(frames)
    frame, number, rows = ramps(recording, entered, latency, len(positions))
    found = recording.rows(f"{prefix}_valid")
    bench.compare(f"clocks of {prefix}_valid", found, rows)
    last = rows[number == len(positions) - 1]
    bench.compare(f"clocks of {prefix}_last", recording.rows(f"{prefix}_last"), last)
    expected = {"x": positions[number], "y": heights[frame, number]}
    # A point with a reset in its last clock is not valid, but it changes the data.
    stays = np.flatnonzero(recording.undisturbed(rows[:-1], rows[1:]))
    for name, codes in expected.items():
        port = f"{prefix}_{name}"
        context = {"frame": frames[frame], "number": number}
        bench.compare(port, recording.signed(port, rows), codes, **context)
        until = recording.signed(port, rows[stays + 1] - 1)
        bench.compare(f"{port} before the next", until, codes[stays])
    return frame
