"""Checks what benches are going to drive, for random scenes with any allowed choice of keys.

No simulator runs: each test of each bench runs up to its first play. The values that it would drive
must fit its ports. If its stimuli come from a function, the twin must accept them, and they must
reach every border.
"""

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from cocotb._decorators import TestGenerator
from conftest import tiered
from drawn import drawn_scene

from golden.common.block import Block, walk
from golden.common.port import Port
from tactus.scene import Scene
from tactus.verify.benches.collected import BENCHES
from tb.common.bench import Bench
from tb.common.bench_input import BenchInput
from tb.common.coverage import Coverage, missing

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

EVERY_RUN, MORE = 4, 40


class PlannedError(Exception):
    """Raised when a bench comes to its first play."""


@dataclass
class Subject:
    """A replacement for the simulator's object.

    A bench that asks it for a port is going to play.
    """

    scene: Scene
    design: Block
    twin: Block
    seed: int

    def __getattr__(self, name: str) -> None:
        raise PlannedError


def prepared(bench: Bench, subject: Subject) -> None:
    """Prepare a bench of a subject outside of a simulator."""
    bench.dut = subject
    scene, bench.twin = subject.scene, subject.twin
    bench.given = BenchInput(subject.design, scene.vectors().recordings, scene.window)
    bench.latency, bench.frames = bench.twin.latency, 20
    bench.rng = np.random.default_rng(subject.seed)
    bench.configuration = {
        "scene": str(scene.path),
        "entity": bench.twin.entity,
        "rerun": "",
        "trace": "",
    }
    bench.compared = 0
    bench.coverage = Coverage(bench.twin)


async def played(bench: Bench, drive: dict[str, np.ndarray], watch: list[str]) -> None:
    """Check that the driven values fit their ports, instead of playing them."""
    ports = {port.name: port for port in bench.twin.ports}
    assert len({len(column) for column in drive.values()}) == 1, bench.twin.entity
    for name, column in drive.items():
        low, high = ends(ports[name])
        assert low <= min(column), f"{bench.twin.entity}: {name}"
        assert max(column) <= high, f"{bench.twin.entity}: {name}"
    raise PlannedError


@pytest.fixture
def planned(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Bench, "__init__", prepared)
    monkeypatch.setattr(Bench, "play", played)


def ends(port: Port) -> tuple[int, int]:
    """The least and the largest number for a port. Benches drive bits or signed numbers."""
    most = 1 << (port.width or 1)
    return (-most // 2 if port.signed else 0, most - 1)


def plan(subject: Subject) -> None:
    """Run each test of a bench up to its first play, or to its end if it plays nothing."""
    tests = vars(BENCHES[subject.twin.block]).values()
    for test in [value for value in tests if isinstance(value, TestGenerator)]:
        if not getattr(test, "applies", lambda _: True)(subject.twin):
            continue
        with suppress(PlannedError, StopIteration):
            test.func(subject).send(None)


def check(subject: Subject) -> None:
    """Check that the twin accepts all stimuli of a bench, and that they reach every border."""
    stimuli = getattr(BENCHES[subject.twin.block], "stimuli", None)
    if stimuli is None:
        return
    bench = Bench(subject)
    for inputs in stimuli(bench):
        for quantity, values in bench.twin.quantities(*inputs).items():
            bench.meet(quantity, values)
    lacking = [what for what in missing(bench.twin, bench.coverage.counts) if "border" in what]
    assert not lacking, bench.twin.entity


@pytest.mark.parametrize("seed", tiered(range(EVERY_RUN), range(EVERY_RUN, MORE)))
def test_the_benches_of_a_drawn_scene_have_a_plan(planned: None, tmp_path: Path, seed: int) -> None:
    scene = drawn_scene(seed, tmp_path, large=seed >= EVERY_RUN)
    design = scene.twin(lean=seed % 3 > 0)
    # One entity of each block is planned.
    for twin in {one.block: one for one in walk(design) if not one.part_of}.values():
        subject = Subject(scene, design, twin, seed)
        check(subject)
        plan(subject)
