"""replay_memory: the words of table and program, read once for every bit plane."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from golden.common.border import State
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.engine.fields import get
from golden.engine.formats import SAMPLE_SHIFT, WIDTH
from golden.engine.program import WORD_WIDTH
from golden.engine.program_words import ProgramWords
from golden.engine.replay import CLEAR, ONE_PLANE
from golden.engine.serial_program import ALL, DEEP, END, WIDE
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class ReplayMemory(ProgramWords):
    """Words of 36 bits, read neuron by neuron and pass by pass, and a table that is looked up.

    words, notes, table: See ``ProgramWords``. In the table slopes and intercepts alternate.
    segment_addr_width: Bits of the address of a word of the table.

    A pass ends with the word that is marked as the last for its plane; the next pass begins with
    the neuron's first word. After the pass of plane 0 comes the next neuron. Its first word follows
    the last word of the pass that read all words.
    """

    block = "replay_memory"
    segment_addr_width: int = field(kw_only=True)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port(
                "run", "words are read; otherwise the first word of the program in the first plane"
            ),
            input_port("finish", "from the next clock on the same as without `run`"),
            input_port(
                "segment",
                "address of a slope or an intercept",
                Unsigned(self.segment_addr_width),
                "segment_addr_width",
            ),
            input_port("look_up", "the word at `segment` is read; otherwise `table_word` is 0"),
            output_port("word", "word of the program", Unsigned(WORD_WIDTH)),
            output_port(
                "plane",
                "plane of `word`: one bit of 19 is set; the highest clears the sum",
                Unsigned(CLEAR + 1),
            ),
            output_port("first", "`word` is the first of its pass"),
            output_port("table_word", "the word at `segment`, 1 clock later", Unsigned(WIDTH)),
        )

    @property
    def latency(self) -> int:
        return 1

    def facts(self) -> tuple[str, ...]:
        return (f"{CLEAR} planes",)

    @property
    def states(self) -> tuple[State, ...]:
        ends = self.begin, self.begin + len(self.words)
        return (State("place", range(*ends)), State("plane", range(CLEAR + 1)))

    def process(
        self, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> tuple[Codes, Codes, Codes]:
        """Word, plane and first in each clock; the first clock holds the program's first word."""
        place, plane, first = self.places(run, finish, reset)
        return np.array(self.contents, dtype=np.int64)[place], 1 << plane, first

    def places(
        self, run: ArrayLike, finish: ArrayLike, reset: ArrayLike
    ) -> tuple[Codes, Codes, Codes]:
        """The address of the word, the number of its plane, and first, in each clock."""
        contents = self.contents
        here = base = following = self.begin
        plane, first = CLEAR, True
        found = []
        columns = (np.asarray(c, dtype=bool).tolist() for c in (run, finish, reset))
        for runs, finishes, resets in zip(*columns, strict=True):
            found.append((here, plane, first))
            first = self._ends(contents[here], plane)
            behind = (here + 1) % len(contents)
            here = base if first else behind
            if first:
                # Only the pass that reads every word of a neuron reaches the first word of the next
                # one.
                following = behind if plane == ONE_PLANE else following
                base = following if plane == 1 else base
                plane = (plane - 1) % (CLEAR + 1)
            if resets or finishes or not runs:
                base, plane = self.begin, CLEAR
        table = np.array(found, dtype=np.int64).T
        return table[0], table[1], table[2]

    def _ends(self, word: int, plane: int) -> bool:
        """Whether a pass ends with this word."""
        if plane == CLEAR:
            return True
        if plane == ONE_PLANE:
            return get(word, END) == ALL
        return get(word, END) >= (WIDE if plane >= SAMPLE_SHIFT else DEEP)

    def look_up(self, segment: ArrayLike, look_up: ArrayLike) -> Codes:
        """The word of the table at each address; 0 where ``look_up`` is low."""
        words = np.array(self.contents, dtype=np.int64)[np.asarray(segment)] & ((1 << WIDTH) - 1)
        return np.where(np.asarray(look_up, dtype=bool), words, 0)
