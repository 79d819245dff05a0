"""The engine with several multipliers whose program is a loop, so that frames overlap."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from test_engine import networks, random_codes

from golden.engine.frame_check import FrameCheck
from golden.engine.graph import Kind
from golden.engine.lane_pipeline import LanePipeline
from golden.engine.loop_listing import loop_listing
from golden.engine.loop_program import LoopProgram
from golden.engine.loop_schedule import least_length, shortest_loop, sizes_of
from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.networks.settings import Settings
from golden.trained.dense import Quantiser
from tactus.cli.listing import main
from tactus.scene import Scene, load_scene
from tactus.verify.benches.myhdl_simulation import simulate
from tactus.verify.benches.written import scene_of
from tb.common.case_library import LANES, OVERLAPPED
from tb.common.cases import FRONT_END, VISUALISATION, random_network

# Multipliers, the clocks from frame to frame without a loop, and those of the shortest one.
SHORTEST = {
    "comparison/digit-lanes2": (153, 126),
    "comparison/digit-lanes4": (130, 88),
    "comparison/digits-lanes8": (397, 328),
}


def loop_of(twin: Engine) -> LoopProgram:
    assert isinstance(twin.program, LoopProgram)
    return twin.program


def check(program: LoopProgram) -> None:
    """Check what the clocks of several frames do, one frame in every loop."""
    loop, length, mark = program.loop, program.loop.length, program.pipeline.mark
    steps = [
        time
        for begin, size in zip(loop.begins, sizes_of(program.shared), strict=True)
        for time in range(begin, begin + size)
    ]
    assert len({time % length for time in steps}) == len(steps) <= length
    stored = {n: end + mark for n, end in enumerate(loop.ends[: loop.stored])}
    # A sum that leaves, and is not stored, goes through the same registers.
    words = [time % length for time in (*loop.copies, *(end + mark for end in loop.ends))]
    assert len(set(words)) == len(words), "two of a sample, a result and an output at once"
    assert all(before < after for before, after in pairwise(loop.copies))
    assert loop.copies[-1] < length, "the next frame would take its place"
    leaves = [loop.ends[n] for n in loop.leaving]
    assert leaves == sorted(leaves)
    assert leaves[-1] - leaves[0] < length, "outputs of two frames would mix"

    # The writes to each place of the memory: the clock, the frame and the value.
    inputs = program.inputs
    times = {**dict(enumerate(loop.copies)), **{inputs + n: time for n, time in stored.items()}}
    frames = range(2 * program.turns + program.stages)
    memory: dict[tuple[int, int], list[tuple[int, int, int]]] = {}
    for frame in frames:
        for value, time in times.items():
            turn = (frame + time // length) % program.turns
            place = turn, program.address(time)
            memory.setdefault(place, []).append((frame * length + time + 2, frame, value))
    for t, (step, code) in enumerate(zip(program.scheduled(None), program.lane_steps, strict=True)):
        if step.neuron < 0 or code.gather or step.term.kind is Kind.ONE:
            continue
        for frame in frames:
            ago = program.words[t % length] >> program.field("turn")[0]
            turn = frame + t // length - (ago & (program.turns - 1))
            writes = memory[turn % program.turns, code.source]
            clock = frame * length + t
            latest = max(write for write in writes if write[0] < clock)
            assert latest[1:] == (frame, step.term.source)


@settings(max_examples=30)
@given(
    several=networks(),
    lanes=st.integers(1, 8),
    share=st.floats(0, 1),
    deep=st.booleans(),
)
def test_networks_of_any_shape(several: tuple, lanes: int, share: float, deep: bool) -> None:
    """The results are those of one multiplier, in every loop from the shortest one on."""
    arrangement, mlps = several
    codes = random_codes(mlps[0].shape[0], 50)
    options = {"lanes": lanes, "pipeline": "deep" if deep else "short"}
    plain = Engine.of(mlps, Settings(options=options), arrangement)
    shared = plain.program.shared
    shortest = shortest_loop(shared, LanePipeline(int(deep)), plain.interval)
    assume(shortest)
    assert shortest.length >= least_length(shared)
    wanted = shortest.length + round(share * (plain.interval - 1 - shortest.length))
    many = Engine.of(mlps, Settings(options={**options, "interval": wanted}), arrangement)
    assert shortest.length <= many.interval <= wanted
    one = Engine.of(mlps, Settings(), arrangement)
    assert np.array_equal(many.process(codes), one.process(codes))
    check(loop_of(many))


@pytest.mark.parametrize("interval", range(115, 140, 3))
def test_outputs_leave_where_no_sample_is_stored(interval: int) -> None:
    """The loop of a window stores many samples, and sends outputs later."""
    mlps = load_scene("swing-window").mlps()
    check(loop_of(Engine.of(mlps, Settings(options={"lanes": 4, "interval": interval}))))


@pytest.mark.parametrize("quantiser", [None, Quantiser(2.0**-3, 0, 0, 15)], ids=["plain", "codes"])
@pytest.mark.parametrize("lanes", [2, 5])
def test_networks_of_several_layers(lanes: int, quantiser: Quantiser | None) -> None:
    layers = ("relu", "relu", "relu") if quantiser else ("relu", "tanh", "hard_tanh")
    network = random_network((3, 7, 5, 4, 3), layers, 1.5, 5, quantiser)
    plain = Engine.of([network], Settings(options={"lanes": lanes}))
    loop = shortest_loop(plain.program.shared, LanePipeline(), plain.interval)
    assert loop is not None
    options = {"lanes": lanes, "interval": loop.length}
    many = Engine.of([network], Settings(options=options))
    codes = random_codes(many.inputs, 100)
    assert np.array_equal(many.process(codes), Engine.of([network]).process(codes))
    found, expected = many.saturations(codes), plain.saturations(codes)
    assert found.keys() == expected.keys()
    assert all(np.array_equal(found[layer], expected[layer]) for layer in found)
    check(loop_of(many))


@pytest.mark.parametrize("name", SHORTEST)
def test_the_shortest_loop_of_a_scene(name: str) -> None:
    scene = load_scene(name)
    plain = scene.twin()
    assert isinstance(plain, Engine)
    least = shortest_loop(plain.program.shared, LanePipeline(), plain.interval)
    assert least is not None
    assert (plain.interval, least.length) == SHORTEST[name]
    many = with_demand(scene, least.length).twin()
    assert isinstance(many, Engine)
    assert many.interval == least.length
    codes = np.concatenate([scene.vectors().codes[:200], random_codes(many.inputs, 200)])
    assert np.array_equal(many.process(codes), plain.process(codes))
    check(loop_of(many))


def with_demand(scene: Scene, interval: int) -> Scene:
    return replace(scene, demand=replace(scene.demand, interval=interval))


def test_enough_clocks_need_no_loop() -> None:
    scene = load_scene("comparison/digit-lanes4")
    plain = scene.twin()
    assert with_demand(scene, 130).twin() == plain
    assert with_demand(scene, 129).twin().interval <= 129


def test_too_few_clocks_are_refused() -> None:
    scene = load_scene("comparison/digit-lanes4")
    with pytest.raises(
        InputError, match="interval: got 87, expected 88 clocks or more: with lanes = 4"
    ):
        with_demand(scene, 87).twin()


@pytest.mark.parametrize(
    ("sections", "named"), [(FRONT_END, "front_end"), (VISUALISATION, "visualisation")]
)
def test_what_cannot_stand_around_frames_that_overlap(tmp_path, sections: str, named: str) -> None:
    sections += "counter_width = 10\n" if named == "front_end" else ""
    loop = OVERLAPPED["rails-loop"]
    hardware = "lanes = 3\ninterval = 43"
    case = replace(loop, shapes=[(3, 5, 4)], hardware=hardware, sections=sections)
    with pytest.raises(InputError, match=rf"interval: got 43, for which .* section \[{named}\]"):
        scene_of(case, tmp_path, "around").twin()


def test_a_rate_makes_a_loop_too(tmp_path) -> None:
    case = replace(
        LANES["rails-lanes"], hardware="lanes = 3\nclock_mhz = 100\nframes_a_second = 2.5e6"
    )
    twin = scene_of(case, tmp_path, "rate").twin()
    assert twin.interval == 40
    assert twin.loops


def test_a_frame_waits_for_the_next_loop() -> None:
    twin = Engine.of(
        OVERLAPPED["rails-loop"].networks(), Settings(options={"lanes": 3, "interval": 38})
    )
    length, stages = twin.interval, loop_of(twin).stages
    # The second one comes in time; the third waits, and so does the next one; then nothing runs.
    ended = np.array([10, 10 + length, 11 + 2 * length, 20 + 3 * length, 1000])
    begun = [10, 10 + length, 10 + 3 * length, 10 + 4 * length, 1000]
    assert twin.begun(ended).tolist() == begun
    rest = 10 + stages * length
    assert twin.begun(np.array([10, rest - 1, rest + length])).tolist() == [
        10,
        rest,
        rest + length,
    ]
    assert twin.begun(np.array([10, rest + 3])).tolist() == [10, rest + 3]


@pytest.mark.parametrize("name", ["rails-loop", "least-loop", "deep-loop"])
def test_the_hardware_in_myhdl(tmp_path, name: str) -> None:
    twin = scene_of(OVERLAPPED[name], tmp_path, name).twin()
    codes = random_codes(twin.inputs, 8)
    results, _ = simulate(twin, codes)
    assert np.array_equal(results, twin.process(codes))


def test_the_listing_has_a_line_for_every_word(tmp_path, capsys, monkeypatch) -> None:
    scene = scene_of(OVERLAPPED["rails-loop"], tmp_path, "rails-loop")
    twin = scene.twin()
    monkeypatch.setattr("sys.argv", ["listing", str(scene.path)])
    main()
    table, columns, *lines = capsys.readouterr().out.splitlines()
    assert table.startswith("tanh in 256 segments")
    assert columns.split()[:3] == ["word", "began", "neurons"]
    assert [line.split()[0] for line in lines[: twin.interval]] == [
        str(n) for n in range(twin.interval)
    ]
    for clock in twin.output_clocks:
        assert sum(f"leaves in clock {clock}" in line for line in lines) == 1
    assert lines == loop_listing(twin.graph, loop_of(twin))[2:]


def test_a_frame_check_without_results_has_no_port_for_them() -> None:
    check_of = FrameCheck(3, 2, 5, LanePipeline(), results=False)
    assert "store" not in {port.name for port in check_of.ports}
    assert "store" in {port.name for port in replace(check_of, results=True).ports}
