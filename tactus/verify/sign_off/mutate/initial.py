"""Mutants of the words that an ``initial`` block puts into a memory: one bit of one word each.

Yosys' mutants change logic and what is connected to a memory, but no word in it. These change the
text of the Verilog, and the trace of the bench is replayed on each, as on all other mutants. There
is no proof that a mutant computes the same: where no bench tells a bit, it counts as not detected.
That such a bit is right anyway is shown by the proof for every frame, which computes with each
word.
"""

import random
import re
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from os import cpu_count
from pathlib import Path
from typing import Any

from tactus.core import store
from tactus.core.closure import code
from tactus.verify.benches.runner import Job
from tactus.verify.benches.tools import version
from tactus.verify.sign_off.mutate.replay import replay
from tactus.verify.sign_off.mutate.score import COUNT, SEED, prepare, record_trace

_MEMORY = re.compile(r"^reg \[(\d+):0\] +(\w+) \[0:\d+-1\];", re.MULTILINE)
_WORD = re.compile(r"^( *)(\w+)\[(\d+)\] <= (?:\d+'h([0-9a-f]+)|(\d+));", re.MULTILINE)


@dataclass(frozen=True)
class Word:
    """A word that the Verilog of an entity puts into a memory.

    span: Where the assignment stands in the text.
    """

    memory: str
    address: int
    width: int
    value: int
    span: tuple[int, int]


def words_of(text: str) -> list[Word]:
    """The words that exported Verilog puts into memories one by one."""
    widths = {name: int(top) + 1 for top, name in _MEMORY.findall(text)}
    found = []
    for one in _WORD.finditer(text):
        _, memory, address, digits, number = one.groups()
        if memory in widths:
            value = int(digits, 16) if digits else int(number)
            found.append(Word(memory, int(address), widths[memory], value, one.span()))
    return found


def flipped(text: str, word: Word, bit: int) -> str:
    """The same Verilog with one bit of a word changed."""
    start, end = word.span
    value = word.value ^ 1 << bit
    return (
        f"{text[:start]}    {word.memory}[{word.address}] <= {word.width}'h{value:x};{text[end:]}"
    )


def drawn(words: list[Word], count: int, seed: int) -> list[tuple[Word, int]]:
    """Different bits of words, each as likely as the others; all if there are no more."""
    every = [(word, bit) for word in words for bit in range(word.width)]
    return random.Random(seed).sample(every, min(count, len(every)))


def score_words(
    job: Job,
    count: int = COUNT,
    seed: int = SEED,
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, Any] | None:
    """How many changed bits of the words of an entity the bench detects; None without words."""
    text = (job.hdl_folder / f"{job.entity}.v").read_text(encoding="utf-8")
    words = words_of(text)
    if not words:
        return None
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(cpu_count()) as pool:
        # One of Yosys' mutants is made because the sound netlist comes with it.
        subject = prepare(job, Path(name), count=1)
        trace, _ = record_trace(subject)
        chosen = drawn(words, count, seed)
        tell(f"{len(chosen)} bits, {trace.rows} clocks")
        parts = [subject.folder / file for file in job.files if file != f"{job.entity}.v"]
        scripts = code([f"{__package__}.replay", __name__], lambda *_: False)

        def play(number: int) -> list[str]:
            word, bit = chosen[number]
            asked = store.key(
                "replay of a word",
                netlists=subject.key,
                trace=trace.digest,
                word=f"{word.memory} {word.address} {bit}",
                simulator=version("icarus"),
                scripts=scripts,
            )

            def work() -> list[str]:
                changed = subject.folder / f"word{number}.v"
                changed.write_text(flipped(text, word, bit), encoding="utf-8")
                return replay(trace, [changed, *parts])

            found: list[str] = store.cached(asked, work)
            return found

        differ = list(pool.map(play, range(len(chosen))))
    left = [
        f"{w.memory}[{w.address}] bit {b}"
        for (w, b), d in zip(chosen, differ, strict=True)
        if not d
    ]
    return {
        "words": len(words),
        "bits": sum(word.width for word in words),
        "mutants": len(chosen),
        "killed": len(chosen) - len(left),
        "score": round((len(chosen) - len(left)) / len(chosen), 4),
        "survivors": left,
    }
