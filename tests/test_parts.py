"""Simulates the parts that blocks inline in MyHDL, and compares them with the formats."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from myhdl import Simulation, StopSimulation, delay, instance

from golden.activation.schemes import SCHEMES
from golden.numbers.fixed import Fix, Overflow, Rounding, requantise
from hdl.common.delay import delay as delay_line
from hdl.common.requantise import requantise as requantise_part
from hdl.common.rom import rom
from hdl.common.signals import Words, flag, reset, signed, unsigned
from tactus.scene import load_scene
from tactus.verify.benches.myhdl_simulation import simulate
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp
from tb.common.stimulus import corner_frames


def settle(stimulus, *blocks) -> None:
    """Run a generator of delays and some blocks until the generator ends."""

    @instance
    def drive():
        yield from stimulus()
        raise StopSimulation

    Simulation(drive, *blocks).run(quiet=1)


@settings(max_examples=30)
@given(
    st.integers(2, 9),
    st.integers(2, 8),
    st.integers(0, 9),
    st.sampled_from(Rounding),
)
def test_requantise_is_the_formats_requantise(width, out_width, shift, rounding) -> None:
    exact, result = signed(width), signed(out_width)
    part = requantise_part(exact, result, shift=shift, rounding=rounding)
    seen = []

    def stimulus():
        for code in range(int(exact.min), int(exact.max)):
            exact.next = code
            yield delay(1)
            seen.append(int(result))

    settle(stimulus, part)
    codes = np.arange(int(exact.min), int(exact.max))
    expected = requantise(codes, shift, Fix(out_width, 0), rounding, Overflow.SATURATE)
    assert seen == expected.tolist()


@pytest.mark.parametrize("words", [[5], [1, -3, 7], [0, 1, 2, 3]])
def test_rom_repeats_its_last_word(words) -> None:
    addr, word = unsigned(2), signed(8)
    seen = []

    def stimulus():
        for code in range(4):
            addr.next = code
            yield delay(1)
            seen.append(int(word))

    settle(stimulus, rom(addr, word, words=words))
    assert seen == (words + [words[-1]] * 4)[:4]


def test_delay_refuses_no_clock_at_all() -> None:
    with pytest.raises(ValueError, match="delay: clocks=0, expected 1 or more"):
        delay_line(flag(), None, flag(), flag(), clocks=0)


@pytest.mark.parametrize("clocks", [1, 2, 3, 7])
@pytest.mark.parametrize("with_reset", [False, True])
def test_delay_is_that_many_clocks_and_reset_clears_state_alone(clocks, with_reset) -> None:
    clk, rst, data, late = flag(), reset(), signed(8), signed(8)
    sent = list(range(1, 30))
    cleared = 15
    seen = []

    def stimulus():
        for place, code in enumerate(sent):
            data.next = code
            rst.next = place == cleared
            yield delay(1)
            clk.next = True
            yield delay(1)
            seen.append(int(late))
            clk.next = False
            yield delay(1)

    settle(stimulus, delay_line(clk, rst if with_reset else None, data, late, clocks=clocks))
    expected = ([0] * (clocks - 1) + sent)[: len(sent)]
    if with_reset:
        # Values on their way are lost, and so is the value that came with the reset.
        expected[cleared : cleared + clocks] = [0] * clocks
    assert seen == expected


def test_words_are_numbered_ports() -> None:
    group = Words(3, flag)
    assert list(vars(group)) == ["0", "1", "2"]
    assert len(group) == 3
    with pytest.raises(IndexError):
        group[3]


@pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")
@pytest.mark.parametrize(
    ("activation", "precision"),
    [(name, p.name) for name, scheme in SCHEMES.items() for p in scheme.precisions],
)
def test_the_network_simulated_in_myhdl_equals_its_twin(
    tmp_path: Path, activation: str, precision: str
) -> None:
    """MyHDL itself simulates the network before any conversion, and checks every bound."""
    shape = (4, 2, 4)
    mlp = random_mlp(shape, 3.0, 7)
    design = "adder_graph" if SCHEMES[activation].half_codes else "hybrid"
    path = write_scene(tmp_path, "small", precision, [mlp], activation=activation, design=design)
    scene = load_scene(str(path))
    twin = scene.twin()
    codes = np.concatenate([scene.vectors().codes, corner_frames(Fix(14, 13), 4)])
    results, _ = simulate(twin, codes)
    assert results.tolist() == twin.process(codes).tolist()
