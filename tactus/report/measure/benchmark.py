"""``python -m tactus.report.measure.benchmark SCENE``: measures the speed and the memory of the
twin.

The recorded frames are repeated to form one large batch. It is computed bit-true on one core, and
timed beside the same network in floating point. The speed depends on the machine, and the ratio of
the two hardly does.
"""

import resource
import sys
import time

import numpy as np

from golden.networks.arrangement import process_real
from golden.numbers.precision import SIGNAL
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.scene import load_scene

FLOAT_CHUNK = 4096


def main() -> None:
    arguments = arguments_of("bench", __doc__)
    scene = load_scene(arguments.scene)
    design = scene.twin().core
    recorded = scene.vectors().codes
    stop_if_dry_run(f"measure the twin of scene {scene.name} on {arguments.frames} frames")
    frames = np.resize(recorded, (arguments.frames, recorded.shape[1]))
    design.process(recorded)  # fills the tables of activations, which later calls share

    before = _peak_megabytes()
    started = time.perf_counter()
    results = design.process(frames)
    bit_true = len(frames) / (time.perf_counter() - started)
    grown = _peak_megabytes() - before - results.nbytes / 2**20

    networks, activation = scene.networks(), scene.scheme.real
    started = time.perf_counter()
    for start in range(0, len(frames), FLOAT_CHUNK):
        samples = SIGNAL.to_real(frames[start : start + FLOAT_CHUNK])
        process_real(scene.arrangement, networks, samples, activation)
    real = len(frames) / (time.perf_counter() - started)

    print(
        f"{scene.name} {scene.describe()} {scene.precision.name}: {len(frames)} frames, bit-true "
        f"{bit_true:,.0f} a second, float {real:,.0f} a second, ratio {bit_true / real:.2f}; "
        f"memory beside frames and results {max(grown, 0):.0f} MiB"
    )


def _peak_megabytes() -> float:
    """The largest memory that this process has used so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    sys.exit(run(main))
