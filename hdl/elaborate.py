"""From a twin's constants to a MyHDL design with ports."""

from __future__ import annotations

import importlib

from myhdl import ResetSignal
from myhdl._block import _Block

from golden.block import Block
from golden.networks.hybrid import Hybrid
from golden.precision import SIGNAL
from hdl.common.signals import fixed, flag
from hdl.networks.hybrid import hybrid


def elaborate(spec: Hybrid) -> _Block:
    """The network of ``spec`` with fresh signals on its ports."""
    return hybrid(
        flag(),
        ResetSignal(0, active=1, isasync=False),
        flag(),
        fixed(SIGNAL),
        flag(),
        flag(),
        fixed(SIGNAL),
        flag(),
        flag(),
        spec=spec,
    )


def latency(spec: Block) -> int:
    """Latency in clocks that the hardware block of ``spec`` publishes."""
    module = importlib.import_module(f"hdl.{spec.area}.{spec.block}")
    return int(getattr(module, spec.block).latency(spec))
