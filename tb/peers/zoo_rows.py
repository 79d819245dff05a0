"""The QONNX model zoo: a published network of several layers, in our hardware.

The network is quantised, so ours computes its decisions exactly. The file does not say how samples
come: here they are codes of a signal, which stand for numbers from -8 to 8.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from golden.input_error import InputError
from golden.network_files.network_file import load_network
from golden.networks.adder_graph import AdderGraph
from golden.networks.settings import Settings
from golden.precision import SIGNAL
from golden.scene.scale import Scale, on_signals
from tb.peers.cloned import cloned
from tb.peers.comparison import JETS, Row, Task
from tb.peers.ours import row

REPOSITORY = "https://github.com/fastmachinelearning/qonnx_model_zoo"
COMMIT = "d44721b3d8dc279078f9a72a069cfe3a628dc055"
VERSION = f"QONNX model zoo {COMMIT[:7]}"
FILES = {"jets.onnx": "models/JetTagging/QKeras_hls4ml_3layer/qkeras_jettagging.onnx"}
SHAPE = (16, 64, 32, 32, 5)
# The accuracy in percent that its authors publish.
RIGHT = 76.2
# What a signal of 1 stands for. No output can be so large.
SAMPLE, OUTPUT = Scale(0.0, 8.0), Scale(0.0, 32.0)
FRAMES = 2000


def brought(folder: Path) -> Path:
    """A folder with the network; see ``cloned``."""
    return cloned(folder, REPOSITORY, COMMIT, FILES)


def design_of(network: Path) -> AdderGraph:
    """Our hardware of the network in a file."""
    scales = [SAMPLE] * SHAPE[0], [OUTPUT] * SHAPE[-1]
    real = on_signals(load_network(network, SHAPE), *scales)
    design = AdderGraph.of([real], Settings(activation=AdderGraph.known_activations[0]))
    frames = np.random.default_rng(1).integers(SIGNAL.low, SIGNAL.high + 1, (FRAMES, SHAPE[0]))
    expected = real.process(SIGNAL.to_real(frames))
    off = np.abs(SIGNAL.to_real(design.process(frames)) - expected).max()
    if off > 2.0 ** -(SIGNAL.frac + 1):
        raise InputError(f"{network}: outputs are off by {off}, expected half a code at most")
    return design


def rows(place: Path, _tasks: Mapping[str, Task], _folder: Path) -> Iterator[Row]:
    """The row of the network."""
    (name,) = FILES
    shape = ":".join(map(str, SHAPE))
    yield row(JETS, design_of(place / name), f", {shape}", right=RIGHT)
