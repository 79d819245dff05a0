"""Builds a network of two layers with da4ml, in every setting; the Python that has da4ml runs it.

``python da4ml_network.py FOLDER`` reads ``given.json`` there and writes ``answer.json`` and the
Verilog of each setting. It imports nothing of this project.

The sums are da4ml's: ``samples @ weights + biases`` on its symbolic arrays, with exact products.
da4ml's own tanh is a table of a whole sum, which takes 131072 words for the same error as ours. So
tanh is made of two tables and a multiplication, all of them da4ml's operations. A hidden sum
saturates to 3 whole bits. Its upper 10 bits read tanh and the slope of tanh from tables of 1024
words, and its other bits times the slope are added. The first table includes half of r's last
place, so r is cut without an addition for rounding.
"""

import itertools
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from da4ml.codegen import RTLModel
from da4ml.trace import FixedVariableArray, HWConfig, comb_trace
from da4ml.types import minimal_kif

SIGNAL_FRAC = 13
WHOLE = 3
STEP_FRAC = 6
TANH_FRAC, SLOPE_FRAC = 16, 9
# The number of adder levels between registers.
LEVELS = 5
# In da4ml's costs each adder cell is for one bit, and each adder is one level of delay, whatever
# its width.
COSTS = HWConfig(1, -1, -1)
METHODS = ("wmc", "mc", "wmc-pdc", "mc-pdc", "wmc-dc", "mc-dc")
# How many levels may be added to the shallowest graph; -1 means any number.
EXTRA_LEVELS = (-1, 2, 1, 0)
HIDDEN_FRACS = (12, 13, 14)


def settings() -> list[dict[str, Any]]:
    """The settings to try: how common terms are chosen, how deep graphs may get, the bits of q."""
    return [
        {"method0": method, "hard_dc": extra, "hidden_frac": frac}
        for frac, method, extra in itertools.product(HIDDEN_FRACS, METHODS, EXTRA_LEVELS)
    ]


def layer(given: dict[str, Any]) -> tuple[Any, Any]:
    """Weights, shape (inputs, neurons), and biases as real numbers, from their codes."""
    step = 2.0 ** -given["frac"]
    return np.array(given["weights"]).T * step, np.array(given["biases"]) * step


def tanh(q: Any, frac: int) -> Any:
    """r with 13 fraction bits, from sums that are cut to ``frac`` fraction bits."""
    step, half = 2.0**-STEP_FRAC, 2.0 ** -(SIGNAL_FRAC + 1)
    most = 1 - 2.0**-TANH_FRAC
    reached = q.quantize(1, WHOLE, frac, "SAT", "TRN")
    word = reached.quantize(1, WHOLE, STEP_FRAC, "WRAP", "TRN")
    rest = reached.quantize(0, -STEP_FRAC, frac, "WRAP", "TRN")
    at = word.apply(lambda v: np.minimum(np.tanh(v) + half, most))
    slope = word.apply(lambda v: (np.tanh(v + step) - np.tanh(v)) / step)
    at = at.quantize(1, 0, TANH_FRAC, "SAT", "RND")
    slope = slope.quantize(0, 0, SLOPE_FRAC, "SAT", "RND")
    return (at + slope * rest).quantize(1, 0, SIGNAL_FRAC, "WRAP", "TRN")


def traced(given: dict[str, Any], setting: dict[str, Any]) -> Any:
    """The network as da4ml's logic without registers."""
    options = {name: setting[name] for name in ("method0", "hard_dc")}
    first, second = layer(given["first"]), layer(given["second"])
    ones = np.ones(len(first[0]), dtype=np.int64)
    samples = FixedVariableArray.from_kif(
        ones, 0 * ones, SIGNAL_FRAC * ones, hwconf=COSTS, solver_options=options
    )
    r = tanh(samples @ first[0] + first[1], setting["hidden_frac"])
    outputs = (r @ second[0] + second[1]).quantize(1, 0, SIGNAL_FRAC, "SAT", "RND")
    return comb_trace(samples, outputs)


def answered(given: dict[str, Any], setting: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Write a setting's Verilog; return da4ml's cost, the stages, and the codes of the outputs."""
    logic = traced(given, setting)
    formats = [tuple(map(int, minimal_kif(q))) for q in logic.out_qint]
    if set(formats) != {(1, 0, SIGNAL_FRAC)}:
        sys.exit(f"outputs: got {formats}, expected (1, 0, {SIGNAL_FRAC}) each")
    RTLModel(logic, "peer", folder, latency_cutoff=LEVELS).write()
    stages = json.loads((folder / "metadata.json").read_text(encoding="utf-8"))["latency"]
    outputs = logic.predict(np.array(given["frames"]) * 2.0**-SIGNAL_FRAC)
    codes = np.round(outputs * 2.0**SIGNAL_FRAC).astype(int)
    return {**setting, "cost": logic.cost, "stages": stages, "outputs": codes.tolist()}


def main() -> None:
    folder = Path(sys.argv[1])
    given = json.loads((folder / "given.json").read_text(encoding="utf-8"))
    answers = [answered(given, setting, folder / str(n)) for n, setting in enumerate(settings())]
    (folder / "answer.json").write_text(json.dumps(answers), encoding="utf-8")


if __name__ == "__main__":
    main()
