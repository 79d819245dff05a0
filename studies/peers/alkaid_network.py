"""Builds a network of two layers with alkaid, in every setting; the Python that has alkaid runs it.

``python alkaid_network.py FOLDER`` reads ``given.json`` there and writes ``answer.json`` and the
Verilog of the cheapest setting, with adders of two and of three operands. It imports nothing of
this project.

The sums are alkaid's: ``samples @ weights + biases`` on its symbolic arrays, with exact products.
tanh is that of our ``bipartite``, in alkaid's operations: a base and a correction, whose words are
in ``given.json``, are read from two tables per node and added. alkaid places registers by its own
estimate of delays alone. So that each table has a register before it and one behind it, and becomes
a block RAM, the network is made of four parts, and the tables are a part of their own.
"""

import itertools
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from alkaid.codegen import RTLModel
from alkaid.trace import FVArray, HWConfig, trace
from alkaid.trace.passes import add_surrogate, dead_code_elimin, fuse_ternary_adders
from alkaid.trace.pipeline import _split_comb_logic, _stages_to_fsm

SIGNAL_FRAC, Q_FRAC, R_FRAC, BASE_FRAC = 13, 14, 14, 17
# A code of q or of r stands for the middle of its step.
HALF = 2.0 ** -(R_FRAC + 1)
# In alkaid's estimate an adder takes 1.09, whatever its width: up to five between registers.
LEVELS = 5.5
COSTS = HWConfig(1, -1, -1)
METHODS = ("wmc", "mc", "wmc-pdc", "mc-pdc", "wmc-dc", "mc-dc")
# How many levels may be added to the shallowest graph; -1 means any number.
EXTRA_LEVELS = (-1, 2, 1, 0)


def signals(formats: Any) -> Any:
    """Symbolic inputs with the given numbers: lowest, highest and step of each."""
    low, high, step = np.array(formats, dtype=float).T
    return FVArray.from_lhs(low, high, step, hwconf=COSTS)


def following(logic: Any) -> Any:
    """Symbolic inputs for the part behind ``logic``."""
    return signals([(q.min, q.max, q.step) for q in logic.out_qint])


def summed(inputs: Any, given: dict[str, Any], offset: float, finish: Any) -> Any:
    """The sums of a layer as logic without registers, in the setting that costs least.

    ``offset`` is added to every input, and ``finish`` turns the sums into the outputs of the part.
    """
    step = 2.0 ** -given["frac"]
    weights, biases = np.array(given["weights"]).T * step, np.array(given["biases"]) * step
    biases = biases + offset * weights.sum(axis=0)
    found = []
    for method, extra in itertools.product(METHODS, EXTRA_LEVELS):
        inputs.solver_options = {"method0": method, "hard_dc": extra}
        found.append(trace(inputs, finish(inputs @ weights + biases)))
    return min(found, key=lambda logic: logic.cost)


def addresses(q: Any) -> list[Any]:
    """Address of the base, address of the correction, and sign, all as whole numbers."""
    sign = q.is_negative()
    mag = sign.msb_mux(~q, q)
    mag = mag.quantize(0, mag.kif[1], Q_FRAC)
    # Bits of a magnitude from 2 on; from 8 on it is treated like one from 6 on.
    upper = mag.quantize(0, 3, -1) * 0.5
    if mag.kif[1] > 3:
        over = mag.quantize(0, mag.kif[1], -3).unary_bit_op("any")
        upper = over.msb_mux(upper.from_const(3.0, COSTS), upper)
    wide = upper.unary_bit_op("any")
    fine = mag.quantize(0, -6, 8) * 256.0
    base = wide * 512.0 + mag.quantize(0, 1, 6) * 256.0 + wide.msb_mux(upper, fine)
    near = q.quantize(0, -8, 13) * 2.0**13
    far = q.quantize(0, -6, 10) * 2.0**11 + upper.quantize(0, 2, -1) * 0.5
    correction = wide * 1024.0 + mag.quantize(0, 1, 4) * 512.0 + wide.msb_mux(far, near)
    return [base, correction, sign]


def words(address: Any, table: Any) -> Any:
    """The word of a table at an address."""
    reached = np.array(table)[int(address.low) : int(address.high) + 1]
    return address.lookup(reached * 2.0**-BASE_FRAC)


def joined(base: Any, correction: Any, sign: Any) -> Any:
    """r without half a step: base, complemented where the sign is set, plus correction; cut."""
    flipped = sign.msb_mux(~base, base) - sign
    return (flipped + correction).quantize(1, 0, R_FRAC)


def parts(given: dict[str, Any]) -> list[Any]:
    """The parts of the network as alkaid's logic without registers.

    From the second on, each part takes what the one before it gives.
    """

    def looked_up(sums: Any) -> Any:
        cut = [q.quantize(1, q.kif[1], Q_FRAC) for q in np.asarray(sums)]
        return [one for q in cut for one in addresses(q)]

    def rounded(sums: Any) -> Any:
        return sums.quantize(1, 0, SIGNAL_FRAC, "SAT", "RND")

    step = 2.0**-SIGNAL_FRAC
    samples = signals([(-1, 1 - step, step)] * len(given["first"]["weights"][0]))
    hidden = summed(samples, given["first"], 0, looked_up)
    bits = np.asarray(following(hidden)).reshape(-1, 3)
    read = [
        (words(base, given["bases"]), words(correction, given["corrections"]), sign)
        for base, correction, sign in bits
    ]
    tables = trace(list(bits.ravel()), [one for three in read for one in three])
    bits = np.asarray(following(tables)).reshape(-1, 3)
    middle = trace(list(bits.ravel()), [joined(*three) for three in bits])
    outputs = summed(following(middle), given["second"], HALF, rounded)
    return [hidden, tables, middle, outputs]


def written(logics: list[Any], fused: bool, folder: Path) -> int:
    """Write the Verilog of a network with registers, and return its clocks."""
    stages = []
    for logic in logics:
        if fused:
            logic = add_surrogate(dead_code_elimin(fuse_ternary_adders(logic)), _skip_op8_cost=True)
        stages += _split_comb_logic(logic, latency_cutoff=LEVELS, verbose=False)
    pipeline = _stages_to_fsm(stages, reg_inp=False)
    RTLModel(pipeline, folder, "peer", ternary_fuse=False).write()
    return len(stages)


def main() -> None:
    folder = Path(sys.argv[1])
    given = json.loads((folder / "given.json").read_text(encoding="utf-8"))
    logics = parts(given)
    formats = {tuple(map(int, q.kif)) for q in logics[-1].out_qint}
    if formats != {(1, 0, SIGNAL_FRAC)}:
        sys.exit(f"outputs: got {formats}, expected (1, 0, {SIGNAL_FRAC}) each")
    values = np.array(given["frames"]) * 2.0**-SIGNAL_FRAC
    for logic in logics:
        values = logic.predict(values)
    answer = {
        "clocks": {
            name: written(logics, fused, folder / name)
            for name, fused in (("two", False), ("three", True))
        },
        "outputs": np.round(values * 2.0**SIGNAL_FRAC).astype(int).tolist(),
    }
    (folder / "answer.json").write_text(json.dumps(answer), encoding="utf-8")


if __name__ == "__main__":
    main()
