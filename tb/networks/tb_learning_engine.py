"""learning_engine, an engine that learns gains and offsets of its sensors, against its twin.

Frames, known outputs and theta of right and wrong lengths come at any time, and every port is
compared in every clock with the twin's timeline, which knows of the program only how long its parts
are, and computes the rule. Outputs show which steps were taken before the frame. How much of a
drift the rule takes away is in docs/learning.md.
"""

import cocotb

from golden.learning.program import KEEP, PIPELINE
from golden.numbers.precision import SIGNAL
from tb.common.bench import Bench
from tb.common.case_library import cases
from tb.common.lessons import Player, near, refusals, traffic
from tb.common.network import random_elements, recorded_frames

CASES = cases("lessons")


@cocotb.test()
async def recorded(dut):
    """Play the recorded frames as close as the design takes them, which leaves none to learn."""
    bench = Bench(dut)
    player, codes = Player(bench), recorded_frames(bench)
    for frame in codes:
        player.play(player.frame(frame, before=player.twin.interval - len(frame)), [])
    player.play([], [], clocks=player.twin.interval)
    await player.check("frames", at_least=len(codes) * player.twin.outputs, frames=len(codes))


@cocotb.test()
async def lessons(dut):
    """Keep placements, learn from them between frames, and watch the outputs change."""
    bench = Bench(dut)
    player, twin, rng = Player(bench), bench.twin, bench.rng
    longest = twin.longest_equation
    for frame in bench.given.codes[: min(3, twin.placements)]:
        player.play(player.frame(frame), [], learn=0, clocks=twin.interval)
        player.play([], player.frame(near(twin, rng, frame, 2000), gap=1), learn=0, clocks=60)
    for n in range(40):
        frame = bench.given.codes[n] if n < 3 else random_elements(player.bench, twin.inputs)
        # Frames as close as they may be, with room for a few equations, and slow ones, whose
        # samples stop equations.
        room = (0, int(rng.integers(1, 2 * longest)), 4 * longest)[n % 3]
        gap = int(rng.integers(0, longest)) if n % 5 == 4 else 0
        player.play(player.frame(frame, before=room, gap=gap), [], clocks=twin.interval + room)
    await player.check(
        "corrected frames", "equations stopped", "steps taken", at_least=30 * twin.outputs
    )


@cocotb.test()
async def steps_refused(dut):
    """Show what no gain and no offset gives."""
    player = Player(Bench(dut))
    refusals(player)
    await player.check("steps refused", "steps taken", "corrected frames", at_least=12)


@cocotb.test()
async def theta_put_in(dut):
    """Put theta in, also at its ends and with gaps, read it behind frames, and learn on from it."""
    bench = Bench(dut)
    player, twin, rng = Player(bench), bench.twin, bench.rng
    unknowns = twin.program.places.unknowns
    frame = random_elements(bench, twin.inputs)
    player.play(player.frame(frame), [], clocks=twin.interval)
    player.play([], player.frame(near(twin, rng, frame, 500)), clocks=4 * twin.longest_equation)
    for n in range(12):
        codes = random_elements(bench, unknowns) if n % 4 else rng.choice([-8192, 8191], unknowns)
        player.play(player.frame(random_elements(bench, twin.inputs)), [], clocks=twin.interval)
        gap = int(rng.integers(0, 3 * twin.longest_equation)) * (n % 3 == 2)
        words = player.frame(codes, before=int(rng.integers(0, unknowns + 4)), gap=gap)
        player.play([], words, learn=n % 2, theta=True)
        player.play([], [], learn=n % 2, clocks=60)
        # What is in use is read behind the next frames, some of which cut it.
        for _ in range(3):
            before = int(rng.integers(0, unknowns + 4))
            player.play(player.frame(random_elements(bench, twin.inputs), before), [], learn=0)
            player.play([], [], learn=0, clocks=twin.interval - twin.inputs)
        player.play([], [], clocks=3 * twin.longest_equation)
    # Between two words the counter of the program passes everything that writes theta.
    words = player.frame(random_elements(bench, unknowns), gap=1 << twin.program_addr_width)
    player.play(player.frame(random_elements(bench, twin.inputs)), [], clocks=twin.interval)
    player.play([], words, theta=True)
    player.play([], [], clocks=60)
    player.play(player.frame(random_elements(bench, twin.inputs)), [], clocks=2 * twin.interval)
    timeline = await player.check("steps taken", "corrected frames", at_least=12)
    assert timeline.met["theta put in"] == 13


@cocotb.test()
async def samples_at_their_ends(dut):
    """Offer known outputs and theta behind frames with each sample at an end, or next to it."""
    bench = Bench(dut)
    player, twin, rng = Player(bench), bench.twin, bench.rng
    unknowns = twin.program.places.unknowns
    for k in range(twin.inputs):
        for code in (SIGNAL.low, SIGNAL.low + 1, SIGNAL.high - 1, SIGNAL.high):
            for length, theta in ((twin.outputs, False), (unknowns, True)):
                frame = random_elements(bench, twin.inputs)
                frame[k] = code
                player.play(player.frame(frame), [], learn=0, clocks=twin.interval)
                words = player.frame(rng.integers(-4000, 4001, length))
                player.play([], words, learn=0, theta=theta)
                player.play([], [], learn=0, clocks=60)
    player.play(player.frame(random_elements(bench, twin.inputs)), [], clocks=twin.interval)
    timeline = await player.check("placements", "theta put in", at_least=4)
    assert timeline.met["clipped frames"] == 4 * twin.inputs
    assert timeline.met["targets refused"] == 4 * twin.inputs


@cocotb.test()
async def more_placements_than_are_kept(dut):
    """Keep more placements than there is room for, and learn from those that are left."""
    bench = Bench(dut)
    player, twin, rng = Player(bench), bench.twin, bench.rng
    for n in range(twin.placements + 4):
        frame = random_elements(player.bench, twin.inputs)
        player.play(player.frame(frame), [], learn=0, clocks=twin.interval)
        player.play([], player.frame(near(twin, rng, frame, 500)), learn=0, clocks=50)
        if n == twin.placements - 2:
            # One place is left: the first placement comes again behind the last one.
            player.play([], [], clocks=twin.placements * sum(twin.equation_clocks))
    player.play([], [], clocks=(twin.placements + 2) * sum(twin.equation_clocks))
    # With every place taken, placements come while equations run.
    for _ in range(3):
        frame = random_elements(player.bench, twin.inputs)
        player.play(player.frame(frame), [], clocks=twin.interval)
        player.play([], player.frame(near(twin, rng, frame, 500), before=200), clocks=700)
    player.play(player.frame(random_elements(player.bench, twin.inputs)), [], clocks=twin.interval)
    timeline = await player.check("corrected frames", at_least=twin.placements)
    # One more than there are places: the newest one takes the place of the oldest.
    assert timeline.met["placements"] > 1 << twin.program.places.number_width


@cocotb.test()
async def any_traffic(dut):
    """Play frames and known outputs of all lengths at any time, while it learns."""
    player = Player(Bench(dut))
    twin, rng = player.twin, player.rng
    traffic(player, 50)
    # A frame that comes at each clock around those in which a placement is kept.
    for clocks in range(twin.program.lengths[KEEP] + 2 * PIPELINE.result):
        first, second = (
            random_elements(player.bench, twin.inputs),
            random_elements(player.bench, twin.inputs),
        )
        player.play(player.frame(first), [], clocks=twin.interval)
        player.play(
            player.frame(second, before=clocks),
            player.frame(random_elements(player.bench, twin.outputs)),
        )
        player.play([], [], clocks=int(rng.integers(twin.interval, 2 * twin.interval)))
    await player.check(
        *("frames refused", "targets refused", "placements", "equations stopped", "steps taken"),
        *("placements lost", "corrected frames"),
        at_least=20,
    )


@cocotb.test()
async def resets(dut):
    """Play the same with resets at any time. Each brings back what was shipped."""
    player = Player(Bench(dut))
    traffic(player, 80, resets=True)
    await player.check("placements", "steps taken", at_least=20)
