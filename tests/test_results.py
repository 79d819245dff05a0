"""Tests the kept results of benches, so that an interrupted demo goes on where it stopped.

It also tests which entities a demo simulates."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from golden.common.block import walk
from golden.networks.network import Network
from tactus.core import store
from tactus.scene import DEFAULT_SCENES, Scene, load_scene, scene_names
from tactus.verify.benches import kept_results, results
from tactus.verify.benches.collected import BENCHES, CASES_OF
from tactus.verify.benches.places import blocks_in, places
from tactus.verify.benches.runner import Job, Outcome
from tactus.verify.benches.tools import SIMULATORS

FILE = "exported.v"


class Benches:
    """Benches that are only counted. All pass, except those named in ``red``."""

    def __init__(self, scene: Scene, folder: Path, monkeypatch: pytest.MonkeyPatch):
        self.scene = scene
        self.ran: list[str] = []
        self.red: set[str] = set()
        self.stop_before = ""
        self.planned = [
            Job(scene, part.entity, part.block, part.area, (FILE,), simulator, build=folder)
            for simulator in SIMULATORS
            for part in walk(scene.twin())
            if not part.part_of
        ]
        for folder in {job.hdl_folder for job in self.planned}:
            folder.mkdir(parents=True)
            (folder / FILE).write_text("as exported")
        self.current = True
        fakes: dict[str, Any] = {
            "is_current": lambda *_: self.current,
            "plan": lambda *_: self.planned,
            "jobs": lambda _, simulator: [j for j in self.planned if j.simulator == simulator],
            "run_jobs": self.one_by_one,
        }
        for name, fake in fakes.items():
            monkeypatch.setattr(results, name, fake)
        monkeypatch.setattr(kept_results, "run_job", self.run)

    def one_by_one(
        self, jobs: list[Job], tell: Callable[[Outcome], None], work: Callable[[Job], Outcome]
    ) -> list[Outcome]:
        return [work(job) for job in jobs]

    def run(self, job: Job) -> Outcome:
        name = f"{job.simulator} {job.entity}"
        if name == self.stop_before:
            raise KeyboardInterrupt
        self.ran.append(name)
        return Outcome(job, name not in self.red, 7, 0.5, {"interval": 9})

    def simulate(self, full: bool = True) -> dict[str, Any]:
        self.ran = []
        return results.simulate(load_scene(str(self.scene.path)), full)

    def forget(self, job: Job) -> None:
        """Truncate the kept result of a job, as a full disk would do."""
        path = store.place(kept_results.bench_key(job), job.build)
        path.write_bytes(path.read_bytes()[:20])


@pytest.mark.parametrize(("frames", "said"), [(3, True), (1000, False)])
def test_recorded_frames_that_are_not_played_are_told(
    small_scene: Scene, frames: int, said: bool
) -> None:
    scene = small_scene
    facts = {"frames": frames, "interval": 1}
    count = len(scene.vectors().codes)
    text = results.short_text(scene, facts)
    assert bool(text) == said
    if said:
        assert f"3 of {count} recorded frames are played" in text
        assert text.endswith(f"BLOCK={scene.twin().block} FRAMES={count} plays all.")


@pytest.fixture
def benches(small_scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Benches:
    return Benches(small_scene, tmp_path / "build", monkeypatch)


def test_an_interrupted_demo_goes_on(benches: Benches) -> None:
    names = [f"{job.simulator} {job.entity}" for job in benches.planned]
    benches.stop_before = names[5]
    with pytest.raises(KeyboardInterrupt):
        benches.simulate()
    assert benches.ran == names[:5]
    assert results.stored_results(benches.scene) is None
    benches.stop_before = ""
    found = benches.simulate()
    assert benches.ran == names[5:]
    assert (found["kept"], found["benches"], found["failed"]) == (5, len(names), 0)
    assert found["left"] == 0
    assert found["compared"] == 7 * len(names)
    assert found["facts"] == {simulator: {"interval": 9} for simulator in SIMULATORS}
    again = benches.simulate()
    assert benches.ran == []
    assert again == found | {"kept": len(names)}
    assert results.stored_results(benches.scene) == again


def test_a_damaged_result_runs_its_own_bench(benches: Benches) -> None:
    benches.simulate()
    benches.forget(benches.planned[3])
    benches.simulate()
    assert benches.ran == [f"{benches.planned[3].simulator} {benches.planned[3].entity}"]


def test_recorded_frames_are_a_part_of_benches_that_play_them(benches: Benches) -> None:
    benches.simulate()
    lines = benches.scene.data_path.read_text().splitlines()
    benches.scene.data_path.write_text("\n".join([*lines, lines[-1]]))
    benches.simulate()
    expected = [
        f"{job.simulator} {job.entity}"
        for job in benches.planned
        if kept_results.asks_for_scene(kept_results.bench_modules(job.area, job.block))
    ]
    assert benches.ran == expected
    assert expected


def test_what_fails_is_run_again(benches: Benches) -> None:
    job = benches.planned[0]
    benches.red = {f"{job.simulator} {job.entity}"}
    for _ in range(2):
        assert benches.simulate()["failed"] == 1
        assert results.stored_results(benches.scene) is None
    assert benches.ran == list(benches.red)


def test_one_entity_of_each_block_and_every_network_is_chosen(small_cascade: Scene) -> None:
    parts = [part for part in walk(small_cascade.twin()) if not part.part_of]
    planned = [
        Job(small_cascade, part.entity, part.block, part.area, (), simulator)
        for simulator in SIMULATORS
        for part in parts
    ]
    asked = results.chosen(planned)
    assert results.chosen(planned, full=True) == planned
    assert results.chosen([]) == []
    networks = {part.entity for part in parts if isinstance(part, Network)}
    others = {part.block for part in parts if part.entity not in networks}
    assert len(networks) > 3
    for simulator in SIMULATORS:
        here = [job for job in asked if job.simulator == simulator]
        assert networks <= {job.entity for job in here}
        blocks = [job.block for job in here if job.entity not in networks]
        assert sorted(blocks) == sorted(others)
    by_simulator = [[j.entity for j in asked if j.simulator == s] for s in SIMULATORS]
    assert by_simulator[0] == by_simulator[1]
    assert len(asked) < len(planned)


def test_recorded_frames_alone_do_not_stand_for_a_whole_bench(benches: Benches) -> None:
    job = benches.planned[0]
    fewer = replace(job, test="recorded")
    kept_results.run_and_keep(fewer)
    assert kept_results.kept(fewer)
    assert kept_results.kept(job) is None
    kept_results.run_and_keep(job)
    assert kept_results.kept(replace(job, test="another"))
    assert kept_results.kept(job)


def test_what_enters_a_bench_runs_it_again(benches: Benches) -> None:
    job = benches.planned[0]
    kept_results.run_and_keep(job)
    others = [replace(job, seed=2), replace(job, frames=7), replace(job, simulator="icarus")]
    assert not any(kept_results.kept(other) for other in others)
    assert kept_results.kept(job)
    (job.hdl_folder / FILE).write_text("as exported anew")
    assert kept_results.kept(job) is None
    (job.hdl_folder / FILE).write_text("as exported")
    assert kept_results.kept(job)


def test_what_would_be_exported_otherwise_is_no_result(benches: Benches) -> None:
    benches.simulate()
    assert results.stored_results(benches.scene)
    benches.current = False
    assert results.stored_results(benches.scene) is None


def test_what_is_left_is_counted_and_run_when_all_is_asked_for(benches: Benches) -> None:
    asked = results.chosen(benches.planned)
    left = len(benches.planned) - len(asked)
    assert left
    found = benches.simulate(full=False)
    assert (found["benches"], found["left"]) == (len(asked), left)
    assert len(benches.ran) == len(asked)
    stored = results.stored_results(benches.scene)
    assert stored == found | {"kept": len(asked)}
    everything = benches.simulate()
    assert (everything["kept"], everything["left"]) == (len(asked), 0)
    assert len(benches.ran) == left
    assert results.stored_results(benches.scene) == everything | {"kept": len(benches.planned)}


@cache
def blocks_of_scenes() -> dict[str, set[str]]:
    """The blocks of every shipped scene, in the order of the scenes."""
    return {name: blocks_in(load_scene(name)) for name in scene_names()}


@pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")
@pytest.mark.parametrize("block", sorted(BENCHES))
def test_every_block_is_found_without_a_scene(block: str) -> None:
    """Default scenes come first, then other shipped scenes, then the cases of its bench."""
    found = places(None, block)
    assert all(block in blocks_in(place.scene) for place in found)
    shipped = [name for name, blocks in blocks_of_scenes().items() if block in blocks]
    default = [name for name in DEFAULT_SCENES if name in shipped]
    names = [place.scene.name for place in found]
    assert names == (default or shipped[:1] or CASES_OF[block][:1])
    kind = "scene" if shipped else "case"
    assert all(p.why.startswith(f"{kind} {p.scene.name}: ") and block in p.why for p in found)


def test_a_scene_that_is_named_is_taken_without_a_word() -> None:
    (place,) = places("digit-single", "hybrid")
    assert (place.scene.name, place.why) == ("digit-single", "")
