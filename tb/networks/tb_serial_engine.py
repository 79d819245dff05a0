"""serial_engine, a whole scene without a multiplier, against its twin.

Sweeps: all recorded frames of the scene, and the other frames of the bench of engine.
Drives: as that bench does.
Checks: every output, ``out_last`` and ``frame_error`` bit for bit in its clock.
Does not prove: how accurate the network is (the report of `make demo` shows that).
"""

from tb.common.case_library import SERIAL_ENGINES
from tb.common.network import (
    corners_and_random,
    recorded,
    reset_at_every_clock,
    resets_in_mid_frame,
    wrong_lengths,
)

NAMES = ("rails-serial", "least-serial", "chain-serial", "layers-serial", "small-tables-serial")
CASES = {name: SERIAL_ENGINES[name] for name in NAMES}

__all__ = [
    "corners_and_random",
    "recorded",
    "reset_at_every_clock",
    "resets_in_mid_frame",
    "wrong_lengths",
]
