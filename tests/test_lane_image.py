"""Tests the images of an engine with several multipliers, and hardware that runs several of them.

What the loader does with bytes is tested in ``tests/test_image.py``.
"""

import subprocess
import sys
from binascii import crc_hqx
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from test_engine import random_codes
from test_image import reloadable

from golden.engine.fields import signed_code
from golden.engine.image import Image, Sizes
from golden.input_error import InputError
from golden.networks.design import Design
from golden.networks.engine import Engine
from golden.networks.left_out import left_out
from golden.networks.settings import Settings
from golden.trained.dense import Quantiser, Trained, layers_of
from tactus.cli.image import main
from tactus.scene import Scene, load_scene
from tactus.scene.image import scene_image
from tactus.verify.benches.written import scene_of
from tb.common.case_library import ENGINES, LANES, LAYERED, LEARNED, RELOADED_LANES, TABLES
from tb.common.cases import random_mlp, random_network
from tb.common.images import networks_of_other_depth, networks_of_other_functions

CASES = {
    name: case
    for name, case in (ENGINES | LANES | LAYERED | TABLES).items()
    if "reload" not in case.hardware
}
SHIPPED = ("digit", "digit-single", "digit-multiple", "swing-single")


def on_lanes(name: str, folder: Path, keys: str = "lanes = 3") -> Scene:
    """The networks of a shipped scene, on lanes that can be reloaded."""
    return reloadable(name, folder, keys)


def lanes_for(network: Trained, **options: object) -> Engine:
    """An engine that can be reloaded and that runs the network."""
    return Engine.of([network], Settings(options={"reload": True, **options}))


def from_bytes(hardware: Engine, image: Image) -> Engine:
    """The hardware, running the words that it finds in the bytes of an image."""
    found = hardware.image_loader.judge(image.to_bytes())
    assert found is not None
    before_last, words = found
    inputs = (before_last + 2) % image.sizes.operand_words
    return hardware.running(Image(image.sizes, inputs, tuple(words)))


def check_results(hardware: Engine, image: Image, other: Design) -> None:
    """The loaded hardware has the results of another design."""
    codes = random_codes(other.inputs, 60)
    assert np.array_equal(from_bytes(hardware, image).process(codes), other.process(codes))


@pytest.mark.parametrize("name", SHIPPED)
def test_what_is_loaded_computes_what_the_scene_does(name: str, tmp_path: Path) -> None:
    hardware = on_lanes("digit", tmp_path).twin()
    assert isinstance(hardware, Engine)
    scene = load_scene(name)
    image = scene_image(scene, hardware)
    running = from_bytes(hardware, image)
    codes = scene.vectors().codes
    expected = Engine.of(scene.mlps(), arrangement=scene.arrangement).process(codes)
    assert np.array_equal(running.process(codes), expected)
    # A row of the image for each word of the program, and no clock more than without an image.
    many = replace(scene, design="engine", design_options={"lanes": 3}).twin()
    assert running.output_clocks == many.output_clocks
    assert len(image.words) == 512 + 4 * (len(many.program.words) + 1)


@pytest.mark.parametrize("lanes", [1, 2, 5, 8])
@pytest.mark.parametrize("name", CASES)
def test_networks_of_any_kind(name: str, lanes: int) -> None:
    case, pipeline = CASES[name], "deep" if lanes == 5 else "short"
    networks = case.networks()
    options = {"reload": True, "lanes": lanes, "program_words": 2048, "pipeline": pipeline}
    hardware = Engine.of(networks, Settings(options=options), case.arrangement)
    assert hardware.loaded is not None
    assert hardware.lanes == lanes
    check_results(hardware, hardware.loaded, Engine.of(networks, Settings(), case.arrangement))
    found = [text for text in left_out(hardware) if "no layer has a node" in text]
    assert not found, "every lane is there, whatever the network of the scene needs"


@pytest.mark.parametrize("quantiser", [None, Quantiser(2.0**-3, 0, 0, 15)], ids=str)
def test_networks_of_other_depth_run_on_the_same_hardware(quantiser: Quantiser | None) -> None:
    own = random_network((3, 4, 4, 2), ("relu", "relu"), 1.0, seed=2, quantiser=quantiser)
    hardware = lanes_for(own, lanes=4)
    for network in networks_of_other_depth(quantiser):
        check_results(hardware, hardware.image_for([network]), Engine.of([network]))


def test_networks_of_other_functions_run_on_the_same_hardware() -> None:
    networks = networks_of_other_functions()
    hardware = lanes_for(networks[2], lanes=2, program_words=2048)
    assert hardware.program.blocks == 4
    for network in networks:
        check_results(hardware, hardware.image_for([network]), Engine.of([network]))


@pytest.mark.parametrize("lanes", [2, 3])
def test_the_words_are_where_the_page_says(lanes: int) -> None:
    hardware = lanes_for(random_mlp((3, 5, 2), 1.0, seed=1), lanes=lanes)
    image, program = hardware.loaded, hardware.program
    assert image is not None
    table, columns = 512, {2: 2, 3: 4}[lanes]
    low = [word & 0x3FFFF for word in image.words]
    high = [word >> 18 for word in image.words]
    assert tuple(low[:table]) == tuple(high[:table]) == program.table
    assert image.words[table::columns][: len(program.words)] == program.words
    halves = [
        half[table + 1 + n :: columns] for n in range((lanes + 1) // 2) for half in (low, high)
    ]
    for lane in range(lanes):
        weights = [row[lane] for row in program.weights]
        assert [signed_code(code) for code in halves[lane]][: len(weights)] == weights
    if lanes == 3:
        assert not any(halves[3])
        assert not any(image.words[table + 3 :: columns])
    # The texts of the image name the words of the program and the weights of both lanes.
    notes = image.notes[table::columns]
    assert notes[: program.length] == program.notes[: program.length]
    assert image.notes[0] == "intercept of segment 0"
    assert image.notes[table + 1] == "none"
    data = image.to_bytes()
    start = crc_hqx(bytes([2, lanes, 9, 7, 9, 0]), 0xFFFF)
    assert int.from_bytes(data[-2:], "big") == crc_hqx(data[:-2], start)


def test_an_image_for_other_hardware_fails_its_check() -> None:
    network = random_mlp((3, 5, 2), 1.0, seed=1)
    hardware = lanes_for(network, lanes=2)
    for other in (
        lanes_for(network, lanes=3),
        lanes_for(network, lanes=2, program_words=1024),
        lanes_for(network, lanes=2, pipeline="deep"),
        Engine.of([network], Settings(options={"reload": True})),
    ):
        assert hardware.image_loader.judge(other.image) is None
        assert other.image_loader.judge(hardware.image) is None
        assert other.image_loader.judge(other.image) is not None
    starts = {
        Sizes(lanes=lanes, program_words=2048, table_blocks=blocks).check_start
        for lanes in range(1, 17)
        for blocks in range(5)
    }
    assert len(starts) == 16 * 5


def test_more_words_than_there_are_are_refused() -> None:
    """The number of words is not a power of two: two more would still have an address."""
    hardware = lanes_for(random_mlp((3, 5, 2), 1.0, seed=1), lanes=2)
    sizes, loader = hardware.loaded.sizes, hardware.image_loader
    assert loader.words == sizes.words == 512 + 2 * 512 < 1 << loader.program_addr_width
    for more in (0, 1):
        image = Image(sizes, 3, (1,) * (sizes.words + more))
        assert (loader.judge(image.to_bytes()) is None) == bool(more)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"program_words": 500}, r"program_words: got 500, expected a power of two, 2 to 65536"),
        (
            {"lanes": 2, "program_words": 16384},
            r"program_words: got 16384, expected a power of two, 2 to 8192",
        ),
        (
            {"program_words": 256},
            r"hardware\.program_words: got 256, expected 512 or more, which the tables of each "
            "lane take with segment_width 9",
        ),
        (
            {"program_words": 1024, "table_blocks": 3},
            r"got 1024, expected 2048 or more, .* with segment_width 9 and table_blocks 3",
        ),
        ({"operand_words": 2048}, r"operand_words: got 2048, expected a power of two, 2 to 1024"),
        ({"operand_words": 8}, r"needs \d+ operand words, there are 8 \(hardware.operand_words\)"),
    ],
)
def test_a_size_that_cannot_be_is_refused(options: dict[str, int], message: str) -> None:
    with pytest.raises(InputError, match=message):
        lanes_for(random_mlp((6, 5, 2), 1.0, seed=1), **options)


def test_what_does_not_fit_is_refused() -> None:
    hardware = lanes_for(random_mlp((3, 5, 2), 1.0, seed=1), lanes=2)
    wide = random_mlp((40, 30, 2), 1.0, seed=1)
    with pytest.raises(InputError, match=r"needs \d+ program words, there are 512 \(hardware.prog"):
        hardware.image_for([wide])
    with pytest.raises(InputError, match="the image needs ReLU of 17 bits, there is no ReLU"):
        hardware.image_for([random_network((3, 4, 2), ("relu",), 1.0, seed=1)])
    functions = networks_of_other_functions()[2]
    with pytest.raises(
        InputError, match="3 table_blocks for bent, wave, there is the table of tanh"
    ):
        hardware.image_for([functions])
    learned = LEARNED["learned-engine"].networks()
    with pytest.raises(InputError, match=r"hardware\.lanes: got 2 for sums of functions, exp"):
        lanes_for(functions, lanes=2, program_words=2048).image_for(learned)
    built_in = Engine.of([wide])
    with pytest.raises(InputError, match="its program is part of the hardware, expected reload"):
        built_in.image_for([wide])


def test_the_hardware_does_not_depend_on_the_image() -> None:
    """Its parts are the same, and a lane has room for as many weights as the program has words."""
    hardware = lanes_for(random_mlp((3, 5, 2), 1.0, seed=1), lanes=3)
    other = lanes_for(random_mlp((9, 2, 4), 50.0, seed=2), lanes=3)
    assert hardware.parts() == other.parts()
    assert hardware.ports == other.ports
    memory = hardware.lane_memories[0]
    assert len(set(hardware.lane_memories)) == 1
    assert (len(memory.weights), len(memory.table), len(memory.contents)) == (512, 512, 1024)


def test_two_scenes_of_the_same_sizes_are_the_same_hardware(tmp_path: Path) -> None:
    scenes = [on_lanes(name, tmp_path) for name in ("digit", "swing-single")]
    for scene in scenes:
        for language in ("vhdl", "verilog"):
            command = [sys.executable, "-m", "tactus.export", str(scene.path), language]
            subprocess.run([*command, "--build", str(tmp_path)], check=True, capture_output=True)
    for language in ("vhdl", "verilog"):
        first, second = (tmp_path / scene.name / language for scene in scenes)
        order = (first / "compile_order.txt").read_text()
        assert order == (second / "compile_order.txt").read_text()
        assert "lane_memory" in order
        for file in order.split():
            assert (first / file).read_bytes() == (second / file).read_bytes(), file


def test_make_image(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    hardware = on_lanes("digit", tmp_path)
    words = ["swing-single", "--hardware", str(hardware.path), "--build", str(tmp_path)]
    monkeypatch.setattr("sys.argv", ["image", *words])
    main()
    twin = hardware.twin()
    assert isinstance(twin, Engine)
    image = scene_image(load_scene("swing-single"), twin)
    size = f"{len(image.words)} of 2560 words of tables, weights and program, "
    size += f"{image.program.addresses} of 128 operand words, {len(image.to_bytes())} bytes"
    assert size in capsys.readouterr().out
    folder = tmp_path / "swing-single" / "image"
    assert (folder / "swing-single.bin").read_bytes() == image.to_bytes()
    read = [int(line, 16) for line in (folder / "swing-single.hex").read_text().splitlines()]
    assert tuple(read) == image.contents
    heading, *lines = (folder / "swing-single.mem").read_text().splitlines()
    assert "for lanes 3, 512 program words" in heading
    assert [int(line.split()[1], 16) for line in lines] == list(image.words)
    assert any("node 1 sum: 1 and node 2 sum: 1" in line for line in lines)


def test_the_cases_are_hardware_that_can_be_reloaded(tmp_path: Path) -> None:
    twins = [scene_of(case, tmp_path, name).twin() for name, case in RELOADED_LANES.items()]
    for twin in twins:
        assert isinstance(twin, Engine)
        assert twin.image
    # They differ in each choice of the hardware.
    for first, second in pairwise(twins):
        assert first.lanes % 2 != second.lanes % 2
        assert first.rectifies != second.rectifies
        assert first.program.pipeline != second.program.pipeline
        assert (first.program.blocks > 1) != (second.program.blocks > 1)
    layers = layers_of(RELOADED_LANES["rails-lanes-reload"].networks()[0])
    assert len(layers[0].weights) < twins[0].lanes, "one lane has no node of the scene's network"
