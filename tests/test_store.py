"""The store: what enters a key, and what is left of a file that is damaged or written twice."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from golden.common.block import walk
from golden.input_error import InputError
from tactus.core import closure, store
from tactus.core.fingerprint import ROOT
from tactus.core.folders import ROOMS
from tactus.report.measure import store as parts
from tactus.report.measure.registry import TABLES
from tactus.report.measure.steps import table_key
from tactus.scene import load_scene
from tactus.verify.benches import kept_results
from tactus.verify.benches.runner import Job
from tactus.verify.sign_off.mutate.score import score_state

ANSWER = {"compared": 7, "facts": [1.5, "word"]}
COMMENT = "\n# Said otherwise.\n"
CODE = "\n\nADDED = 1\n"
TWIN = "golden/engine/round_saturate.py"


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


def test_a_file_tells_of_what_it_is(tmp_path: Path) -> None:
    store.write(asked(tools=["icarus 12"], text="x" * 201), ANSWER, tmp_path)
    (file,) = (tmp_path / "store" / "test").iterdir()
    found = json.loads(file.read_text())
    assert found["key"]["seed"] == "1"
    assert sorted(found["key"]) == ["seed", "text", "tools"]
    assert found["key"]["tools"] == '["icarus 12"]'
    assert found["answer"] == ANSWER


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
        return {(job.scene.name, job.block): kept_results.bench_key(job) for job in self.jobs}

    def tables(self) -> dict[str, store.Key]:
        self.forget()
        return {name: table_key(name) for name in TABLES}

    @staticmethod
    def forget() -> None:
        """What one process asks only once."""
        own = (kept_results._modules, kept_results._code, kept_results._reading, parts._data)
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
    benches, tables = sources.benches(), sources.tables()
    score = score_state("netlists", "trace", [], [])
    for file in (
        TWIN,
        "tb/engine/tb_round_saturate.py",
        "tb/common/bench.py",
        "tactus/report/measure/networks.py",
        "tactus/verify/sign_off/mutate/same.py",
    ):
        sources.add(file, COMMENT)
    sources.add("tactus/report/page/content.py", CODE)
    sources.add("tactus/report/draw/plots.py", CODE)
    assert changed(benches, sources.benches()) == set()
    assert changed(tables, sources.tables()) == set()
    assert score_state("netlists", "trace", [], []) == score
    sources.add("tactus/verify/sign_off/mutate/same.py", CODE)
    Copy.forget()
    assert score_state("netlists", "trace", [], []) != score


def test_a_change_of_a_twin_runs_its_benches_and_no_others(sources: Copy) -> None:
    """Its own, those that play the whole design, and those that import the oracles of designs."""
    benches = sources.benches()
    sources.add(TWIN, CODE)
    found = changed(benches, sources.benches())
    asking = {
        (job.scene.name, job.block)
        for job in sources.jobs
        for modules in [kept_results.bench_modules(job.area, job.block)]
        if (job.scene.name == "digit" and kept_results.asks_for_scene(modules))
        or "golden.networks.oracle" in modules
    }
    assert ("digit", "engine") in asking
    assert found == {("digit", "round_saturate"), *asking}
    assert ("digit", "operand_memory") in benches.keys() - found


def test_a_change_of_a_bench_runs_that_bench(sources: Copy) -> None:
    benches, tables = sources.benches(), sources.tables()
    sources.add("tb/engine/tb_round_saturate.py", CODE)
    assert changed(benches, sources.benches()) == {("digit", "round_saturate")}
    assert changed(tables, sources.tables()) == set()


def test_the_tools_are_a_part(sources: Copy, monkeypatch: pytest.MonkeyPatch) -> None:
    job = sources.jobs[0]
    before = kept_results.bench_key(job)
    monkeypatch.setattr(kept_results, "_tools", lambda _: ["icarus 99"])
    assert kept_results.bench_key(job) != before


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
