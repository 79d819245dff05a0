"""Changes single bits of the files that a certificate delivers."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from hdl.export.exporter import compile_order

KINDS = ("vhdl", "verilog", "words")
# A word of a memory, as it stands in VHDL or in Verilog.
WORDS = re.compile(rb"X\"([0-9a-fA-F]+)\"|\d+'h([0-9a-fA-F]+)|<= (\d+);")


@dataclass(frozen=True)
class Change:
    """A bit of a file, by the place of its byte."""

    file: str
    place: int
    bit: int

    def make(self, folder: Path) -> None:
        """Change it in a copy of the folder."""
        file = folder / self.file
        data = bytearray(file.read_bytes())
        data[self.place] ^= 1 << self.bit
        file.write_bytes(data)


def design_files(folder: Path, language: str) -> list[str]:
    """The files of the design in one language, below the folder of the certificate."""
    place = f"design/{language}"
    return [f"{place}/{name}" for name in compile_order(folder / place)]


def draw(folder: Path, kind: str, count: int, seed: int) -> Iterator[Change]:
    """Random changes of one of ``KINDS``; each byte of the files is as likely as the others.

    A changed digit of a word stays a hexadecimal digit, so that it is another word.
    """
    chance = random.Random(f"{kind} {seed}")
    languages = ("vhdl", "verilog") if kind == "words" else (kind,)
    names = [name for language in languages for name in design_files(folder, language)]
    places = []
    for name in names:
        data = (folder / name).read_bytes()
        if kind != "words":
            places += [(name, place) for place in range(len(data))]
        elif "memory" in name:
            for found in WORDS.finditer(data):
                group = found.lastindex or 1
                places += [(name, place) for place in range(*found.span(group))]
    for name, place in chance.sample(places, min(count, len(places))):
        if kind != "words":
            yield Change(name, place, chance.randrange(8))
            continue
        digit = (folder / name).read_bytes()[place]
        digits = [n for n in range(4) if chr(digit ^ 1 << n) in "0123456789abcdefABCDEF"]
        yield Change(name, place, chance.choice(digits))


def without_comments(data: bytes, language: str) -> str:
    """The code of a file, in which nothing is left that a compiler does not read."""
    text = data.decode("latin-1")
    text = re.sub(r"--.*|//.*", "", text)
    text = re.sub(r"\s+", " ", text)
    if language == "vhdl":
        # Letters in VHDL are alike in both cases, but in characters and strings.
        parts = re.split(r"('.'|\"[^\"]*\")", text)
        text = "".join(p if n % 2 else p.lower() for n, p in enumerate(parts))
    return text
