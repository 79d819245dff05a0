"""The check that the benches of all blocks with ``in_valid`` and ``out_valid`` use."""

from collections.abc import Callable

import numpy as np

from golden.common.block import Block
from golden.common.border import State
from tb.common.bench import Bench, test_named
from tb.common.stimulus import random_resets, spread

Items = dict[str, np.ndarray]


def ports_of(twin: Block, direction: str) -> list[str]:
    """The ports of a direction that hold data, in the order of what ``process`` takes or gives."""
    control = ("clk", "rst", f"{direction}_valid")
    ports = [port.name for port in twin.ports if port.direction == direction]
    return [name for name in ports if name not in control]


async def check_stream(
    bench: Bench,
    items: Items,
    twin: Callable | None = None,
    gap: float = 0.0,
    resets: bool | np.ndarray = False,
    pause: np.ndarray | None = None,
):
    """Play ``items``, feed the recorded inputs to ``twin``, and compare all outputs.

    items: The values of the input ports, without ``in_valid``.
    twin: A function from the recorded inputs, in their order, to the outputs, in the order of the
        ports; by default ``process`` of the twin.
    gap: The probability of an idle clock before each item.
    resets: Whether there are random resets, or the clocks of the resets. An item must vanish if a
        reset comes while it is in the block.
    pause: Idle clocks before each item. The default is as many as the interval of the twin demands.
        An item that is followed earlier must vanish.
    """
    twin, interval = twin or bench.twin.process, bench.twin.interval
    outputs = ports_of(bench.twin, "out")
    tail = bench.latency + 4
    idle = interval - 1 if pause is None else pause
    drive = spread(bench.rng, items, "in_valid", gap, tail, pause=idle)
    if isinstance(resets, np.ndarray):
        drive["rst"] = np.zeros(len(drive["in_valid"]), dtype=np.int64)
        drive["rst"][resets] = 1
    elif resets:
        every = 40 * interval
        drive["rst"] = random_resets(bench.rng, len(drive["in_valid"]), every)
    recording = await bench.play(drive, ["out_valid", *outputs])
    entered = recording.rows("in_valid")
    gaps = np.diff(entered, append=recording.clocks + interval)
    followed = gaps < interval
    if followed.any():
        bench.visit(State("clocks to an item that comes early", range(1, interval)), gaps)
    if len(at := recording.resets()):
        next_reset = np.append(at, -1)[np.searchsorted(at, entered)]
        bench.visit(State("clocks to a reset", range(bench.latency)), next_reset - entered)
    kept = entered[recording.undisturbed(entered, entered + bench.latency - 1) & ~followed]
    seen = {port: bench.read(recording, port, kept) for port in items}
    for quantity, values in bench.twin.quantities(*seen.values()).items():
        bench.meet(quantity, values)
    expected = twin(*seen.values())
    if len(outputs) == 1:
        expected = (expected,)
    left = recording.rows("out_valid")
    bench.compare("clocks of the results", left, kept + bench.latency)
    for port, values in zip(outputs, expected, strict=True):
        bench.compare(port, bench.read(recording, port, left), np.asarray(values, np.int64), **seen)


def some_of(bench: Bench, items: Items, count: int) -> Items:
    """So many of the items, in random order."""
    order = bench.rng.integers(0, len(next(iter(items.values()))), count)
    return {name: values[order] for name, values in items.items()}


def suite(
    module: str,
    items: Callable,
    of: Callable = lambda twin: twin.process,
    at_once: int = 0,
    swept: str = "sweep",
):
    """The tests of a block that answers each item: one of all items, one of gaps and resets.

    module: The name of the bench.
    items: A function from a bench to the values of the input ports that are played.
    of: A function from the twin to that of ``check_stream``.
    at_once: So many items are played at a time, so that a recording stays small.
    swept: The name of the first test.
    """

    @test_named(module, swept)
    async def sweep(dut):
        """Play all items as close as the twin takes them."""
        bench = Bench(dut)
        every = items(bench)
        count = len(next(iter(every.values())))
        for start in range(0, count, at_once or count):
            part = {n: values[start : start + (at_once or count)] for n, values in every.items()}
            await check_stream(bench, part, of(bench.twin))
        bench.finish(at_least=count)

    @test_named(module, "gaps_and_resets")
    async def gaps_and_resets(dut):
        """Play 2000 of the items in random order, with idle clocks and resets between them.

        Then play items with a reset at each clock of their way through the block.
        """
        bench = Bench(dut)
        chosen = some_of(bench, items(bench), 2000)
        await check_stream(bench, chosen, of(bench.twin), gap=0.3, resets=True)
        # An item is followed by a reset so many clocks later, and by another item in the next
        # clock.
        every = np.arange(bench.latency + 1)
        pairs = {name: values[: 2 * len(every)] for name, values in chosen.items()}
        room = bench.latency + bench.twin.interval
        pause = np.stack([np.full(len(every), room), every], axis=1).ravel()
        at = np.cumsum(pause + 1)[0::2] - 1 + every
        await check_stream(bench, pairs, of(bench.twin), resets=at, pause=pause)
        bench.finish(at_least=1000)

    return sweep, gaps_and_resets


def early_test(module: str, items: Callable):
    """The test ``early`` of a block with an interval; see ``suite``."""

    @test_named(module, "early")
    async def early(dut):
        """Play 1000 of the items in random order, one in three closer to the last than allowed."""
        bench = Bench(dut)
        chosen, interval = some_of(bench, items(bench), 1000), bench.twin.interval
        close = bench.rng.integers(0, interval - 1, 1000)
        pause = np.where(bench.rng.random(1000) < 1 / 3, close, interval - 1)
        await check_stream(bench, chosen, pause=pause)
        bench.finish(at_least=500)

    return early
