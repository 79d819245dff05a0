"""Builds a network of two layers with NNgen; the Python that has NNgen runs it.

``python nngen_network.py FOLDER`` reads ``given.json`` there and writes ``answer.json`` and the
Verilog. It imports nothing of this project.

NNgen has no tanh, so ``tanh(q) = 2 sigmoid(2 q) - 1`` is used. The 2 and the 1 go into scale and
biases, and the codes of the weights stay as they are. NNgen's sigmoid is a table of a whole sum,
without interpolation. The hardware reads samples and weights from a memory behind an AXI port, and
writes the outputs there. In simulation this memory is NNgen's own model, with its shortest delays.
"""

import json
import os
import re
import sys
from pathlib import Path
from typing import Any

import nngen as ng
import numpy as np
import veriloggen.thread as vthread
import veriloggen.types.axi as axi
from veriloggen import Delay, Module, Not, Seq, Systask, simulation

SIGNAL_FRAC = 13
# The address bits of the table, and the sum at which it ends: sigmoid(8) corresponds to tanh(4).
# One bit less would nearly double the errors.
ADDRESS, REACH = 13, 8
# The fraction bits of 2 q and of the sigmoid. With more, biases would not fit into their 32 bits.
HIDDEN_FRAC, SIGMOID_FRAC = 15, 13
# In the memory each array begins at a multiple of so many bytes.
CHUNK = 64
MEMORY_WORDS = 1 << 16
SIMULATED = 4
# The clocks from an address to its word, and no pauses, as with a memory on the same chip.
FASTEST = {"write_delay": 1, "read_delay": 1, "sleep_interval": 0}


def network(given: dict[str, Any]) -> tuple[Any, Any]:
    """The samples and the outputs of the network as NNgen's operators."""
    first, second = given["first"], given["second"]
    weights, biases = np.array(first["weights"]), np.array(first["biases"])
    samples = ng.placeholder(ng.int16, shape=(1, weights.shape[1]), name="samples")
    sums, bias = matmul(samples, weights, "hidden", ng.int32)
    # 2 q has the same code as q with one fraction bit less. NNgen cuts an address, so half a step
    # is added.
    frac = first["frac"] + SIGNAL_FRAC - 1
    half = REACH << (frac - ADDRESS)
    bias.set_value((biases << SIGNAL_FRAC) + half)
    sums.attribute(cshamt_out=frac - HIDDEN_FRAC)
    sums.scale_factor = float(1 << HIDDEN_FRAC)
    r = ng.sigmoid(
        sums,
        lut_addrwidth=ADDRESS,
        lut_clip=float(REACH),
        range_rate=2.0 ** (SIGMOID_FRAC - 15),
        dtype=ng.int16,
    )
    weights, biases = np.array(second["weights"]), np.array(second["biases"])
    outputs, bias = matmul(r, weights, "outputs", ng.int16)
    bias.set_value((biases - weights.sum(axis=1)) << (SIGMOID_FRAC - 1))
    outputs.attribute(cshamt_out=SIGMOID_FRAC + second["frac"] - SIGNAL_FRAC - 1)
    return samples, outputs


def matmul(inputs: Any, weights: Any, name: str, dtype: Any) -> tuple[Any, Any]:
    """The sums of a layer, rounded to ``dtype``, and its biases, whose values the caller sets."""
    held = ng.variable(ng.int32, shape=weights.shape, name=f"{name}_weights")
    held.set_value(weights)
    bias = ng.variable(ng.int32, shape=(len(weights),), name=f"{name}_biases")
    sums = ng.matmul(
        inputs,
        held,
        bias=bias,
        transposed_b=True,
        dtype=dtype,
        sum_dtype=ng.int64,
        name=name,
    )
    return sums, bias


def bench(hardware: Any, samples: Any, outputs: Any, frame: Any) -> Any:
    """A test bench in NNgen's style that runs a frame from memory and prints clocks and outputs."""
    words = ng.export_ndarray([outputs], CHUNK)
    at = rounded(samples.addr + samples.memory_size)
    free = rounded(rounded(at + len(words)) + outputs.memory_size)
    memory_words = np.zeros([MEMORY_WORDS], dtype=np.int64)
    axi.set_memory(memory_words, frame, 32, 16, samples.addr, 2)
    axi.set_memory(memory_words, words, 32, 8, at)
    module = Module("test")
    module.copy_params(hardware)
    ports = module.copy_sim_ports(hardware)
    clock, running = ports["CLK"], ports["RESETN"]
    reset = module.Wire("RST")
    reset.assign(Not(running))
    memory = axi.AxiMemoryModel(
        module,
        "memory",
        clock,
        reset,
        memimg=memory_words,
        memimg_name="memory.hex",
        memimg_datawidth=32,
        **FASTEST,
    )
    memory.connect(ports, "maxi")
    control = vthread.AXIMLite(module, "control", clock, reset, noio=True)
    control.connect(ports, "saxi")
    clocks = module.Reg("clocks", 32, initval=0)
    Seq(module, "count", clock, reset)(clocks.inc())

    # NNgen turns this function into hardware.
    def drive():  # type: ignore[no-untyped-def]
        for _i in range(100):
            pass
        ng.sim.set_global_addrs(control, free)
        began = clocks.value
        ng.sim.start(control)
        ng.sim.wait(control)
        ended = clocks.value
        print("clocks %d" % (ended - began))  # noqa: UP031
        for i in range(4):
            code = memory.read_word(i, outputs.addr, 16)
            print("output %d" % code)  # noqa: UP031
        vthread.finish()

    vthread.Thread(module, "driven", clock, reset, drive).start()
    module.Instance(
        hardware, "dut", module.connect_params(hardware), module.connect_ports(hardware)
    )
    simulation.setup_clock(module, clock, hperiod=5)
    first = simulation.setup_reset(module, running, module.make_reset(), period=100, polarity="low")
    first.add(Delay(1000000), Systask("finish"))
    return module


def rounded(address: int) -> int:
    """The next multiple of ``CHUNK``."""
    return -(-address // CHUNK) * CHUNK


def main() -> None:
    folder = Path(sys.argv[1]).resolve()
    # The tools write all their files into the current folder.
    os.chdir(folder)
    given = json.loads(Path("given.json").read_text(encoding="utf-8"))
    frames = np.array(given["frames"])
    samples, outputs = network(given)
    model = [ng.eval([outputs], samples=frames[n : n + 1])[0][0] for n in range(len(frames))]
    hardware = ng.to_veriloggen([outputs], "peer", silent=True, config={"maxi_datawidth": 32})
    Path("peer.v").write_text(hardware.to_verilog(), encoding="utf-8")
    clocks, simulated = [], []
    for n in range(SIMULATED):
        test = bench(hardware, samples, outputs, frames[n : n + 1])
        printed = simulation.Simulator(test, sim="iverilog").run(outputfile="bench.vvp")
        clocks += [int(text) for text in re.findall(r"^clocks +(\d+)", printed, re.M)]
        simulated.append([int(text) for text in re.findall(r"^output +(-?\d+)", printed, re.M)])
    answer = {
        "words": 1 << ADDRESS,
        "clocks": max(clocks),
        "outputs": np.array(model).tolist(),
        "simulated": simulated,
    }
    Path("answer.json").write_text(json.dumps(answer), encoding="utf-8")


if __name__ == "__main__":
    main()
