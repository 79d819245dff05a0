"""Tests the measurement of how figures differ between processors."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from golden.input_error import InputError
from tactus.report.measure import spread

ROOT = Path(__file__).parents[1]


def tables(*rows: list) -> dict:
    return {"t": {"columns": ["name", "a", "b"], "rows": list(rows)}}


def test_the_largest_difference_of_each_column_is_found() -> None:
    found = {
        "one": tables(["x", 1.0, 7], ["y", 2.0, None]),
        "two": tables(["x", 1.0, 7], ["y", 2.5, 3]),
        "three": tables(["x", 1.1, 7], ["y", 2.0, None]),
    }
    assert spread.differences(found).rows == [
        ["t", "a", pytest.approx(0.2), 2.0, 2.5, 2],
        ["t", "b", None, None, None, 2],
    ]
    assert spread.differences({"one": found["one"], "again": found["one"]}).rows == []


def test_tables_of_other_lengths_differ() -> None:
    found = {"one": tables(["x", 1.0, 7]), "two": tables(["x", 1.0, 7], ["y", 0, 0])}
    assert spread.differences(found).rows == [["t", "number of rows", 0.5, 1, 2, None]]


def test_words_that_differ_are_no_figure() -> None:
    found = {"one": tables(["x", 1.0, 0.0]), "two": tables(["z", 1.0, -0.0])}
    assert spread.differences(found).rows == [["t", "name", None, None, None, 1]]


def test_the_settings_reach_numpy() -> None:
    """A setting without effect would wrongly show that nothing differs."""
    code = "import numpy._core._multiarray_umath as m; print(m.__cpu_features__.get('X86_V3'))"
    known = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    if known.stdout.strip() != "True":
        pytest.skip("numpy has no AVX2 to leave out here")
    env = spread.SETTINGS["numpy-sse"]
    done = subprocess.run(
        [sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "False"


@pytest.mark.all_only
def test_the_command_measures_tables_under_settings() -> None:
    command = [sys.executable, "-m", "tactus.report.measure.spread", "operations"]
    for name in ("as it is", "one-thread"):
        command += ["--setting", name]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert re.search(r"^one-thread: measured$", done.stdout, re.M)
    assert "between 2 runs" in done.stdout
    assert "operations " not in done.stdout


def test_what_fails_says_why() -> None:
    with pytest.raises(InputError, match=r"tactus\.cli\.train nowhere: error: scene 'nowhere'"):
        spread.finished([sys.executable, "-m", "tactus.cli.train", "nowhere"], {})


def test_a_processor_without_the_instructions_is_no_fault() -> None:
    code = "import os, signal; os.kill(os.getpid(), signal.SIGILL)"
    assert not spread.finished([sys.executable, "-c", code], {})
