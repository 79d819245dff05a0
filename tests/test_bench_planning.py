"""What benches are about to drive, for scenes drawn at random over what a scene may choose.

Nothing is simulated: each test of each bench runs up to its first play. What it would drive fits
its ports; where its stimuli are a function, the twin takes them all and every border is met.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from cocotb._decorators import TestGenerator
from conftest import tiered

from golden.activation.schemes import SCHEMES
from golden.block import Block, walk
from golden.networks.designs import DESIGNS
from golden.port import Port
from golden.scene import Scene
from golden.window import Window
from tb.common.bench import Bench
from tb.common.cases import FRONT_END, VISUALISATION, Case
from tb.common.collected import BENCHES
from tb.common.coverage import Coverage, missing

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

EVERY_RUN, MORE = 4, 200
SPREADS = (0.001, 0.05, 0.5, 1.0, 4.0, 20.0, 100.0)


class PlannedError(Exception):
    """A bench has come to its first play."""


@dataclass
class Subject:
    """What a bench gets in place of a simulator's: who asks it for a port is about to play."""

    scene: Scene
    design: Block
    twin: Block
    seed: int

    def __getattr__(self, name: str) -> None:
        raise PlannedError


def prepared(bench: Bench, subject: Subject) -> None:
    """A bench of a subject, outside a simulator."""
    bench.dut = subject
    bench.scene, bench.design, bench.twin = subject.scene, subject.design, subject.twin
    bench.latency, bench.frames = bench.twin.latency, 20
    bench.rng = np.random.default_rng(subject.seed)
    bench.configuration = {"entity": bench.twin.entity, "rerun": "", "trace": ""}
    bench.compared = 0
    bench.coverage = Coverage(bench.twin)


async def played(bench: Bench, drive: dict[str, np.ndarray], watch: list[str]) -> None:
    """What is driven fits its ports."""
    ports = {port.name: port for port in bench.twin.ports}
    assert len({len(column) for column in drive.values()}) == 1, bench.twin.entity
    for name, column in drive.items():
        low, high = ends(ports[name])
        assert low <= min(column), f"{bench.twin.entity}: {name}"
        assert max(column) <= high, f"{bench.twin.entity}: {name}"
    raise PlannedError


@pytest.fixture(autouse=True)
def outside_a_simulator(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Bench, "__init__", prepared)
    monkeypatch.setattr(Bench, "play", played)


def ends(port: Port) -> tuple[int, int]:
    """The least and the largest value that a port carries."""
    most = 1 << (port.width or 1)
    return (-most // 2, most // 2 - 1) if port.signed else (0, most - 1)


def drawn_case(rng: np.random.Generator, large: bool) -> Case:
    """A case of any design, arrangement, activation, precision and surroundings."""
    design = str(rng.choice([*DESIGNS]))
    kind = DESIGNS[design]
    arrangement = str(rng.choice(kind.arrangements))
    # Small ones more often: large ones take longer.
    most = 9 if large else 4
    inputs = int(rng.integers(1, most))
    hidden = rng.choice([1, 2, 3, 4, 6, 9, 24][:most], 4).tolist()
    drawn = bool(rng.random() < 0.3)
    outputs = 4 if drawn else int(rng.integers(1, 7))
    count = 4 if drawn else int(rng.integers(2, 5))
    shapes = {
        "single": [(inputs, hidden[0], outputs)],
        "multiple": [(inputs, nodes, 1) for nodes in hidden[:count]],
        "cascade": [(inputs + i, nodes, 1) for i, nodes in enumerate(hidden[:count])],
    }[arrangement]
    sections = VISUALISATION + "stop = 0.9\nstep = 0.3\n" if drawn else ""
    if rng.random() < 0.3:
        sections += f"{FRONT_END}counter_width = {rng.integers(8, 14)}\n"
    window = None
    if rng.random() < 0.2:
        window = Window(((0, 2),) * (inputs // 2) + ((0,),) * (inputs % 2))
    return Case(
        shapes,
        str(rng.choice(kind.precisions)),
        spread=float(rng.choice(SPREADS)),
        activation=str(rng.choice(kind.known_activations or [*SCHEMES])),
        arrangement=arrangement,
        seed=int(rng.integers(1000)),
        design=design,
        sections=sections,
        hardware=str(rng.choice(["", "lean = false"])),
        window=window,
    )


def drawn_scene(seed: int, folder: Path) -> tuple[Scene, Block]:
    """The first of the cases of a seed that a scene can be; others are refused by name."""
    rng = np.random.default_rng(seed)
    while True:
        case = drawn_case(rng, large=seed >= EVERY_RUN)
        with suppress(ValueError, RuntimeError):
            scene = case.scene(folder, f"drawn{seed}")
            return scene, scene.twin()


def plan(subject: Subject) -> None:
    """Run each test of a bench up to its first play, or to its end where it has none to make."""
    tests = vars(BENCHES[subject.twin.block]).values()
    for test in [value for value in tests if isinstance(value, TestGenerator)]:
        with suppress(PlannedError, StopIteration):
            test.func(subject).send(None)


def check(subject: Subject) -> None:
    """The twin takes all stimuli of a bench, and they meet every border of it."""
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
def test_the_benches_of_a_drawn_scene_have_a_plan(tmp_path: Path, seed: int) -> None:
    scene, design = drawn_scene(seed, tmp_path)
    # One entity of each block.
    for twin in {part.block: part for part in walk(design)}.values():
        subject = Subject(scene, design, twin, seed)
        check(subject)
        plan(subject)
