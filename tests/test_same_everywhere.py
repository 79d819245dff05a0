"""The constants of hardware are the same on every machine. docs/formats.md says how."""

import os
import subprocess
import sys
from fractions import Fraction
from functools import cache
from math import floor
from pathlib import Path

import exported_constants
import mpmath
import pytest
from conftest import tiered
from myhdl.conversion import _toVerilog

import tactus.export.hierarchy
from golden.activation.lut import lut_for
from golden.networks.constants import quantised
from golden.numbers import transcendental
from golden.numbers.fixed import Fix
from golden.numbers.precision import EXACT
from golden.numbers.transcendental import exp_floors, tanh_floors
from golden.visualisation.load_profile import exp_memory
from tactus.core import machine
from tactus.scene import load_scene, scene_names

ROOT = Path(__file__).parents[1]

# The flag that a processor must have for a setting, since a setting for another core would end in
# an illegal instruction.
FLAGS = {"openblas-prescott": "sse2", "openblas-haswell": "avx2", "openblas-skylakex": "avx512f"}
CPU = machine.CPUINFO
PRESENT = CPU.read_text(encoding="utf-8").split() if CPU.is_file() else []
SETTINGS = {n: s for n, s in machine.SETTINGS.items() if n not in FLAGS or FLAGS[n] in PRESENT}
# Settings at once, because each is a variable of another library: in every run those that differ
# most from a new processor. No constant calls a function with a last bit of its own.
OLDEST = {"numpy-sse", "openblas-prescott", "glibc-sse"}
OTHERS = {"numpy-avx2", "openblas-haswell", "two-threads"}

IN_TESTS = {"PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests")])}


def run(setting: dict[str, str], *arguments: str) -> list[str]:
    """The lines that a Python program prints with only these variables of ``SETTINGS`` set."""
    varied = {name for one in SETTINGS.values() for name in one}
    kept = {name: value for name, value in os.environ.items() if name not in varied}
    done = subprocess.run(
        [sys.executable, *arguments],
        env={**kept, "PYTHONPATH": str(ROOT), **setting},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@cache
def here() -> list[str]:
    """The constants of this machine; no function was called that has a last bit of its own."""
    return run({}, exported_constants.__file__, "--defined-only")


@pytest.mark.parametrize(
    "names",
    tiered([sorted(SETTINGS.keys() & OLDEST)], [sorted(SETTINGS.keys() & OTHERS)]),
    ids=" ".join,
)
def test_constants_do_not_hang_on_the_processor(names: list[str]) -> None:
    at_once = {variable: value for name in names for variable, value in SETTINGS[name].items()}
    assert len(at_once) == sum(len(SETTINGS[name]) for name in names)
    assert run(at_once, exported_constants.__file__) == here()


def test_an_export_calls_none_either(tmp_path: Path) -> None:
    """This includes MyHDL. The words of this scene are above 2**30, where it sizes literals."""
    program = f"""
import myhdl, exported_constants
exported_constants.refuse_undefined()
from pathlib import Path
from tactus.scene import load_scene
from tactus.export.exporter import export
scene = load_scene("comparison/digit-lanes4")
for language in ("vhdl", "verilog"):
    print(len(export(scene, language, Path({str(tmp_path)!r}) / language)) > 5)
"""
    assert run(IN_TESTS, "-c", program) == ["True", "True"]


def test_a_large_literal_is_sized_by_its_bits() -> None:
    """A sign bit is added. A logarithm would give 2**31 - 1 one bit more on some machines."""
    assert tactus.export.hierarchy
    for bits in range(31, 63):
        ones = (1 << bits) - 1
        assert _toVerilog._intRepr(ones) == f"{bits + 1}'h{ones:x}"
        assert _toVerilog._intRepr(ones - 1) == f"{bits + 1}'h{ones - 1:x}"
        assert _toVerilog._intRepr(ones + 1) == f"{bits + 2}'h{ones + 1:x}"


def test_such_a_function_is_refused() -> None:
    program = """
import exported_constants
exported_constants.refuse_undefined()
import math, numpy
for call in (lambda: numpy.tanh(1.0), lambda: math.log2(8), lambda: numpy.linalg.lstsq([[1]], [1]),
             lambda: numpy.mean([1.0])):
    try:
        call()
    except AssertionError:
        print("refused")
print(numpy.floor(1.5), math.ldexp(1.0, 3))
"""
    assert run(IN_TESTS, "-c", program) == ["refused"] * 4 + ["1.0 8.0"]


# Results of mpmath with so many bits have an error of less than 2**-100.
ORACLE_BITS = 120


def test_tanh_of_every_code_is_rounded_down() -> None:
    points, frac = 5 << EXACT.hidden_fmt.frac, 29
    with mpmath.workprec(ORACLE_BITS):
        q = (mpmath.mpf(m) / (1 << EXACT.hidden_fmt.frac) for m in range(points))
        expected = [int(mpmath.floor(mpmath.tanh(x) * 2**frac)) for x in q]
    step = Fraction(1, 1 << EXACT.hidden_fmt.frac)
    assert tanh_floors(step, points, frac).tolist() == expected


def test_words_of_tanh_and_exp_are_the_nearest() -> None:
    """No word is within 2**-20 of a unit of the border at which the next one would be nearer."""
    lut = lut_for(EXACT, 1, EXACT.hidden_fmt.high).words
    memory = exp_memory(10, 6, 17).words
    assert (len(lut), len(memory)) == (128, 1024)
    with mpmath.workprec(ORACLE_BITS):
        exact = [mpmath.tanh(mpmath.mpf(7 * n) / 256) * 2**13 for n in range(128)]
        exact += [mpmath.exp(-mpmath.mpf(2 * n + 1) / 128) * 2**17 for n in range(1024)]
        off = max(abs(word - value) for word, value in zip(lut + memory, exact, strict=True))
        assert off < 0.5 - 2**-20


def test_a_result_that_is_not_decided_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transcendental, "BITS", 40)
    monkeypatch.setattr(transcendental, "_ONE", 1 << 40)
    with pytest.raises(ArithmeticError, match=r"result \d+: 40 fraction bits leave \d+ or \d+"):
        tanh_floors(Fraction(1, 1 << 14), 5 << 14, 28)
    with pytest.raises(ArithmeticError, match=r"result \d+: 40 fraction bits leave \d+ or \d+"):
        exp_floors(Fraction(1, 64), Fraction(1, 64), 1024, 32)


def nearest(value: Fraction) -> int:
    return floor(value + Fraction(1, 2))


def code(value: Fraction, fmt: Fix) -> int:
    """The code of a fraction, as ``Fix.quantise`` would give it."""
    return min(max(nearest(value * 2**fmt.frac), fmt.low), fmt.high)


@pytest.mark.parametrize("name", scene_names())
def test_weights_are_the_nearest_codes_of_exact_quotients(name: str) -> None:
    scene = load_scene(name)
    for mlp in scene.mlps():
        for given in mlp.layers:
            layer = quantised(given, scene.precision, name)
            for row, (bias, factor) in enumerate(zip(given.biases, layer.factors, strict=True)):
                real = [Fraction(float(v)) / factor for v in [*given.weights[row], bias]]
                found = [*layer.weights[row], layer.biases[row]]
                assert found == [code(v, layer.fmt) for v in real]
