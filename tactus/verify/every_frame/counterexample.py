"""From "differs" to a frame: samples at which two values differ, and the bench that plays them."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from tactus.verify.every_frame.sequences import Sequences, before
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
            held.add(_signed(now.value(e.result), e.width).tobytes())
    given, sound = proof.given["words"], set[int]()
    for k in reversed(range(len(given))):
        code = now.value(proof.inner[len(words) + k])
        if k in sound or held & {code.tobytes(), _signed(code, BELOW_SIGN).tobytes()}:
            used = [i for i, _ in given[k].get("sum", [])] + [given[k].get("of", 0)]
            sound |= {k, *(i - len(words) for i in used)}
    apart = next((k for k in range(len(given)) if k not in sound), None)
    if apart is None:
        return "an output"
    return "network {}, layer {}, node {}".format(*given[apart]["place"])


def _signed(code: Any, bits: int) -> Any:
    """The lowest bits as a signed number."""
    half = 1 << bits - 1
    return (code + half) % (2 * half) - half


def bench(description: dict[str, Any], frames: int) -> str:
    """A Verilog bench that plays frames, whose samples are numbers in frames.txt, one after
    another, and prints the outputs of each."""
    words, bits, count = (
        description["stream"] == "words",
        description["bits"],
        description["samples"],
    )
    ports = [f"in_data_{k}" for k in range(count)] if words else ["in_data"]
    outs = [f"out_data_{k}" for k in range(len(description["outputs"]))] if words else ["out_data"]
    named = ["clk", "rst", "in_valid", "out_valid", *ports, *outs]
    named += [] if words else ["in_last", "out_last"]
    others = description["ports"]
    silent = dict.fromkeys(["in_valid", "in_last", *others], 0)
    begins = [
        " ".join(f"{port} = {value};" for port, value in {**silent, **one}.items())
        for one in [*before(description), {}]
    ]
    shown = f'$display("{"%0d " * len(outs)}", {", ".join(outs)})'
    drive = [f"{p} = samples[f * {count} + {k if words else 'k'}];" for k, p in enumerate(ports)]
    wait = max(max(description["output_clocks"]) + 3, description["interval"])
    return (
        "\n".join(
            [
                "module bench;",
                "reg clk = 0, rst = 1, in_valid = 0, in_last = 0, begun = 0;",
                "wire out_valid, out_last;",
                "integer f, k;",
                f"reg signed [{bits - 1}:0] samples [0:{frames * count - 1}];",
                *[f"reg signed [{bits - 1}:0] {p} = 0;" for p in ports],
                *[f"wire signed [{bits - 1}:0] {p};" for p in outs],
                *[f"reg [{max(width, 1) - 1}:0] {port} = 0;" for port, width in others.items()],
                f"{description['entity']} dut ("
                + ", ".join(f".{n}({n})" for n in [*named, *others])
                + ");",
                "always #1 clk = !clk;",
                f"always @(negedge clk) if (out_valid && begun) {shown};",
                'initial begin $readmemh("frames.txt", samples);',
                "repeat (4) @(negedge clk); rst = 0;",
                *[f"{clock} @(negedge clk);" for clock in begins],
                "begun = 1;",
                f"for (f = 0; f < {frames}; f = f + 1) begin",
                f"for (k = 0; k < {description['elements']}; k = k + 1) begin",
                f"in_valid = 1; in_last = k == {description['elements'] - 1};",
                *(drive if words else [f"if (k < {count})", *drive]),
                "@(negedge clk); end",
                f"in_valid = 0; repeat ({wait}) @(negedge clk);",
                "end $finish; end",
                "endmodule",
            ]
        )
        + "\n"
    )
