"""From "differs" to a frame: samples at which two values differ."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from tactus.verify.every_frame.operators import signed
from tactus.verify.every_frame.sequences import Sequences
from tactus.verify.every_frame.sums import Sum, Value, Word

BATCH = 4096
SEED = 1
# Frames from which the search climbs.
STARTS = 20
# Frames by which words are told apart, and the most bits of a word that is looked at.
BESIDE, WIDEST = 100, 60
# An engine keeps the sign of its words of 18 bits beside the other bits.
BELOW_SIGN = 17


class Evaluated:
    """Numbers of values for many frames, shape (frames, samples); `words` are those of the
    samples."""

    def __init__(self, words: Sequence[Word], frames: Any):
        self.codes: dict[Word, Any] = {w: frames[:, k] for k, w in enumerate(words)}
        self.count = len(frames)

    def word(self, word: Word) -> Any:
        if word not in self.codes:
            assert word.base
            self.codes[word] = self.value(word.base.total) + word.offset >> word.shift
        return self.codes[word]

    def value(self, v: Value) -> Any:
        if isinstance(v, int):
            return np.full(self.count, v, dtype=np.int64)
        result = np.full(self.count, v.constant, dtype=np.int64)
        for word, term in v.terms.items():
            result += term.at(self.word(word))
        return result


def differing_frame(samples: Sequence[Value], got: Value, expected: Value) -> list[int] | None:
    """Samples at which the two differ, or None where the search finds none."""
    words = [w for v in samples if isinstance(v, Sum) for w in v.terms]
    low, high = words[0].low, words[0].high
    rng = np.random.default_rng(SEED)
    frames = rng.integers(low, high + 1, (BATCH, len(words)))
    frames[: BATCH // 4] = rng.choice([low, -1, 0, high], (BATCH // 4, len(words)))

    def differs(tried: Any) -> list[int] | None:
        now = Evaluated(words, tried)
        apart = np.flatnonzero(now.value(got) != now.value(expected))
        return [int(x) for x in tried[apart[0]]] if len(apart) else None

    found = differs(frames)
    if found is not None:
        return found
    # Words on which they hang: drive each to codes at which it has not been, one sample at a time.
    made = {w for v in (got, expected) if isinstance(v, Sum) for w in v.terms if w.base}
    for start in frames[:STARTS]:
        for word in made:
            target = int(rng.integers(word.low, word.high + 1))
            frame = start.copy()
            for k in range(len(words)):
                tried = np.repeat(frame[np.newaxis], BATCH, axis=0)
                tried[:, k] = np.linspace(low, high, BATCH).astype(np.int64)
                found = differs(tried)
                if found is not None:
                    return found
                codes = Evaluated(words, tried).word(word)
                frame = tried[int(np.abs(codes - target).argmin())]
    return None


def first_apart(proof: Sequences, frame: Sequence[int]) -> str:
    """The place of the network's first word that no word of the hardware is, in this frame and in
    some others.

    A word that makes up one that is found need not be found itself.
    """
    words = [w for v in proof.samples if isinstance(v, Sum) for w in v.terms]
    low, high = words[0].low, words[0].high
    others = np.random.default_rng(SEED).integers(low, high + 1, (BESIDE, len(words)))
    now = Evaluated(words, np.concatenate([[frame], others]))
    held = set()
    for e in proof.run.made.values():
        if e.result is not None and e.width < WIDEST:
            held.add(signed(now.value(e.result), e.width).tobytes())
    given, sound = proof.given["words"], set[int]()
    for k in reversed(range(len(given))):
        code = now.value(proof.inner[len(words) + k])
        if k in sound or held & {code.tobytes(), signed(code, BELOW_SIGN).tobytes()}:
            used = [i for i, _ in given[k].get("sum", [])] + [given[k].get("of", 0)]
            sound |= {k, *(i - len(words) for i in used)}
    apart = next((k for k in range(len(given)) if k not in sound), None)
    if apart is None:
        return "an output"
    return "network {}, layer {}, node {}".format(*given[apart]["place"])
