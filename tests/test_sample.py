"""Tests the sample of ALL=1: a tree always draws the same tests, and all are drawn in time."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import sample

NAMES = [f"tests/test_a.py::test[{n}]" for n in range(100)]
PLANNED = "tests/test_bench_planning.py::test_the_benches_of_a_drawn_scene_have_a_plan[20]"
TIMES = dict.fromkeys(NAMES, 2.0) | {NAMES[0]: 500.0}


def test_the_same_tree_draws_the_same_and_another_draws_others() -> None:
    one = sample.draw(NAMES, TIMES, 40, "a tree")
    assert one == sample.draw(reversed(NAMES), TIMES, 40, "a tree")
    assert len(one) == 20
    assert set(one) != set(sample.draw(NAMES, TIMES, 40, "another tree"))


def test_everything_that_fits_is_drawn_in_the_end() -> None:
    met = {name for n in range(100) for name in sample.draw(NAMES, TIMES, 40, f"tree {n}")}
    assert met == set(NAMES[1:])


def test_a_test_that_was_never_timed_is_drawn_too() -> None:
    assert sample.draw(["tests/test_a.py::new"], {}, sample.UNTIMED, "a tree") != []
    assert sample.draw(["tests/test_a.py::new"], {}, sample.UNTIMED - 1, "a tree") == []


def test_a_fixture_that_tests_share_is_drawn_as_one_unit() -> None:
    """The first test bears the time of the fixture; each of the others alone would take as long."""
    found = [
        (path.name, ast.unparse(call), len(call.args))
        for path in sorted(Path(__file__).parent.glob("test_*.py"))
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.FunctionDef)
        for decorator in node.decorator_list
        if isinstance(decorator, ast.Call) and ast.unparse(decorator.func) == "pytest.fixture"
        for call in (word.value for word in decorator.keywords if word.arg == "params")
        if isinstance(call, ast.Call) and ast.unparse(call.func) == "tiered"
    ]
    assert found
    assert [one for one in found if one[-1] != 3] == []


def test_a_run_names_what_it_has_drawn() -> None:
    """The run is on one test, with enough time for all of it."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST")}
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-n", "1"]
    said = subprocess.run(
        [*command, PLANNED, "--sample", "100000"],
        cwd=sample.ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert said.returncode == 0, said.stdout + said.stderr
    assert "drawn of what ALL=1 adds" in said.stdout
    assert PLANNED in said.stdout.split("drawn of what ALL=1 adds")[1]
    assert "1 passed" in said.stdout
