"""From "differs" to a frame: samples at which two values differ, and the bench that plays them."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from tb.every_frame.sums import Sum, Value, Word

BATCH = 4096
SEED = 1
# Frames from which the search climbs.
STARTS = 20


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
            low, high = int(self.word(word).min()), int(self.word(word).max())
            result += term.at(low, high)[self.word(word) - low]
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


def bench(description: dict[str, Any], frame: Sequence[int]) -> str:
    """A Verilog bench that plays the frame and prints the outputs in the clocks in which they
    come."""
    words, bits = description["stream"] == "words", description["bits"]
    ports = [f"in_data_{k}" for k in range(len(frame))] if words else ["in_data"]
    outs = [f"out_data_{k}" for k in range(len(description["outputs"]))] if words else ["out_data"]
    elements = (
        [list(frame)]
        if words
        else [[x] for x in [*frame, *[0] * (description["elements"] - len(frame))]]
    )
    lines = [
        "module bench;",
        "reg clk = 0, rst = 1, in_valid = 0;",
        "wire out_valid;",
        "integer clock = 0;",
    ]
    lines += [f"reg signed [{bits - 1}:0] {p} = 0;" for p in ports] + [
        f"wire signed [{bits - 1}:0] {p};" for p in outs
    ]
    named = ["clk", "rst", "in_valid", "out_valid", *ports, *outs]
    if not words:
        lines += ["reg in_last = 0;", "wire out_last;"]
        named += ["in_last", "out_last"]
    lines += [
        f"{description['entity']} dut (" + ", ".join(f".{n}({n})" for n in named) + ");",
        "always #1 clk = !clk;",
    ]
    shown = " ".join(["%0d"] * len(outs))
    lines += [
        "always @(negedge clk) begin clock = clock + 1;",
        f'if (out_valid) $display("%0d {shown}", clock, {", ".join(outs)}); end',
    ]
    lines += ["initial begin", "repeat (4) @(negedge clk); rst = 0; #0 clock = 0;"]
    for k, one in enumerate(elements):
        lines += [f"{p} = {x};" for p, x in zip(ports, one, strict=True)] + ["in_valid = 1;"]
        lines += [f"in_last = {int(k == len(elements) - 1)};"] * (not words) + [
            "@(negedge clk); #0 clock = 0;"
        ]
    lines += [
        "in_valid = 0;",
        f"repeat ({max(description['output_clocks']) + 3}) @(negedge clk); $finish;",
        "end",
        "endmodule",
    ]
    return "\n".join(lines) + "\n"
