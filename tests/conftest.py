"""The two tiers of tests, what the tests of a run share, and small scenes."""

import os
import signal
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from refused import Desk
from shared import Shared

from golden.input_error import suggest
from golden.layers import sharing
from golden.trained.dense import DenseNetwork
from tactus.core.cli import HASH_SEED
from tactus.core.commands import COMMANDS, EVERYWHERE
from tactus.core.machine import closing
from tactus.core.store import VARIABLE
from tactus.scene import Scene, load_scene
from tactus.synth.tools import run_tool
from tactus.verify.benches.tools import simulator_versions
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

STARTED = time.perf_counter()
ROOT = Path(__file__).parents[1]
# A user may set these on the command line or in the environment.
GIVEN = {*EVERYWHERE, *(argument.name for c in COMMANDS for argument in c.arguments)}

# No test may depend on how busy the cores are.
settings.register_profile("untimed", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("untimed")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all", action="store_true", help="what make test ALL=1 adds, too")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "all_only: run by make test ALL=1 alone")
    config.addinivalue_line("markers", "pages: of the documentation; make test PAGES=1 runs these")
    # A shell that starts this in the background lets it ignore Ctrl-C, and so all that it starts.
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    # Hundreds of processes import the same modules. None of them should compile these again.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    # matplotlib keeps the list of fonts that it once found, for all environments of a user. One
    # that ran while its environment was removed leaves a list without the fonts it ships. So the
    # list of this environment stands in it, unless nothing can be written there.
    if os.access(sys.prefix, os.W_OK):
        os.environ["MPLCONFIGDIR"] = str(Path(sys.prefix) / "matplotlib")
    # The variables of this run, such as ALL=1, are not passed to the commands that tests call. A
    # test that keeps something names a folder of its own.
    for name in ("MAKEFLAGS", "MAKEOVERRIDES", "MAKELEVEL", "PYTEST_ADDOPTS", VARIABLE, *GIVEN):
        os.environ.pop(name, None)
    # So workers begin with the hash seed that exports need.
    os.environ.update(HASH_SEED)
    refuse_missing(config)


def refuse_missing(config: pytest.Config) -> None:
    """Refuse a file that is missing: where workers collect, nobody else says so."""
    for word in config.args:
        name = word.partition("::")[0]
        if not (config.invocation_params.dir / name).exists():
            files = [f"tests/{path.name}" for path in Path(__file__).parent.glob("test_*.py")]
            raise pytest.UsageError(f"TESTS={name}: no such file or folder{suggest(name, files)}")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skip the tests of the other tier, so that the summary counts them, or begin with these.

    They take longest. Each worker is dealt as many tests as the others, in this order, and one that
    has none left takes from the end of another's. So each begins with its part of the long tests:
    certificates, of which one takes minutes, before the others, of which neighbours share exports.
    """
    long = [item for item in items if item.get_closest_marker("all_only")]
    if not config.getoption("--all"):
        for item in long:
            item.add_marker(pytest.mark.skip(reason="left to make test ALL=1"))
        return
    first = [item for item in long if item.path.stem == "test_certify"]
    long = [item for item in long if item not in first]
    rest = [item for item in items if not item.get_closest_marker("all_only")]
    workers, count = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT") or 1), len(items)
    items.clear()
    for n in range(workers):
        items += first[n::workers]
        items += long[n * len(long) // workers : (n + 1) * len(long) // workers]
        end = (n + 1) * count // workers
        rest, taken = rest[max(0, end - len(items)) :], rest[: max(0, end - len(items))]
        items += taken


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the machine before the closing line of pytest."""
    terminalreporter.section("machine")
    for line in closing(time.perf_counter() - STARTED, **simulator_versions()):
        terminalreporter.line(line)


def pytest_sessionfinish(session: pytest.Session) -> None:
    """A selection of which no test runs is an error, as is a selection that matches none."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if reporter and session.exitstatus == pytest.ExitCode.OK and "passed" not in reporter.stats:
        session.exitstatus = pytest.ExitCode.NO_TESTS_COLLECTED
    if reporter and session.exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED:
        reporter.write_line("error: no test was chosen that could run")


def tiered(always: Iterable[Any], all_only: Iterable[Any]) -> list[Any]:
    """The values of a test's parameter: those of every run, and those that ALL=1 adds."""
    return [*always, *(pytest.param(value, marks=pytest.mark.all_only) for value in all_only)]


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Shared:
    """The folder that all workers of a run share. Each worker has its own below that of the run."""
    folder = tmp_path_factory.getbasetemp()
    return Shared(folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder)


@pytest.fixture(scope="session")
def yosys(shared: Shared) -> None:
    """Yosys has run once: its first run on a machine compiles it, on all cores, for a minute.

    Tests of two workers that call it first would each compile it.
    """
    shared.once("yosys", lambda: run_tool("yosys", ["-V"], shared.folder))


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture) -> Desk:
    """A 3:5:2 scene ``mine.toml`` in exact precision, and a way to call commands on it."""
    write_scene(tmp_path, "mine", "exact", [random_mlp((3, 5, 2), 1.0, 1)])
    return Desk(tmp_path, monkeypatch, capfd)


def on_engine(folder: Path, networks: list[DenseNetwork], **options: Any) -> Path:
    """A scene ``mine.toml`` of networks on an engine, written with options of ``write_scene``."""
    wanted = {"activation": "precise", "design": "engine", **options}
    return write_scene(folder, "mine", "exact", networks, **wanted)


@pytest.fixture
def small_scene(tmp_path: Path) -> Scene:
    """A 3:5:2 scene in exact precision."""
    mlp = random_mlp((3, 5, 2), 1.0, 1)
    return load_scene(str(write_scene(tmp_path, "small", "exact", [mlp])))


@pytest.fixture
def small_cascade(tmp_path: Path) -> Scene:
    """Networks 3:4:1, 4:3:1 and 5:2:1 in a cascade, exact precision."""
    mlps = [random_mlp((3 + i, 4 - i, 1), 1.0, i) for i in range(3)]
    return load_scene(str(write_scene(tmp_path, "chain", "exact", mlps, "cascade")))


@pytest.fixture(scope="module")
def few_runs() -> Iterator[None]:
    """Limit how often shared terms are looked for. More runs only find smaller graphs."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sharing, "RUNS", 2)
        sharing.shared.cache_clear()
        yield
    sharing.shared.cache_clear()


def recorded_of(name: str) -> dict[str, np.ndarray]:
    """What the framework that wrote an ONNX file of tests/data computes for some samples."""
    with np.load(ROOT / "tests" / "data" / "recorded.npz") as arrays:
        return {key.partition("/")[2]: arrays[key] for key in arrays if key.startswith(f"{name}/")}
