"""The inputs that a block gets while the recorded frames of its scene run through the design."""

from collections.abc import Callable
from typing import Any

import numpy as np

from golden.common.block import Block
from golden.instruments.block_inputs import seen
from golden.numbers.fixed import Codes
from tb.common.bench import Bench, test_named
from tb.common.stream import check_stream, ports_of

# At most so many inputs, evenly spaced. A quarter of an hour of frames would take hours.
MOST_SEEN = 4000
MOST_FRAMES = 20_000


def recorded_frames(bench: Bench, most: int = MOST_FRAMES) -> Codes:
    """The recorded frames that yield outputs, at most so many, and the past of the first."""
    given, past = bench.given, bench.given.design.past
    frames = np.concatenate(given.recordings) if past else given.codes
    return frames[: past + most]


def recorded_inputs(
    bench: Bench, part: Block | None = None, most: int = MOST_SEEN
) -> tuple[Codes, ...]:
    """The inputs of the block under test, or of ``part``, as the twin takes them."""
    found = seen(bench.given.design, part or bench.twin, recorded_frames(bench))
    count = len(found[0])
    kept = np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))
    return tuple(column[kept] for column in found)


async def check_recorded(
    bench: Bench, twin: Callable[..., Any] | None = None, items: dict[str, Codes] | None = None
) -> None:
    """Play the recorded inputs as close as the twin takes them; compare each result and its clock.

    twin: See ``check_stream``.
    items: The values of the input ports, if they are not those that ``process`` takes.
    """
    if items is None:
        items = dict(zip(ports_of(bench.twin, "in"), recorded_inputs(bench), strict=True))
    await check_stream(bench, items, twin)
    count = len(next(iter(items.values())))
    bench.facts["recorded"] = count
    bench.finish(at_least=(1 + len(ports_of(bench.twin, "out"))) * count)


def recorded_test(module: str, of: Callable[..., Any] = lambda twin: twin.process) -> Any:
    """The test ``what_recorded_frames_bring`` of a bench, which does this; see ``suite``."""

    @test_named(module, "what_recorded_frames_bring")
    async def what_recorded_frames_bring(dut: Any) -> None:
        bench = Bench(dut)
        await check_recorded(bench, of(bench.twin))

    return what_recorded_frames_bring
