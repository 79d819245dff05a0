"""From a twin's constants to the hardware block of the same name."""

import importlib

from golden.block import Block
from golden.networks.network import Network
from golden.networks.parallel import Parallel


def hardware(spec: Block):
    """The MyHDL block of ``spec``: one name, one address in every room."""
    return getattr(importlib.import_module(f"hdl.{spec.area}.{spec.block}"), spec.block)


def latency(spec: Block) -> int:
    """Latency in clocks that the hardware block of ``spec`` publishes."""
    return int(hardware(spec).latency(spec))


def frame_clocks(spec: Network) -> int:
    """Clocks from the first sample in to the last output out, both included."""
    behind = 0 if isinstance(spec, Parallel) else spec.outputs - 1
    return spec.input_controller.inputs + latency(spec) + behind
