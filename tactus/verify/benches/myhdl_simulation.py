"""Simulates a network in MyHDL itself, before any conversion.

This is the third simulation beside those of VHDL and Verilog, and the only one that checks the
bounds of every signal.
"""

import time
from collections.abc import Iterator

import numpy as np
from myhdl import Simulation, StopSimulation, delay, instance

from golden.networks.network import Network
from golden.numbers.fixed import Codes
from hdl.common.lookup import hardware
from tactus.export.hierarchy import port_signals

# The inputs of one clock: the data, one code or a frame of codes, and whether a frame ends.
Clock = tuple[Codes, bool] | None


def simulate(design: Network, frames: Codes) -> tuple[Codes, float]:
    """Play frames as close together as the design takes them.

    design: A network whose ``stream`` is ``serial`` or ``words``.
    frames: Sample codes, shape (frames, inputs). The slots of a cascade after them carry zeros.

    Returns results: Shape (frames - past, outputs), in the order in which they came out.
    Returns seconds: How long the simulation took, without the elaboration.
    """
    ports = port_signals(design)
    whole = design.stream == "words"
    clk, rst, error = (ports[name] for name in ("clk", "rst", "frame_error"))
    samples, results = ports["in_"], ports["out"]
    data, last = samples.data, None if whole else samples.last
    clocks = [None, *_clocks(design, frames, whole)]
    clocks += [None] * (design.output_clocks[-1] + 2)
    seen: list[int] = []

    @instance
    def drive():
        for t, clock in enumerate(clocks):
            rst.next = t == 0
            samples.valid.next = clock is not None
            if clock is not None and whole:
                for k, code in enumerate(clock[0]):
                    data[k].next = int(code)
            elif clock is not None:
                data.next, last.next = int(clock[0]), clock[1]
            yield delay(1)
            if t and error:
                raise RuntimeError(f"{design.entity}: a frame was refused in clock {t}")
            if t and results.valid:
                seen.extend(int(word) for word in (results.data if whole else [results.data]))
            clk.next = True
            yield delay(1)
            clk.next = False
            yield delay(1)
        raise StopSimulation

    simulation = Simulation(drive, hardware(design)(**ports, spec=design))
    started = time.perf_counter()
    simulation.run(quiet=1)
    seconds = time.perf_counter() - started
    due = len(frames) - design.past
    if len(seen) != due * design.outputs:
        raise RuntimeError(
            f"{design.entity}: got {len(seen)} results, expected {due * design.outputs}"
        )
    return np.array(seen, dtype=np.int64).reshape(due, design.outputs), seconds


def _clocks(design: Network, frames: Codes, whole: bool) -> Iterator[Clock]:
    """The input clock by clock."""
    elements = 1 if whole else design.input_controller.inputs
    for frame in frames:
        if whole:
            yield frame, True
        else:
            slots = np.zeros(elements - len(frame), dtype=np.int64)
            yield from ((code, False) for code in [*frame, *slots][:-1])
            yield [*frame, *slots][-1], True
        yield from [None] * (design.interval - elements)
