"""Tests the winner of a frame: its twin, and the option ``argmax`` of a scene."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.layers.argmax import Argmax
from golden.layers.argmax_tree import ArgmaxTree
from golden.numbers.fixed import Fix
from tactus.scene import Scene
from tactus.verify.benches.written import scene_of
from tb.common.case_library import ADDER_GRAPH
from tb.common.cases import FRONT_END, VISUALISATION, Case

FMT = Fix(5, 3)
ENGINE = Case([(3, 4, 4)], "exact", activation="precise", design="engine")
DECIDES = "argmax = true"


@given(st.lists(st.integers(FMT.low, FMT.high), min_size=2, max_size=6))
def test_the_winner_is_the_first_of_the_largest_and_its_margin_what_is_left(codes) -> None:
    index, margin = Argmax(FMT, 6).process(codes)
    best = sorted(codes)
    assert index == codes.index(best[-1])
    assert margin == best[-1] - best[-2]


def test_ends_and_ties() -> None:
    low, high = FMT.low, FMT.high
    frames = [[low, high], [high, low], [low, low], [high, high], [-1, 0]]
    index, margin = Argmax(FMT, 2).process(frames)
    assert index.tolist() == [1, 0, 0, 0, 1]
    assert margin.tolist() == [31, 31, 0, 0, 1]
    assert margin.max() == (1 << Argmax(FMT, 2).margin_fmt.width) - 1


@pytest.mark.parametrize(("outputs", "bits"), [(2, 1), (3, 2), (4, 2), (5, 3), (16, 4), (17, 5)])
def test_the_index_has_as_many_bits_as_it_needs(outputs: int, bits: int) -> None:
    assert Argmax(FMT, outputs).index_fmt.width == bits


@pytest.mark.parametrize(
    ("frames", "message"),
    [
        ([[1]], r"argmax frames: got shape (1, 1), expected 2 to 4"),
        (np.zeros((2, 5), dtype=int), r"argmax frames: got shape (2, 5), expected 2 to 4"),
        (3, r"argmax frames: got shape (), expected 2 to 4"),
        ([[0, 16]], "argmax frames: got code 16"),
    ],
)
def test_frames_are_checked(frames, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        Argmax(FMT, 4).process(frames)


@pytest.mark.parametrize("outputs", [1, 0, -1])
def test_one_output_has_no_winner(outputs: int) -> None:
    with pytest.raises(InputError, match=f"argmax: got outputs={outputs}, expected 2 or more"):
        Argmax(FMT, outputs)


@given(st.lists(st.integers(FMT.low, FMT.high), min_size=2, max_size=9))
def test_a_tree_decides_as_the_block_that_takes_one_output_after_the_other(codes) -> None:
    tree = ArgmaxTree(FMT, len(codes))
    index, margin = tree.process(codes)
    best = sorted(codes)
    assert (index, margin) == (codes.index(best[-1]), best[-1] - best[-2])
    assert 1 << tree.levels >= len(codes) > 1 << tree.levels - 1


def test_a_design_of_outputs_at_once_has_a_tree(tmp_path: Path) -> None:
    plain, decides = (
        changed(ADDER_GRAPH, tmp_path, hardware=hardware).twin() for hardware in ("", DECIDES)
    )
    assert replace(decides, decides=False) == plain
    added = [port.name for port in decides.ports if port.name not in {p.name for p in plain.ports}]
    assert added == ["winner_valid", "winner_index", "winner_margin"]
    assert isinstance(decides.argmax, ArgmaxTree)
    assert decides.latency == plain.latency


def changed(case: Case, folder: Path, **changes) -> Scene:
    return scene_of(replace(case, **changes), folder, "mine")


def test_the_option_adds_the_winner_to_what_an_instrument_shows(tmp_path: Path) -> None:
    sections = f"{VISUALISATION}{FRONT_END}counter_width = 9\n"
    (plain, decides) = (
        changed(ENGINE, tmp_path, sections=sections, hardware=hardware).twin()
        for hardware in ("", DECIDES)
    )
    names = [port.name for port in decides.ports if port.name.startswith("winner_")]
    assert len(decides.ports) == len(plain.ports) + len(names) == len(plain.ports) + 3
    assert decides.readout.holds
