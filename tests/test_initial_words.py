"""Each word of a memory in the exported files is that of the twin, and mutants of words are found.

A bench cannot tell every bit: a low bit of a table of tanh may vanish in the rounding.
"""

import re
from collections.abc import Iterator

import pytest
from shared import Shared

from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_pair import BipartitePair
from golden.common.block import Block
from golden.engine.program_words import ProgramWords
from golden.networks.learning_engine import LearningEngine
from tactus.verify.benches.collected import BENCHES
from tactus.verify.benches.runner import Job
from tactus.verify.sign_off.mutate.initial import Word, drawn, flipped, score_words, words_of
from tactus.verify.sign_off.mutate.score import COUNT, SEED
from tactus.verify.sign_off.record import read_record
from tactus.verify.sign_off.subject import recorded_cases

WITH_WORDS = ("program_memory", "replay_memory", "bipartite", "learning_engine")
SCENES = ("digit", "digit-load", "comparison/digit-serial", "digit-fast")
Memories = dict[str, list[int]]


def of_twin(twin: Block) -> Memories:
    """The words that a twin has, by the end of the memory's name."""
    if isinstance(twin, (ProgramWords, LearningEngine)):
        return {"memory": list(twin.contents)}
    node = twin.activation if isinstance(twin, BipartitePair) else twin
    assert isinstance(node, Bipartite)
    if node.memory != "block_ram":
        return {}
    width = node.table.correction_width
    return {"bases": list(node.bases), "corrections": [w % (1 << width) for w in node.corrections]}


def in_verilog(job: Job) -> Memories:
    found: Memories = {}
    for word in words_of((job.hdl_folder / f"{job.entity}.v").read_text()):
        found.setdefault(word.memory, []).append(word.value)
        assert word.address == len(found[word.memory]) - 1
        assert word.value < 1 << word.width
    return found


def in_vhdl(job: Job) -> Memories:
    text = (job.hdl_folder / f"{job.entity}.vhd").read_text()
    found = {}
    for name, body in re.findall(r"constant (\w+): t_array_\w+ := \((.*?)\);", text, re.DOTALL):
        literals = re.findall(r'^ *(X?)"([0-9a-f]+)"', body, re.MULTILINE)
        found[name] = [int(digits, 16 if sign else 2) for sign, digits in literals]
    return found


def jobs_of(shared: Shared, simulator: str) -> Iterator[Job]:
    """The entities of cases and of some scenes that have words."""
    for block in (*WITH_WORDS, "bipartite_pair"):
        yield shared.subject(block, simulator)
    for name in SCENES:
        yield from (
            job
            for job in shared.jobs(name, simulator)
            if isinstance(job.twin, (ProgramWords, Bipartite, BipartitePair))
        )


@pytest.mark.parametrize("simulator", ["icarus", "ghdl"])
def test_each_word_is_that_of_the_twin(shared: Shared, simulator: str) -> None:
    read = {"icarus": in_verilog, "ghdl": in_vhdl}[simulator]
    compared = 0
    for job in jobs_of(shared, simulator):
        twin, exported = of_twin(job.twin), read(job)
        for name, words in exported.items():
            (expected,) = (known for end, known in twin.items() if name.endswith(end))
            # What the program does not use follows as zeros, which a loop writes.
            assert words == expected[: len(words)], f"{job.entity}: {name}"
            assert not any(expected[len(words) :]), f"{job.entity}: {name}"
            compared += len(words)
    assert compared > 5000


@pytest.fixture(scope="module")
def with_words(shared: Shared) -> dict[str, list[Word]]:
    """The words of each block that has some."""
    jobs = {block: shared.subject(block) for block in BENCHES}
    found = {b: words_of((j.hdl_folder / f"{j.entity}.v").read_text()) for b, j in jobs.items()}
    return {block: words for block, words in found.items() if words}


def test_words_are_recorded_where_there_are_some(with_words: dict[str, list[Word]]) -> None:
    for block in BENCHES:
        for name in recorded_cases(block):
            assert ("words" in read_record("mutation", name)) == (block in with_words), name


def test_the_score_is_of_these_words(with_words: dict[str, list[Word]]) -> None:
    for block, words in with_words.items():
        found = read_record("mutation", block)["words"]
        again = f"run: make mutate BLOCK={block} RECORD=1"
        assert (found["words"], found["bits"]) == (len(words), sum(w.width for w in words)), again
        assert found["killed"] + len(found["survivors"]) == found["mutants"] == COUNT
        assert found["score"] == round(found["killed"] / found["mutants"], 4)
        bits = {f"{word.memory}[{word.address}] bit {b}" for word, b in drawn(words, COUNT, SEED)}
        assert bits >= set(found["survivors"]), again


def test_a_changed_bit_is_in_the_word_alone(shared: Shared) -> None:
    job = shared.subject("program_memory")
    text = (job.hdl_folder / f"{job.entity}.v").read_text()
    words = words_of(text)
    for word, bit in drawn(words, 5, seed=3):
        changed = words_of(flipped(text, word, bit))
        values = [w.value ^ (1 << bit) * (w == word) for w in words]
        assert [w.value for w in changed] == values


def test_bits_are_drawn_without_repetition(with_words: dict[str, list[Word]]) -> None:
    words = with_words["program_memory"]
    chosen = drawn(words, 300, seed=1)
    assert len(set(chosen)) == 300
    assert chosen != drawn(words, 300, seed=2)
    assert len(drawn(words[:2], 300, seed=1)) == 2 * 36


def test_the_bench_finds_few_changed_bits(shared: Shared) -> None:
    """Each bit of these words is compared with the twin's by the bench."""
    found = score_words(shared.subject("program_memory"), count=3, seed=2)
    assert found is not None
    assert found["killed"] == 3
    assert score_words(shared.subject("abs_unit")) is None
