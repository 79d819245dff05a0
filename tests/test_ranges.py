"""Tests of the range of words behind ReLU and linear layers: from bounds, or from the data."""

import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refused import call

from golden.engine.formats import WIDTH
from golden.engine.integer_network import sample_words
from golden.engine.ranges import ENOUGH, MARGIN, frac_of, hidden_peaks
from golden.networks.design import Settings
from golden.networks.engine import Engine
from golden.networks.oracle import engine_bounds, exact
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.trained.dense import Dense, DenseNetwork
from tactus.core.finding import OK, WARNING
from tactus.report.page.summary import built
from tactus.rig.check import everything
from tactus.scene import Scene, load_scene
from tactus.scene.codes import hidden_saturations, range_lines, saturating
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_network

KINDS = ("relu", "leaky_relu", "linear")


def quiet(inputs: int, count: int, seed: int = 1) -> Codes:
    """Frames in which samples of equal sign are rare, so sums stay far below their bounds."""
    return np.random.default_rng(seed).integers(-1500, 1501, (count, inputs))


def wide(kinds: tuple[str, ...] = ("relu", "relu"), seed: int = 1) -> DenseNetwork:
    """A network whose bounds are far above what quiet frames reach, with outputs below 1 there."""
    made = random_network((24, *(4 for _ in kinds), 2), kinds, 4.0, seed)
    *layers, last = made.layers
    most = 1.5 * np.abs(made.process(SIGNAL.to_real(quiet(24, 500, seed + 10)))).max()
    return DenseNetwork((*layers, Dense(last.weights / most, last.biases / most)))


def of_frames(network: DenseNetwork, codes: Codes, lean: bool = True, **options: object) -> Engine:
    met = hidden_peaks(network, SIGNAL.to_real(codes))
    return Engine.of([network], Settings(met=(met,), options=options, lean=lean))


@settings(max_examples=60)
@given(met=st.floats(1e-4, 60_000))
def test_a_range_from_the_data_holds_the_margin_and_no_bit_more(met: float) -> None:
    frac = frac_of(met, WIDTH)
    assert MARGIN * met * 2**frac < 2 ** (WIDTH - 1)
    assert frac == WIDTH - 1 or met * 2**frac >= 2**ENOUGH


@pytest.mark.parametrize("kind", KINDS)
def test_the_largest_magnitudes_are_those_of_the_words(kind: str) -> None:
    network, codes = wide((kind, kind)), quiet(24, 50)
    engine = of_frames(network, codes, lean=False)
    (whole,) = engine.integers
    layers = zip(hidden_peaks(network, SIGNAL.to_real(codes)), engine.graph.ranges, strict=True)
    for depth, (found, one) in enumerate(layers):
        words = [
            abs(word) for words in sample_words(codes) for word in list(whole.run(words))[depth][1]
        ]
        assert one.fmt.to_real(max(words)) == pytest.approx(found, abs=0.02)
        assert one.met == found


@pytest.mark.parametrize("kind", KINDS)
def test_the_data_give_bits_where_bounds_waste_them(kind: str) -> None:
    """On the recorded frames and up to the margin nothing saturates, and the error is smaller."""
    network, codes = wide((kind, kind)), quiet(24, 200)
    bounded, ranged = Engine.of([network]), of_frames(network, codes)
    first, other = bounded.graph.ranges[0], ranged.graph.ranges[0]
    assert other.met * 2**first.fmt.frac < 2**ENOUGH
    assert other.from_data
    gained = 0
    for one, other in zip(bounded.graph.ranges, ranged.graph.ranges, strict=True):
        assert not one.from_data
        assert (one.met, other.bound >= other.met) == (0.0, True)
        assert 0.99 * 2 ** (WIDTH - 2) < one.bound * 2**one.fmt.frac < 2 ** (WIDTH - 1)
        assert other.met * 2**other.fmt.frac >= 2**ENOUGH or other.fmt.frac == WIDTH - 1
        gained += other.fmt.frac - one.fmt.frac
    assert gained >= 2
    assert not any(counts.any() for counts in ranged.saturations(codes).values())
    assert not any(counts.any() for counts in ranged.saturations(MARGIN * codes * 2 // 3).values())
    real = np.clip(network.process(SIGNAL.to_real(codes)), -1, SIGNAL.to_real(SIGNAL.high))
    errors = [np.abs(SIGNAL.to_real(e.process(codes)) - real).mean() for e in (bounded, ranged)]
    outputs = np.abs(SIGNAL.to_real(SIGNAL.quantise(real)[0]) - real).mean()
    assert errors[1] - outputs < 0.5 * (errors[0] - outputs)


@pytest.mark.parametrize("kind", KINDS)
def test_saturations_are_counted_and_part_of_the_twin(kind: str) -> None:
    network = wide((kind, "tanh", kind), seed=3)
    engine = of_frames(network, quiet(24, 50))
    rng = np.random.default_rng(2)
    codes = np.concatenate(
        [quiet(24, 20, seed=5), rng.choice([SIGNAL.low, 0, SIGNAL.high], (60, 24))]
    )
    assert np.array_equal(engine.process(codes), exact(engine, codes))
    found = engine.saturations(codes)
    ranges = [one for one in engine.graph.ranges if one.from_data]
    assert [one.layer for one in ranges] == list(found)
    assert "layer 1" in found
    (whole,) = engine.integers
    for one in ranges:
        depth = int(one.layer.removeprefix("layer ")) - 1
        layer, expected = whole.layers[depth], []
        built = [engine.graph.neurons[place].name.split("node ")[1] for place in one.places]
        nodes = [int(name.split()[0]) - 1 for name in built]
        for frame in sample_words(codes):
            beyond = [
                layer.rounded(total) > one.fmt.high
                or (layer.rounded(total) < one.fmt.low and not layer.rectifies)
                for total in np.array(list(whole.run(frame))[depth][0])[nodes].tolist()
            ]
            expected.append(sum(beyond))
        assert found[one.layer].tolist() == expected
    assert found["layer 1"].any()


@settings(max_examples=30)
@given(seed=st.integers(0, 999), kinds=st.lists(st.sampled_from(KINDS), min_size=1, max_size=3))
def test_the_bounds_of_the_error_hold_where_nothing_saturates(seed: int, kinds: list[str]) -> None:
    network = wide(tuple(kinds), seed)
    engine = of_frames(network, quiet(24, 30, seed))
    codes = np.concatenate([quiet(24, 30, seed + 1), 4 * quiet(24, 30, seed + 2)])
    counts = [np.zeros(len(codes), dtype=np.int64), *engine.saturations(codes).values()]
    sound = np.sum(counts, axis=0) == 0
    real = np.clip(network.process(SIGNAL.to_real(codes)), -1, SIGNAL.to_real(SIGNAL.high))
    off = np.abs(SIGNAL.to_real(engine.process(codes)) - real)
    met = hidden_peaks(network, SIGNAL.to_real(quiet(24, 30, seed)))
    assert sound.any()
    assert (off[sound] <= engine_bounds(network, 9, 24, met)).all()


# In scenes.


def scene_of(folder: Path, network: DenseNetwork, recorded: Codes) -> Scene:
    """A scene whose recording has these codes, and outputs of the network as targets."""
    path = write_scene(folder, "rig", "exact", [network], activation="precise", design="engine")
    samples = SIGNAL.to_real(recorded)
    targets = np.clip(np.abs(network.process(samples)), 0.01, 0.9)
    names = [*(f"x{k}" for k in range(samples.shape[1])), "y0", "y1"]
    rows = np.concatenate([samples, targets], axis=1)
    text = [",".join(names), *(",".join(f"{v!r}" for v in row) for row in rows.tolist())]
    (folder / "rig.csv").write_text("\n".join(text) + "\n")
    return load_scene(str(path))


def test_a_scene_takes_its_ranges_from_all_recorded_frames(tmp_path: Path) -> None:
    network, codes = wide(), quiet(24, 40)
    scene = scene_of(tmp_path, network, codes)
    engine = scene.twin()
    assert engine == of_frames(network, codes)
    assert scene.build(network) == engine
    assert scene.twin(lean=False).core.process(codes).tolist() == engine.process(codes).tolist()
    lines = range_lines(scene, hidden_saturations(scene, scene.vectors().codes))
    assert [line.split(":")[0] for line in lines] == ["layer 1", "layer 2"]
    met = engine.graph.ranges[0].met
    assert f"from the data: {met:.4g} is met, margin 2; bounds would be" in lines[0]
    assert lines[0].endswith("; no sum saturates in 40 recorded frames")
    found = everything(scene, tmp_path / "build")
    assert set(lines) <= {finding.text for finding in found if finding.verdict == OK}
    assert not [f for f in found if f.verdict == WARNING and "saturate" in f.text]
    sentences = built(scene, engine)
    assert any("from the data" in sentence and sentence[0] == "L" for sentence in sentences)


def test_hidden_sums_that_saturate_in_recorded_frames_are_warned_of(
    tmp_path: Path, monkeypatch
) -> None:
    """With the margin none can, so it is taken away."""
    first, *others = wide().layers
    larger = DenseNetwork((Dense(8 * first.weights, first.biases, "relu"), *others))
    scene = scene_of(tmp_path, larger, quiet(24, 40))
    assert not [text for text in saturating(scene) if "layer" in text]
    monkeypatch.setattr("golden.engine.ranges.MARGIN", 0.1)
    again = load_scene(str(scene.path))
    (first, *_) = [text for text in saturating(again) if "layer" in text]
    counts = again.twin().core.saturations(again.vectors().codes)["layer 1"]
    assert first == (
        f"layer 1: {counts.sum()} sums saturate, in {(counts > 0).sum()} of 40 recorded frames"
    )


def test_predict_counts_what_new_readings_saturate(tmp_path: Path, capsys) -> None:
    scene = scene_of(tmp_path, wide(), quiet(24, 60))
    new = quiet(24, 6, seed=9)
    weights = scene.networks()[0].layers[0].weights
    new[2] = np.where(weights[0] > 0, SIGNAL.high, SIGNAL.low)
    header = [f"x{k}" for k in range(24)]
    text = [",".join(header)]
    text += [",".join(map(str, row)) for row in SIGNAL.to_real(new).tolist()]
    (tmp_path / "new.csv").write_text("\n".join(text) + "\n")
    call("predict", scene.path, tmp_path / "new.csv", tmp_path / "out.csv")
    out = capsys.readouterr().out
    count = scene.twin().core.saturations(new)["layer 1"]
    assert count[2]
    assert f"; {count.sum()} sums saturate, in {(count > 0).sum()} of 6 rows" in out
    with (tmp_path / "out.csv").open() as file:
        reasons = [row["reason"] for row in csv.DictReader(file)]
    assert ["layer 1 saturates" in reason for reason in reasons] == (count > 0).tolist()
