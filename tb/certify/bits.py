"""Single bits of a delivered design are changed, and the script of the certificate must find each.

Two scores are counted apart. The step that compares digests finds any changed bit. The other steps
are run without it, on the same changes; of these only the ones that read the changed file, the
quickest first, up to the first that is red. What none finds must be shown to change nothing.
"""

from __future__ import annotations

import os
import random
import re
import shutil
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from golden.input_error import InputError
from hdl.export.exporter import compile_order
from tb.certify.delivered import LANGUAGES, check
from tb.certify.equality import NETLIST, ghdl_netlist
from tb.certify.results import OUTPUT
from tb.sign_off.equal_proof import EQUAL, compare

WORDS = "words of memories"
KINDS = (*LANGUAGES, WORDS)
# The steps that read a file of the design in each language, the quickest first.
READERS = {"vhdl": ("netlist", "vhdl"), "verilog": ("equality", "verilog")}
# Why a change that no step finds changes nothing.
TEXT = "nothing that a compiler reads"
SAME_NETLIST = "GHDL makes the same netlist"
PROVED = "proved to be the same function"
# The processor time of one run of a tool.
SECONDS = 120
# A word of a memory, as it stands in VHDL or in Verilog.
_WORD = re.compile(rb"X\"([0-9a-fA-F]+)\"|\d+'h([0-9a-fA-F]+)|<= (\d+);")


@dataclass(frozen=True)
class Change:
    """A bit of a file of the design.

    Attributes
    ----------
    kind : str
        One of ``KINDS``.
    file : str
        Below the folder of the certificate.
    place : int
        The number of its byte.
    bit : int
    """

    kind: str
    file: str
    place: int
    bit: int

    @property
    def language(self) -> str:
        return self.file.split("/")[1]

    @property
    def entity(self) -> str:
        return Path(self.file).stem

    def make(self, folder: Path) -> None:
        """Change it in a copy of the folder."""
        file = folder / self.file
        data = bytearray(file.read_bytes())
        data[self.place] ^= 1 << self.bit
        file.write_bytes(data)

    def describe(self, folder: Path) -> str:
        """Where it is, and the line before and after; the folder is unchanged."""
        data = (folder / self.file).read_bytes()
        start = data.rfind(b"\n", 0, self.place) + 1
        end = data.find(b"\n", self.place)
        changed = bytearray(data)
        changed[self.place] ^= 1 << self.bit
        before, after = (text[start:end].decode("latin-1").strip() for text in (data, changed))
        number = data.count(b"\n", 0, self.place) + 1
        return f"{Path(self.file).name}:{number}: {before!r} to {after!r}"


@dataclass(frozen=True)
class Fate:
    """What became of a change.

    Attributes
    ----------
    change : Change
    where : str
        The line before and after.
    digest : bool
        Whether the step that compares digests is red.
    step : str
        The first of the other steps that is red; empty for none.
    same : str
        If no step finds it, why it changes nothing; empty where that is not shown.
    """

    change: Change
    where: str
    digest: bool
    step: str
    same: str

    @property
    def survives(self) -> bool:
        """Whether nothing but the digest tells it from a change of nothing."""
        return not self.step and not self.same


def design_files(folder: Path, language: str) -> list[str]:
    """The files of the design in one language, below the folder of the certificate."""
    place = f"design/{language}"
    return [f"{place}/{name}" for name in compile_order(folder / place)]


def draw(folder: Path, count: int, seed: int) -> list[Change]:
    """Random changes, about as many of each of ``KINDS``; no change is drawn twice.

    Of a kind each byte is as likely as the others. A changed digit of a word stays a hexadecimal
    digit, so that it is another word. Not every design has words.
    """
    chance = random.Random(seed)
    places = {kind: found for kind in KINDS if (found := _places(folder, kind))}
    changes: dict[Change, None] = {}
    for number, (kind, found) in enumerate(places.items()):
        share = (count + number) // len(places)
        for name, place in chance.sample(found, min(share, len(found))):
            bits = list(range(8))
            if kind == WORDS:
                digit = (folder / name).read_bytes()[place]
                bits = [n for n in range(4) if chr(digit ^ 1 << n) in "0123456789abcdefABCDEF"]
            changes[Change(kind, name, place, chance.choice(bits))] = None
    return list(changes)


def _places(folder: Path, kind: str) -> list[tuple[str, int]]:
    """The files and bytes that may be changed."""
    languages = LANGUAGES if kind == WORDS else (kind,)
    places: list[tuple[str, int]] = []
    for name in (name for language in languages for name in design_files(folder, language)):
        data = (folder / name).read_bytes()
        if kind != WORDS:
            places += [(name, place) for place in range(len(data))]
        elif "memory" in name:
            for found in _WORD.finditer(data):
                group = found.lastindex or 1
                places += [(name, place) for place in range(*found.span(group))]
    return places


def try_bits(
    folder: Path, count: int, seed: int, tell: Callable[[str], None] = lambda _: None
) -> list[Fate]:
    """Change bits of a certificate, each in a copy of its own, and run the script on it.

    Parameters
    ----------
    folder : Path
        It is not changed.
    count, seed : int
    tell : callable
        Is called with a line for each change that survives.
    """
    # The script runs in its own folder, where Yosys as WebAssembly sees no others.
    with (
        tempfile.TemporaryDirectory(prefix=".bits", dir=folder.parent) as name,
        ThreadPoolExecutor(os.cpu_count()) as pool,
    ):

        def work(numbered: tuple[int, Change]) -> Fate:
            number, change = numbered
            fate = _try(folder, change, Path(name) / str(number))
            if fate.survives:
                tell(f"no step finds {fate.where}")
            return fate

        return list(pool.map(work, enumerate(draw(folder, count, seed))))


def _try(folder: Path, change: Change, copy: Path) -> Fate:
    shutil.copytree(folder, copy, ignore=shutil.ignore_patterns(OUTPUT))
    change.make(copy)

    def red(step: str, **variables: str) -> bool:
        return check(copy, step, quiet=True, SECONDS_EACH=str(SECONDS), **variables) == 1

    digest = red("digests")
    quick, slow = READERS[change.language]
    step = same = ""
    if red(quick, ENTITIES=change.entity):
        step = quick
    elif _is_read_alike(folder, copy, change):
        same = TEXT
    elif red(slow):
        step = slow
    else:
        same = _same(folder, copy, change)
    shutil.rmtree(copy)
    return Fate(change, change.describe(folder), digest, step, same)


def _texts(folder: Path, copy: Path, change: Change) -> tuple[str, str]:
    """The file as it was and as it is."""
    sound, changed = ((place / change.file).read_bytes() for place in (folder, copy))
    return sound.decode("latin-1"), changed.decode("latin-1")


def _is_read_alike(folder: Path, copy: Path, change: Change) -> bool:
    sound, changed = _texts(folder, copy, change)
    return what_is_read(sound, change.language) == what_is_read(changed, change.language)


def _same(folder: Path, copy: Path, change: Change) -> str:
    """Why a change of what is read changes nothing; empty where that is not shown."""
    # A tool may refuse the changed file.
    with suppress(InputError):
        if change.language == "vhdl":
            top = Path(design_files(folder, "vhdl")[-1]).stem
            netlist = (folder / "equal" / NETLIST).read_text(encoding="utf-8")
            return SAME_NETLIST if ghdl_netlist(copy, top) == netlist else ""
        others = [f for f in (folder / "design/verilog").glob("*.v") if f.stem != change.entity]
        sound, changed = _texts(folder, copy, change)
        found = compare(change.entity, sound, changed, others)
        return PROVED if found["result"] == EQUAL else ""
    return ""


def what_is_read(text: str, language: str) -> str:
    """The code of a file, in which nothing is left that a compiler does not read."""
    text = re.sub(r"--.*" if language == "vhdl" else r"//.*", "", text)
    text = re.sub(r"\s+", " ", text, flags=re.ASCII)
    if language == "vhdl":
        # Letters in VHDL are alike in both cases, but in characters and strings.
        parts = re.split(r"('.'|\"[^\"]*\")", text)
        text = "".join(p if n % 2 else p.lower() for n, p in enumerate(parts))
    return text
