"""What is kept: results of benches, answers in the store, files as a whole; and progress."""

import io
import os
import re
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from golden.common.block import walk
from golden.input_error import InputError
from golden.networks.network import Network
from tactus.cli import set_up
from tactus.core import closure, store
from tactus.core import progress as module
from tactus.core.files import check_writable, replace_file, replace_files, replace_folder, same_file
from tactus.core.fingerprint import ROOT
from tactus.core.folders import ROOMS
from tactus.core.progress import PAUSE, Progress, stage
from tactus.export import exporter
from tactus.scene import Scene, load_scene
from tactus.verify.benches import results
from tactus.verify.benches.runner import Job, Outcome
from tactus.verify.benches.tools import SIMULATORS
from tactus.verify.sign_off.mutate import score

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
            "run_shown": self.one_by_one,
        }
        for name, fake in fakes.items():
            monkeypatch.setattr(results, name, fake)
        monkeypatch.setattr(results, "run_job", self.run)

    def one_by_one(
        self, _: str, jobs: list[Job], work: Callable[[Job], Outcome], every: bool
    ) -> list[Outcome]:
        return [work(job) for job in jobs]

    def run(self, job: Job) -> Outcome:
        name = f"{job.simulator} {job.entity}"
        if name == self.stop_before:
            raise KeyboardInterrupt
        self.ran.append(name)
        return Outcome(job, name not in self.red, 7, 0.5, {"interval": 9})

    def simulate(self, every: bool = True) -> dict[str, Any]:
        """The results with those of ``every`` entity, or as the demo finds them."""
        self.ran = []
        scene = load_scene(str(self.scene.path))
        if not every:
            return results.simulate(scene)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(results, "chosen", lambda planned: planned)
            return results.simulate(scene)


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
    assert found["left_out"] == []
    assert found["compared"] == 7 * len(names)
    assert found["facts"] == {simulator: {"interval": 9} for simulator in SIMULATORS}
    again = benches.simulate()
    assert benches.ran == []
    assert again == found | {"kept": len(names)}
    assert results.stored_results(benches.scene) == again


def test_recorded_frames_are_a_part_of_benches_that_play_them(benches: Benches) -> None:
    benches.simulate()
    lines = benches.scene.data_path.read_text().splitlines()
    benches.scene.data_path.write_text("\n".join([*lines, lines[-1]]))
    benches.simulate()
    expected = [
        f"{job.simulator} {job.entity}"
        for job in benches.planned
        if results.asks_for_scene(results.bench_modules(job.area, job.block))
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


def test_what_enters_a_bench_runs_it_again(benches: Benches) -> None:
    job = benches.planned[0]
    fewer = replace(job, test="recorded")
    results.run_and_keep(fewer)
    assert results.kept(fewer)
    assert results.kept(job) is None, "recorded frames alone stand for no whole bench"
    results.run_and_keep(job)
    assert results.kept(replace(job, test="another"))
    others = [replace(job, seed=2), replace(job, frames=7), replace(job, simulator="icarus")]
    assert not any(results.kept(other) for other in others)
    assert results.kept(job)
    (job.hdl_folder / FILE).write_text("as exported anew")
    assert results.kept(job) is None
    (job.hdl_folder / FILE).write_text("as exported")
    assert results.kept(job)


def test_what_would_be_exported_otherwise_is_no_result(benches: Benches) -> None:
    benches.simulate()
    assert results.stored_results(benches.scene)
    benches.current = False
    assert results.stored_results(benches.scene) is None


def test_what_is_left_is_counted_and_run_when_all_is_asked_for(benches: Benches) -> None:
    asked = results.chosen(benches.planned)
    left = len(benches.planned) - len(asked)
    assert left
    found = benches.simulate(every=False)
    assert found["benches"] == len(asked)
    (said,) = found["left_out"]
    assert said.startswith(f"{left} more benches are left to make sim SCENE=")
    assert len(benches.ran) == len(asked)
    stored = results.stored_results(benches.scene)
    assert stored == found | {"kept": len(asked)}
    everything = benches.simulate()
    assert (everything["kept"], everything["left_out"]) == (len(asked), [])
    assert len(benches.ran) == left
    assert results.stored_results(benches.scene) == everything | {"kept": len(benches.planned)}


ANSWER = {"compared": 7, "facts": [1.5, "word"]}
COMMENT = "\n# Said otherwise.\n"
CODE = "\n\nADDED = 1\n"
TWIN = "golden/layers/output_controller.py"


def asked(**more: store.Part) -> store.Key:
    return store.key("test", seed=1, **more)


def test_an_answer_is_kept_under_its_key_alone(tmp_path: Path) -> None:
    assert store.read(asked(), tmp_path) is None
    assert store.cached(asked(), lambda: ANSWER, tmp_path) == ANSWER
    assert store.cached(asked(), pytest.fail, tmp_path) == ANSWER
    others = [asked(frames=2), store.key("test", seed=2), store.key("other", seed=1)]
    assert [store.read(other, tmp_path) for other in others] == [None] * 3
    with pytest.raises(ValueError, match="got None"):
        store.write(asked(), None, tmp_path)


def test_files_and_folders_enter_by_content(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    file = tmp_path / "folder" / "file"
    keys = []
    for text in ("one", "two", "one"):
        file.write_text(text)
        keys.append((asked(file=file), asked(all=[file.parent, "fact"])))
    assert keys[0] == keys[2]
    assert keys[0][0] != keys[1][0]
    assert keys[0][1] != keys[1][1]


@pytest.mark.parametrize("damage", [b"", b'{"key": {}}', b"\xff", b"[1]"])
def test_a_damaged_file_is_made_anew(tmp_path: Path, damage: bytes) -> None:
    store.write(asked(), ANSWER, tmp_path)
    file = store.place(asked(), tmp_path)
    whole = file.read_bytes()
    for text in (damage, whole[:-9], whole.replace(b'"compared": 7', b'"compared": 8')):
        assert text != whole
        file.write_bytes(text)
        assert store.read(asked(), tmp_path) is None
        assert store.cached(asked(), lambda: ANSWER, tmp_path) == ANSWER
        assert file.read_bytes() == whole


WRITER = """
import sys
from pathlib import Path
from tactus.core import store
for _ in range(100):
    store.write(store.key("test", seed=1), list(range(20000)), Path(sys.argv[1]))
"""


def test_two_processes_at_once_leave_a_whole_answer(tmp_path: Path) -> None:
    store.write(asked(), list(range(20000)), tmp_path)
    command = [sys.executable, "-c", WRITER, str(tmp_path)]
    writers = [subprocess.Popen(command, cwd=ROOT) for _ in range(2)]
    looked = 0
    while any(writer.poll() is None for writer in writers):
        assert store.read(asked(), tmp_path) is not None
        looked += 1
    assert looked
    assert [writer.returncode for writer in writers] == [0, 0]
    assert len(list(store.place(asked(), tmp_path).parent.iterdir())) == 1


def test_a_run_can_have_a_store_of_its_own(tmp_path: Path, monkeypatch) -> None:
    store.write(asked(), ANSWER, tmp_path)
    monkeypatch.setenv(store.VARIABLE, str(tmp_path / "own"))
    assert store.read(asked(), tmp_path) is None
    monkeypatch.setenv(store.VARIABLE, "own")
    with pytest.raises(InputError, match="TACTUS_STORE: got 'own', expected an absolute path"):
        store.read(asked(), tmp_path)


class Copy:
    """A copy of the sources, which may be changed, and the keys that they give."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch):
        self.folder = folder
        for room in ROOMS:
            shutil.copytree(
                ROOT / room,
                folder / room,
                ignore=lambda _, names: [n for n in names if "." in n and not n.endswith(".py")],
            )
        monkeypatch.setattr(closure, "ROOT", folder)
        self.jobs = [
            Job(scene, part.entity, part.block, part.area, ("file.v",), "icarus", build=folder)
            for scene in map(load_scene, ("digit", "digit-hybrid"))
            for part in walk(scene.twin())
            if not part.part_of
        ]
        for job in self.jobs:
            job.hdl_folder.mkdir(parents=True, exist_ok=True)
            (job.hdl_folder / "file.v").write_text("module file; // exported")

    def add(self, file: str, text: str) -> None:
        with (self.folder / file).open("a", encoding="utf-8") as handle:
            handle.write(text)

    def benches(self) -> dict[tuple[str, str], store.Key]:
        self.forget()
        return {(job.scene.name, job.block): results.bench_key(job) for job in self.jobs}

    @staticmethod
    def forget() -> None:
        """What one process asks only once."""
        own = (results.bench_modules, results._code, results._reading)
        for cached in (closure.file_of, closure.code_of, closure.imported_by, *own):
            cached.cache_clear()


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    yield Copy(tmp_path, monkeypatch)
    monkeypatch.undo()
    Copy.forget()


def changed(before: dict, after: dict) -> set:
    return {name for name, one in before.items() if after[name] != one}


def test_words_and_pages_run_nothing_again(sources: Copy) -> None:
    benches = sources.benches()
    proofs = score._scripts("same")
    for file in (
        TWIN,
        "tb/layers/tb_output_controller.py",
        "tb/common/bench.py",
        "tactus/verify/sign_off/mutate/same.py",
    ):
        sources.add(file, COMMENT)
    sources.add("tactus/report/page/content.py", CODE)
    assert changed(benches, sources.benches()) == set()
    assert score._scripts("same") == proofs
    sources.add("tactus/verify/sign_off/mutate/same.py", CODE)
    Copy.forget()
    assert score._scripts("same") != proofs


def test_a_change_of_a_twin_runs_its_benches_and_no_others(sources: Copy) -> None:
    """Its own, those that play the whole design, and those that import the oracles of designs."""
    benches = sources.benches()
    sources.add(TWIN, CODE)
    found = changed(benches, sources.benches())
    asking = {
        (job.scene.name, job.block)
        for job in sources.jobs
        for modules in [results.bench_modules(job.area, job.block)]
        if (job.scene.name == "digit-hybrid" and results.asks_for_scene(modules))
        or "golden.networks.oracle" in modules
    }
    assert ("digit-hybrid", "hybrid") in asking
    assert found == {("digit-hybrid", "output_controller"), *asking}
    assert benches.keys() - found


def test_a_change_of_a_bench_or_of_the_tools_runs_that_bench(sources: Copy, monkeypatch) -> None:
    benches = sources.benches()
    sources.add("tb/layers/tb_output_controller.py", CODE)
    assert changed(benches, sources.benches()) == {("digit-hybrid", "output_controller")}
    monkeypatch.setattr(results, "_tools", lambda _: ["icarus 99"])
    assert changed(benches, sources.benches()) == benches.keys()


def test_keys_that_a_module_declares_are_its_code(tmp_path: Path) -> None:
    module, told = tmp_path / "keys.py", closure.code_of.__wrapped__
    module.write_text("KEYS = load_keys(file)")
    without = told(module)
    module.with_suffix(".toml").write_text("[data]")
    assert told(module) == f"{without}\n[data]"


@pytest.mark.parametrize(
    "file", ["scene/keys.toml", "sizing/cells.csv", "export/core.jinja", "scene/reading.py"]
)
def test_what_an_export_depends_on_makes_it_old(sources: Copy, file: str) -> None:
    asked = exporter._sources.__wrapped__
    sources.forget()
    before = asked()
    sources.add(f"tactus/{file}", COMMENT)
    assert asked() != before


def test_modules_that_are_found_by_name_are_listed() -> None:
    """Others import by text, which ``closure`` reads, or stand in no key."""
    named = ("golden", "hdl", "tactus/network_files", "tactus/scene")
    found = {
        ".".join(file.relative_to(ROOT).with_suffix("").parts)
        for room in named
        for file in (ROOT / room).rglob("*.py")
        if "import_module(" in file.read_text()
    }
    assert found == set(closure.DISCOVERIES)


@contextmanager
def umask(mask: int) -> Iterator[None]:
    before = os.umask(mask)
    try:
        yield
    finally:
        os.umask(before)


@pytest.mark.parametrize(("mask", "file", "folder"), [(0o022, 0o644, 0o755), (0o077, 0o600, 0o700)])
def test_permissions_are_those_of_the_umask(
    tmp_path: Path, mask: int, file: int, folder: int
) -> None:
    with umask(mask):
        for _ in range(2):  # new, and in place of another
            with replace_file(tmp_path / "a.csv") as path:
                path.write_text("1\n", encoding="utf-8")
            with replace_folder(tmp_path / "b") as path:
                (path / "c.csv").write_text("1\n", encoding="utf-8")
            assert (tmp_path / "a.csv").stat().st_mode & 0o777 == file
            assert (tmp_path / "b").stat().st_mode & 0o777 == folder
            assert (tmp_path / "b" / "c.csv").stat().st_mode & 0o777 == file
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "b"]


def half(replace: Callable, target: Path, file: str) -> None:
    with replace(target) as path:
        (path / file).write_text("new", encoding="utf-8")
        raise InputError("half")


def test_a_failure_leaves_what_was(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("old", encoding="utf-8")
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "c.csv").write_text("old", encoding="utf-8")
    for change, target, file in ((replace_file, "a.csv", ""), (replace_folder, "b", "c.csv")):
        with pytest.raises(InputError, match="half"):
            half(change, tmp_path / target, file)
        assert (tmp_path / target / file).read_text(encoding="utf-8") == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "b"]


def test_several_files_are_replaced_or_none(tmp_path: Path) -> None:
    """This holds even if the fault only shows when the last file is renamed."""
    paths = [tmp_path / "new.csv", tmp_path / "old.csv", tmp_path / "last.csv"]
    paths[1].write_text("old", encoding="utf-8")

    def replace(fault: Callable[[], object]) -> None:
        with replace_files(paths) as temporaries:
            for temporary in temporaries:
                temporary.write_text("new", encoding="utf-8")
            fault()

    with pytest.raises(InputError, match=r"last.csv: cannot be written: Is a directory"):
        replace(paths[2].mkdir)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["last.csv", "old.csv"]
    assert paths[1].read_text(encoding="utf-8") == "old"
    paths[2].rmdir()
    replace(lambda: None)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["last.csv", "new.csv", "old.csv"]
    assert {path.read_text(encoding="utf-8") for path in paths} == {"new"}


def test_what_can_be_written_is_found_out_without_writing(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("old", encoding="utf-8")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "to-pipe").symlink_to("pipe")
    for name in ("pipe", "to-pipe"):
        with pytest.raises(InputError, match="cannot be written: got no regular file"):
            check_writable([tmp_path / name])
        with pytest.raises(InputError, match="got no reg"), replace_file(tmp_path / name):
            pass
    assert (tmp_path / "to-pipe").is_fifo()
    (tmp_path / "to-pipe").unlink()
    (tmp_path / "pipe").unlink()
    check_writable([tmp_path / "a.csv", tmp_path / "b" / "c" / "d.csv"])
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]
    for name in ("a.csv/b.csv", ".", "x" * 5000, "b/\0"):
        with pytest.raises(InputError, match="cannot be written: "):
            check_writable([tmp_path / name])
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]


def test_one_file_by_two_names(tmp_path: Path) -> None:
    (tmp_path / "a").touch()
    (tmp_path / "link").symlink_to("a")
    (tmp_path / "later").symlink_to("not-yet")
    (tmp_path / "hard").hardlink_to(tmp_path / "a")
    for one, other in (("a", "b/../a"), ("a", "link"), ("not-yet", "later"), ("a", "hard")):
        assert same_file(tmp_path / one, tmp_path / other)
    for one, other in (("a", "b"), ("a", "A"), ("link", "later")):
        assert not same_file(tmp_path / one, tmp_path / other)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


class Clock:
    """A clock that stands still until a test moves it."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_a_line_at_the_beginning_every_few_seconds_and_at_the_end() -> None:
    stream, clock = io.StringIO(), Clock()
    with Progress("digit: simulating", 4, "benches", stream, clock) as progress:
        clock.now += PAUSE - 1
        progress.step()
        clock.now += 2
        progress.step("best 3")
        progress.say("FAIL")
        progress.step()
        clock.now += 1
        progress.step()
    assert stream.getvalue().splitlines() == [
        "digit: simulating: 0 of 4 benches",
        "digit: simulating: 2 of 4 benches, about 5 s left, best 3",
        "FAIL",
        "digit: simulating: 4 of 4 benches in 6 s",
    ]


def test_what_is_left_counts_how_long_parts_take() -> None:
    """The last part takes three times as long as the second; processes start during the first."""
    stream, clock = io.StringIO(), Clock()
    with Progress("load", 3, "parts", stream, clock, costs=[1, 1, 3]) as progress:
        for seconds in (10 * PAUSE, PAUSE, 3 * PAUSE):
            clock.now += seconds
            progress.step()
    assert stream.getvalue().splitlines() == [
        "load: 0 of 3 parts",
        "load: 1 of 3 parts, 40 s",
        "load: 2 of 3 parts, about 12 s left",
        "load: 3 of 3 parts in 56 s",
    ]


def test_a_terminal_shows_one_line() -> None:
    stream, clock = Terminal(), Clock()
    with Progress("a", 2, "parts", stream, clock) as progress:
        for _ in range(2):
            clock.now += 1
            progress.step()
    shown = stream.getvalue()
    assert shown.count("\n") == 1
    assert shown.split("\r\x1b[K")[1:] == [
        "a: 0 of 2 parts",
        "a: 1 of 2 parts, about 1 s left",
        "a: 2 of 2 parts in 2 s\n",
    ]


def test_of_parts_that_differ_nothing_is_estimated_and_each_is_named() -> None:
    stream, clock = io.StringIO(), Clock()
    with Progress("digit on a board", 2, "steps", stream, clock, alike=False) as progress:
        with progress.running("export"):
            clock.now += 1
        progress.step()
        for name in ("synthesis", "packing"):
            with progress.running(name):
                clock.now += 100
        progress.step("packed")
    assert stream.getvalue().splitlines() == [
        "digit on a board: 0 of 2 steps",
        "digit on a board: 0 of 2 steps, running export",
        "digit on a board: 1 of 2 steps, 1 s, running synthesis",
        "digit on a board: 1 of 2 steps, 2 min, running packing",
        "digit on a board: 2 of 2 steps in 3 min, packed",
    ]


def waited_for(stream: io.StringIO, pattern: str) -> None:
    """Wait until the stream has such a line. A minute is much longer than it takes."""
    end = time.monotonic() + 60
    while not re.search(pattern, stream.getvalue(), re.M):
        assert time.monotonic() < end, stream.getvalue()
        time.sleep(0.01)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PAUSE", 0.05)
    monkeypatch.setattr(module, "BEAT", 0.01)


def test_what_runs_is_named_while_nothing_ends(quick: None) -> None:
    stream = io.StringIO()
    with Progress("simulating", 5, "benches", stream) as progress:
        names = ["engine", "top", "a"]
        with ExitStack() as stack:
            for name in names:
                stack.enter_context(progress.running(name))
            waited_for(stream, r"^simulating: 0 of 5 benches, running engine, top, a$")
            stack.enter_context(progress.running("b"))
            waited_for(stream, r", running engine, top, a and 1 more$")
    assert not [thread for thread in threading.enumerate() if thread.name == "progress"]


def test_a_stage_says_that_it_is_still_there(quick: None) -> None:
    stream = io.StringIO()
    with stage("digit: exporting", stream):
        waited_for(stream, r"\Adigit: exporting\n(digit: exporting, 0 s\n)")
    ended = stream.getvalue()
    time.sleep(0.2)
    assert stream.getvalue() == ended


@pytest.mark.parametrize("fault", ["", "venv", "pip"])
def test_setting_up_prints_what_pip_does(tmp_path: Path, monkeypatch, capfd, fault: str) -> None:
    """The Python of this test installs nothing, but prints messages."""
    python = tmp_path / "python"
    python.write_text(
        f"""#!/bin/sh
[ "$2" = "{fault}" ] && exit 3
if [ "$2" = venv ]; then mkdir -p "$4/bin"; cp "$0" "$4/bin/python"; fi
if [ "$2" = pip ]; then echo "Collecting numpy ($*)"; fi
"""
    )
    python.chmod(0o755)
    venv = tmp_path / "my env"
    monkeypatch.setattr(sys, "executable", str(python))
    monkeypatch.setattr(sys, "argv", ["set_up", str(venv)])
    assert set_up.main() == (3 if fault else 0)
    said = capfd.readouterr().out
    assert said.startswith(f"setting up {venv}\n")
    if not fault:
        assert f"installing into {venv} what pyproject.toml names\nCollecting numpy (" in said
        assert "--quiet" not in said
        assert said.endswith("-e .[dev])\n")


def test_setting_up_needs_nothing_that_is_not_there_yet() -> None:
    """A Python that only has its standard library can import it."""
    root = Path(__file__).parents[1]
    words = [sys.executable, "-S", "-E", "-c", "import tactus.cli.set_up"]
    subprocess.run(words, cwd=root, check=True)
