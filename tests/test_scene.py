"""Tests that each fault of a scene, a CSV file or a network gets one clear message."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from golden.input_error import InputError, MissingFileError
from golden.network_files.network_file import load_network, provenance_path, save_network
from golden.precision import SIGNAL
from golden.scene import Scene, load_scene, scene_names
from golden.table import read_table


def edited(scene: Scene, old: str, new: str) -> str:
    """Replace a text in the file of the scene, and return its path."""
    text = scene.path.read_text()
    assert old in text
    scene.path.write_text(text.replace(old, new))
    return str(scene.path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "hidden = 5",
            'hidden = "5"',
            "hidden: got '5', expected a whole number, or a list",
        ),
        ("hidden = 5", "hidden = -1", "network.hidden: got -1, expected 0 to 1024"),
        ('weights = "small.npz"', "", "network.weights: missing, expected text"),
        (
            "hidden = 5",
            "hidden = [5, 0]",
            r"hidden: got \[5, 0\], expected 1 or more nodes in each",
        ),
        (
            "hidden = 5",
            'hidden = 5\nactivations = ["relu", "tanh"]',
            "network.activations: got 2 for 1 hidden layers, expected one for each",
        ),
        (
            "hidden = 5",
            'hidden = 5\nactivations = ["rellu"]',
            r"network.activations: got \['rellu'\], expected a list with an activation",
        ),
        (
            '"single"\nhidden = 5\nweights = "small.npz"',
            '"cascade"\nhidden = 5\nactivations = ["relu"]\nweights = ["a.npz", "b.npz"]',
            r"network.activations: got \['relu'\] with arrangement 'cascade', expected none",
        ),
        (
            '"single"',
            '"cascade"',
            "weights: got 'small.npz', expected a list of 2: cascade has one for each",
        ),
        ('"single"', '"cascad"', "arrangement: got 'cascad', .*did you mean 'cascade'"),
        ('"small.npz"', '["a.npz", 1]', "weights: got .* expected text, or a list"),
        (
            "steps = 20",
            'earlier_outputs = "bits"',
            "earlier_outputs: got 'bits', expected",
        ),
        ("steps = 20", "hidden = [4]", r"training.hidden: got \[4\], expected the least and"),
        ("steps = 20", "hidden = [5, 4]", r"training.hidden: got \[5, 4\]"),
        ("steps = 20", 'optimiser = "sgc"', "training.optimiser: got 'sgc', .*did you mean 'scg'"),
        ("hidden = 5", "hidden = true", "network.hidden: got true, expected a whole number"),
        ("hidden = 5", "hiden = 5", "network: key 'hiden' is not known, .*did you mean 'hidden'"),
        ("[hardware]", "[hardwear]", "section 'hardwear' is not known, .*did you mean 'hardware'"),
        ('"exact"', '"exatc"', "hardware.precision: got 'exatc', .*did you mean 'exact'"),
        ('"gradient"', '"precis"', "hardware.activation: got 'precis', .*did you mean 'precise'"),
        (
            "[network]",
            'where = { x0 = "a" }\n[network]',
            "data.where.x0: got 'a', expected a number",
        ),
        ("[network]", "where = 3\n[network]", "data.where: got 3, expected a table"),
        ('"hybrid"', '"paralel"', "hardware.design: got 'paralel', .*did you mean 'parallel'"),
        (
            '"single"\nhidden = 5\nweights = "small.npz"\n\n[hardware]\ndesign = "hybrid"',
            '"cascade"\nhidden = 5\nweights = ["a.npz", "b.npz"]\n\n'
            '[hardware]\ndesign = "parallel"',
            "network.arrangement: got 'cascade' with design 'parallel', expected single",
        ),
        ('"gradient"', '""', "hardware.activation: got '', expected one of gradient, "),
        ('["x0", "x1", "x2"]', '["x0", "x0", "x2"]', "data.sensors: got .* each once"),
        ('["x0", "x1", "x2"]', "[]", "data.sensors: got .* expected column names"),
        ("[network]", "[network", "not TOML"),
        ("[network]", "full_scale = { y9 = 1 }\n[network]", "data.full_scale: 'y9' is no output"),
        ("[network]", "full_scale = { y1 = 0 }\n[network]", "data.full_scale.y1: got 0"),
        ("[network]", "length_mm = { y1 = 9 }\n[network]", "length_mm: 'y1' is no output with a"),
        ("steps = 20", "steps = 0", "training.steps: got 0, expected above 0"),
        ("steps = 20", "weight_decay = -1", "training.weight_decay: got -1.0"),
        ("steps = 20", "weight_decay = nan", "training.weight_decay: got nan"),
        ("steps = 20", 'split = "block"', "training.split: got 'block', .*did you mean 'blocks'"),
        (
            "steps = 20",
            'split_by = ["y0"]',
            r"split_by: got \['y0'\] with split 'random', exp",
        ),
        ("steps = 20", 'split = "groups"', "training.split_by: got none with split 'groups', exp"),
        (
            "steps = 20",
            'split = "groups"\nsplit_by = ["y0", "y0"]',
            "training.split_by: got .*, expected columns, each once",
        ),
        ("steps = 20", "block_rows = 0", "training.block_rows: got 0, expected above 0"),
        ("steps = 20", "noise = -1", "training.noise: got -1.0, expected a number from 0 to 100"),
        ("steps = 20", "noise = nan", "training.noise: got nan, expected a number from 0 to 100"),
        ("steps = 20", "drift = 0.1", "training.drift: got 0.1, expected a table"),
        ("steps = 20", "drift = { gian = 1 }", "drift: 'gian' is not known, .*you mean 'gain'"),
        ("steps = 20", "drift = { gain = true }", "training.drift.gain: got true, expected a num"),
        ("steps = 20", "seed = -1", "training.seed: got -1, expected 0 or more"),
        ("steps = 20", "digits = 2", "training.digits: got 2, expected at least 3: one for each"),
        ("steps = 20", "digits = -1", "training.digits: got -1, expected at least 3"),
        ("steps = 20", 'digits = "few"', "digits: got 'few', expected a whole number or 'fewest'"),
        (
            "steps = 20",
            'digits = "fewest"\ndigits_tolerance = -0.1',
            "training.digits_tolerance: got -0.1, expected 0 or more",
        ),
        (
            "steps = 20",
            "digits = 30\ndigits_tolerance = 0.1",
            "digits_tolerance: got 0.1 with digits 30, expected digits 'fewest'",
        ),
        ("[network]", 'reference = "digit"\n[network]', "data.reference: got 'digit', expected"),
        ("[network]", 'reference = "digit.hybrid"\n[network]', "with 2 simulation figures"),
        (
            '"gradient"',
            '"gradiant"',
            "hardware.activation: got 'gradiant'.*did you mean 'gradient'",
        ),
        (
            "_options = {}",
            "_options = { a = 1 }",
            "activation_options: option 'a' is not known, exp",
        ),
        (
            '"gradient"\nactivation_options = {}',
            '"pade"\nactivation_options = { rho = -1 }',
            "hardware.activation_options.rho: got -1.0, expected a number above 0",
        ),
        (
            '"gradient"\nactivation_options = {}',
            '"pade"\nactivation_options = { iterations = 2.5 }',
            "options.iterations: got 2.5, expected a whole number above 0",
        ),
        (
            '"gradient"\nactivation_options = {}',
            '"pade"\nactivation_options = { roh = 1 }',
            "option 'roh' is not known, expected rho, iterations; did you mean 'rho'",
        ),
        ("_options = {}", "_options = 4", "hardware.activation_options: got 4, expected a table"),
        ("[training]", "clock_mhz = inf\n[training]", "hardware.clock_mhz: got inf"),
    ],
)
def test_a_fault_in_a_scene_names_file_key_and_what_was_expected(
    small_scene: Scene, old: str, new: str, message: str
) -> None:
    path = edited(small_scene, old, new)
    with pytest.raises(InputError, match=message) as caught:
        load_scene(path)
    assert "small.toml" in str(caught.value)


@pytest.mark.parametrize("other", ["./a.npz", "b/../a.npz", "link.npz"])
def test_two_networks_in_one_file_are_refused(small_cascade: Scene, other: str) -> None:
    """This holds for every name of the file, because one network would overwrite the other."""
    small_cascade.path.with_name("link.npz").symlink_to("a.npz")
    names = '["chain.npz", "chain-1.npz", "chain-2.npz"]'
    path = edited(small_cascade, names, f'["chain.npz", "a.npz", "{other}"]')
    message = f"chain.toml: network.weights: got 'a.npz' and '{other}', which are one file"
    with pytest.raises(InputError, match=message):
        load_scene(path)


def test_an_unknown_scene_lists_the_known_ones() -> None:
    with pytest.raises(MissingFileError, match=r"digit-singel.*did you mean 'digit-single'\?"):
        load_scene("digit-singel")
    with pytest.raises(MissingFileError, match="no such scene"):
        load_scene("nowhere/my.toml")
    assert "digit-single" in scene_names()


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("0.1,0.2,oops,0.4,0.5", r"small.csv:3: column 'x2': got 'oops', expected a number"),
        ("0.1,0.2,nan,0.4,0.5", r"small.csv:3: column 'x2': got 'nan', expected a finite number"),
        ("0.1,0.2,inf,0.4,0.5", r"small.csv:3: column 'x2': got 'inf', expected a finite number"),
        ("0.1,0.2,,0.4,0.5", r"small.csv:3: column 'x2': got an empty cell, expected a number"),
        ("0.1,0.2", r"small.csv:3: got 2 cells, expected 5"),
        ("0.1,0.2,0.3,1.5,0.5", r"column 'y0': got a target of 1.5 in row 2, expected -1 to 1"),
        ("0.1,0.2,0.3,0.0,0.5", r"column 'y0' holds a target of 0"),
    ],
)
def test_a_fault_in_a_csv_names_line_and_column(
    small_scene: Scene, line: str, message: str
) -> None:
    lines = small_scene.data_path.read_text().splitlines()
    lines[2] = line
    small_scene.data_path.write_text("\n".join(lines))
    with pytest.raises(InputError, match=message):
        small_scene.vectors()


def test_columns_missing_or_twice(small_scene: Scene) -> None:
    text = small_scene.data_path.read_text()
    small_scene.data_path.write_text(text.replace("x2", "x3", 1))
    with pytest.raises(InputError, match=r"no column 'x2', got x0, x1, x3, y0, y1"):
        small_scene.vectors()
    small_scene.data_path.write_text(text.replace("x2", "x1", 1))
    with pytest.raises(InputError, match="column 'x1' stands twice"):
        small_scene.vectors()


def test_rows_are_chosen_by_the_values_of_columns(small_scene: Scene) -> None:
    lines = small_scene.data_path.read_text().splitlines()
    lines[3] = "0.25,0.5,0.1,0.5,0.5"
    lines[5] = "0.2500,0.5,0.2,0.6,0.6"
    lines[6] = "0.25,-0.5,0.3,1.5,0"
    small_scene.data_path.write_text("\n".join(lines))
    path = edited(small_scene, "[network]", "where = { x0 = 0.25, x1 = 0.5 }\n[network]")
    assert load_scene(path).vectors().inputs.tolist() == [[0.25, 0.5, 0.1], [0.25, 0.5, 0.2]]
    edited(small_scene, "x1 = 0.5", "x1 = -0.5")
    with pytest.raises(InputError, match=r"column 'y0': got a target of 1.5 in row 6, expected"):
        load_scene(path).vectors()
    edited(small_scene, "x1 = -0.5", "x1 = 3")
    with pytest.raises(InputError, match=r"small.csv: no row has x0 = 0.25, x1 = 3, expected one"):
        load_scene(path).vectors()
    edited(small_scene, "x1 = 3", "z = 3")
    with pytest.raises(InputError, match=r"small.csv: no column 'z', got x0, x1"):
        load_scene(path).vectors()


def test_no_rows_and_no_file(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x\n")
    with pytest.raises(InputError, match="expected a header and at least one row"):
        read_table(tmp_path / "a.csv", ["x"])
    with pytest.raises(MissingFileError, match=r"b.csv: no such file"):
        read_table(tmp_path / "b.csv", ["x"])


def test_values_outside_the_signal_are_counted(small_scene: Scene) -> None:
    lines = small_scene.data_path.read_text().splitlines()
    lines[1] = "1.5,-1.5,0.1,0.5,0.5"
    small_scene.data_path.write_text("\n".join(lines))
    vectors = small_scene.vectors()
    assert vectors.saturated == 2
    assert vectors.codes[0, :2].tolist() == [SIGNAL.high, SIGNAL.low]


def test_a_network_survives_the_disk(small_scene: Scene, tmp_path: Path) -> None:
    mlp = small_scene.mlps()[0]
    path = tmp_path / "copy.npz"
    save_network(path, mlp, {"seed": 3, "scene": "x"})
    again = load_network(path, mlp.shape)
    assert all(np.array_equal(getattr(mlp, n), getattr(again, n)) for n in ("w1", "b1", "w2", "b2"))
    assert tomllib.loads(provenance_path(path).read_text()) == {"seed": 3, "scene": "x"}
    assert sorted(p.name for p in tmp_path.glob("*copy*")) == ["copy.npz", "copy.provenance.toml"]


def test_a_network_of_the_wrong_shape(small_scene: Scene) -> None:
    wider = replace(small_scene, members=(replace(small_scene.members[0], hidden=6),))
    with pytest.raises(InputError, match=r"small.npz: w1: got shape \(5, 3\), expected \(6, 3\)"):
        wider.mlps()


@pytest.mark.parametrize("content", [b"", b"no zip at all", b"PK\x03\x04 cut off"])
def test_a_network_file_that_is_none(small_scene: Scene, content: bytes) -> None:
    small_scene.weights_paths[0].write_bytes(content)
    with pytest.raises(InputError, match=r"small.npz: not an NPZ"):
        small_scene.mlps()[0]


def test_a_network_with_faults(small_scene: Scene) -> None:
    mlp, path = small_scene.mlps()[0], small_scene.weights_paths[0]
    np.savez(path, w1=mlp.w1, b1=mlp.b1, w2=mlp.w2)
    with pytest.raises(InputError, match=r"small.npz: no array 'b2', got w1, b1, w2"):
        small_scene.members[0].load()
    np.savez(path, w1=mlp.w1 * np.nan, b1=mlp.b1, w2=mlp.w2, b2=mlp.b2)
    with pytest.raises(InputError, match=r"small.npz: w1: got NaN or infinity"):
        small_scene.members[0].load()
    path.unlink()
    with pytest.raises(MissingFileError, match="no such network; make train"):
        small_scene.members[0].load()


def test_every_shipped_scene_builds() -> None:
    for name in scene_names():
        scene = load_scene(name)
        assert scene.twin().outputs == len(scene.outputs)
        for path in scene.weights_paths:
            provenance = tomllib.loads(provenance_path(path).read_text())
            for key in ("optimiser", "seed", "restarts", "weight_decay", "steps", "patience"):
                assert provenance[key] == getattr(scene.training, key), key


@pytest.mark.parametrize(
    ("precision", "activation"), [("exact", "precise"), ("thesis", "gradient")]
)
def test_a_scene_that_names_no_activation_gets_that_of_its_precision(
    small_scene: Scene, precision: str, activation: str
) -> None:
    assert small_scene.activation == "gradient"
    edited(small_scene, 'activation = "gradient"\n', "")
    scene = load_scene(edited(small_scene, '"exact"', f'"{precision}"'))
    assert scene.activation == activation
    assert {a.block for a in scene.twin().activations} == {activation}


def test_an_activation_that_is_not_made_for_the_precision_is_refused(small_scene: Scene) -> None:
    edited(small_scene, '"exact"', '"thesis"')
    path = edited(small_scene, '"gradient"', '"precise"')
    message = "small.toml: hardware.activation: got 'precise' with precision 'thesis', expected one"
    with pytest.raises(InputError, match=f"{message} of gradient, .*, polynomial$"):
        load_scene(path)
