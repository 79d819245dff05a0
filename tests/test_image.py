"""Tests the image of a scene: its bytes, what refuses it, and hardware that runs several."""

import re
from binascii import crc_hqx
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import on_engine, tiered
from refused import call
from shared import CALL, movable, run
from test_engine import random_codes

from golden.engine.formats import RESULT, WIDTH, signed_code
from golden.engine.function_table import joined
from golden.engine.graph import Graph, Kind, Neuron, Term
from golden.engine.image import Image, Sizes, image_of
from golden.engine.pipeline import Pipeline
from golden.input_error import InputError
from golden.networks.design import Settings
from golden.networks.engine import Engine
from golden.trained.dense import DenseNetwork, Quantiser
from golden.trained.function import TANH
from tactus.scene import Scene, load_scene, scene_path
from tactus.scene.image import scene_image
from tactus.verify.benches.runner import bench_input
from tactus.verify.benches.written import scene_of
from tb.common.case_library import CASE, cases
from tb.common.cases import random_mlp, random_network
from tb.common.images import networks_of_other_depth, networks_of_other_functions
from tb.networks.tb_engine import SCENES, shipped_with_room

SHIPPED = ("digit", "digit-single", "digit-multiple", "swing-single")
LANE_KEYS = {1: "", 3: "lanes = 3"}
CASES = {
    name: case
    for name, case in cases("engines", "lanes", "layered", "tables").items()
    if "reload" not in case.hardware
}


def reloadable(name: str, folder: Path, keys: str = "") -> Scene:
    """The networks of a shipped scene, on an engine that can be reloaded."""
    text = movable(scene_path(name))
    text = re.sub(r'design = "\w+"', f'design = "engine"\nreload = true\n{keys}', text)
    file = folder / f"{name}.toml"
    file.write_text(text)
    return load_scene(str(file))


def engine(network: DenseNetwork, **options: object) -> Engine:
    """Hardware that can be reloaded and that runs the network."""
    return Engine.of([network], Settings(options={"reload": True, **options}))


@pytest.fixture
def hardware(tmp_path: Path) -> Engine:
    return reloadable("digit", tmp_path).twin()


def check_loaded(hardware: Engine, image: Image, alone: Engine) -> None:
    """The loaded hardware has the results of an engine of its own."""
    codes = random_codes(alone.inputs, 60)
    running = hardware.running(hardware.received(image.to_bytes()))
    assert np.array_equal(running.process(codes), alone.process(codes))


@pytest.mark.parametrize("lanes", LANE_KEYS)
@pytest.mark.parametrize("name", SHIPPED)
def test_what_is_loaded_computes_what_the_scene_does(name: str, lanes: int, tmp_path: Path) -> None:
    hardware = reloadable("digit", tmp_path, LANE_KEYS[lanes]).twin()
    scene = load_scene(name)
    image = scene_image(scene, hardware)
    running = hardware.running(hardware.received(image.to_bytes()))
    codes = scene.vectors().codes
    expected = Engine.of(scene.mlps(), arrangement=scene.arrangement).process(codes)
    assert np.array_equal(running.process(codes), expected)
    # It takes no clock more than without an image.
    fixed = replace(scene, design="engine", design_options={"lanes": lanes}).twin()
    assert running.output_clocks == fixed.output_clocks


@pytest.mark.parametrize("lanes", [1, 2, 5, 8])
@pytest.mark.parametrize("name", CASES)
def test_networks_of_any_kind(name: str, lanes: int) -> None:
    case, pipeline = CASES[name], "deep" if lanes == 5 else "short"
    networks = case.networks()
    options = {"reload": True, "lanes": lanes, "program_words": 2048, "pipeline": pipeline}
    hardware = Engine.of(networks, Settings(options=options), case.arrangement)
    assert hardware.lanes == lanes
    check_loaded(hardware, hardware.loaded, Engine.of(networks, Settings(), case.arrangement))
    found = [text for text in hardware.left_out() if "no layer has a node" in text]
    assert not found, "every lane is there, whatever the network of the scene needs"


@pytest.mark.parametrize("lanes", [1, 2, 3])
def test_the_bytes_are_what_the_page_says(lanes: int) -> None:
    image = engine(random_mlp((3, 5, 2), 1.0, seed=1), lanes=lanes).loaded
    data = image.to_bytes()
    header, sent, check = data[:5], data[5:-2], data[-2:]
    assert int.from_bytes(header, "big") == len(image.words) - 1 | (image.inputs - 2) << 18
    words = [int.from_bytes(sent[n : n + 5], "big") for n in range(0, len(sent), 5)]
    assert tuple(reversed(words)) == image.words
    start = crc_hqx(bytes([2, lanes, 9, 7, 9, 0]), 0xFFFF)
    assert int.from_bytes(check, "big") == crc_hqx(data[:-2], start)


def test_each_changed_bit_is_found(hardware: Engine) -> None:
    image = hardware.loaded
    data = bytearray(image.to_bytes())
    for place in range(0, 8 * len(data), 7):
        data[place // 8] ^= 1 << (place % 8)
        assert hardware.image_loader.judge(bytes(data)) is None, place
        data[place // 8] ^= 1 << (place % 8)


def test_hardware_of_each_kind_has_a_check_of_its_own() -> None:
    kinds = [{}] + [
        {"rectifies": True, "cut": c, "even": e} for c in range(17) for e in (False, True)
    ]
    kinds += [
        {"lanes": lanes, "program_words": 2048, "table_blocks": blocks}
        for lanes in range(1, 17)
        for blocks in range(5)
    ]
    kinds += [{"program_words": 1024}, {"program_words": 1024, "segment_width": 8}]
    kinds += [{"operand_words": 256}, {"pipeline": Pipeline(1)}]
    assert len({Sizes(**kind).check_start for kind in kinds}) == len(kinds)


@pytest.mark.parametrize("last", [2, 1536, *(2 | 1 << bit for bit in range(11, 18))])
def test_more_words_than_there_are_are_refused(hardware: Engine, last: int) -> None:
    """The low bits of the header name just the words that come, and the check matches.

    Only the first of these headers fits memories of 1536 words.
    """
    image, fits = hardware.loaded, last < 1536
    assert image.sizes.words == 1536
    words = (image.words * 2)[: last % 2048 + 1]
    numbers = ((image.inputs - 2) << 18 | last, *reversed(words))
    data = b"".join(number.to_bytes(5, "big") for number in numbers)
    data += crc_hqx(data, image.sizes.check_start).to_bytes(2, "big")
    loader, never = hardware.image_loader, np.zeros(len(data), dtype=bool)
    ends = np.arange(len(data)) == len(data) - 1
    loading = loader.process(~never, list(data), ends, never, never)
    assert (loader.judge(data) is not None) == fits
    assert len(loading.good) == fits


@pytest.mark.parametrize(
    ("keys", "faults"),
    [
        ("", ["program words, there are 512"]),
        ("program_words = 1024\noperand_words = 32", ["operand words, there are 32"]),
        ("operand_words = 8", ["program words, there are 512", "operand words, there are 8"]),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path: Path, keys: str, faults: list[str]) -> None:
    networks = [random_mlp((9, 50, 4), 1.0, seed=1)]
    options = {"reload": True, "program_words": 1024}
    hardware = Engine.of(networks, Settings(options=options))
    path = on_engine(tmp_path, networks, hardware=f"reload = true\n{keys}")
    with pytest.raises(InputError, match="the image needs") as refusal:
        load_scene(str(path)).twin()
    message = str(refusal.value)
    assert message.startswith(f"{path}: ")
    loaded = hardware.loaded
    needed = {
        "program words": (len(loaded.words) - loaded.sizes.table_words) // loaded.sizes.columns,
        "operand words": loaded.program.addresses,
    }
    found = re.findall(r"(\d+) (\w+ words)(, there are \d+)", message)
    assert [f"{what}{there}" for _, what, there in found] == faults
    assert all(int(count) == needed[what] for count, what, _ in found)


@pytest.mark.parametrize("relu", [False, True])
def test_sums_that_are_too_large_are_refused(relu: bool) -> None:
    sizes = Sizes(rectifies=relu)
    # Each product reaches 2**34, and half a unit is added. So one product fewer fits.
    products = 1 << (sizes.acc_width - 1 - 34)
    terms = (Term(Kind.WORD, 2, 1 << (WIDTH - 1)),) * products
    first, last = Neuron("first", RESULT, (Term(Kind.WORD, 0, 1),)), Neuron("last", RESULT, terms)
    graph = Graph(2, (first, replace(last, output=True)))
    more, there = sizes.acc_width + 1, sizes.acc_width
    with pytest.raises(InputError, match=f"{more} bits of a sum, there are {there}"):
        image_of(graph, sizes)
    fewer = replace(last, terms=terms[1:], output=True)
    assert replace(graph, neurons=(first, fewer)).sum_bits(joined((TANH,), 9)) == there


def test_networks_that_no_image_holds_are_refused() -> None:
    functions, learned = networks_of_other_functions()[2], CASE["learned-engine"].networks()
    with pytest.raises(InputError, match=r"hardware\.lanes: got 2 for sums of functions, exp"):
        engine(functions, lanes=2, program_words=2048).image_for(learned)
    network = random_mlp((3, 5, 2), 1.0, seed=1)
    with pytest.raises(InputError, match="its program is part of the hardware, expected reload"):
        Engine.of([network]).image_for([network])


QUANTISERS = (
    None,
    Quantiser(2.0**-3, 0, 0, 15),
    Quantiser(2.0**-3, 0, 0, 15, "floor"),
    Quantiser(2.0**-3, 0, 0, 31),
)


def with_relu(quantiser: Quantiser | None, depth: int = 2) -> DenseNetwork:
    shape = (3, *(4,) * depth, 2)
    return random_network(shape, ("relu",) * depth, 1.0, seed=depth, quantiser=quantiser)


@pytest.mark.parametrize("lanes", [1, 4])
@pytest.mark.parametrize("quantiser", QUANTISERS, ids=str)
def test_networks_of_other_depth_run_on_the_same_hardware(
    quantiser: Quantiser | None, lanes: int
) -> None:
    hardware = engine(with_relu(quantiser), lanes=lanes)
    for network in networks_of_other_depth(quantiser):
        check_loaded(hardware, hardware.image_for([network]), Engine.of([network]))


PLAIN = random_mlp((3, 4, 2), 1.0, seed=1)


@pytest.mark.parametrize(
    ("hardware", "image", "message"),
    [
        (with_relu(None), QUANTISERS[1], "ReLU of 4 bits, halves to even, there is ReLU of 17 bi"),
        (with_relu(QUANTISERS[1]), None, "ReLU of 17 bits, there is ReLU of 4 bits, halves to ev"),
        (with_relu(QUANTISERS[1]), QUANTISERS[2], "ReLU of 4 bits, there is ReLU of 4 bits, halv"),
        (with_relu(QUANTISERS[3]), QUANTISERS[1], "4 bits, halves to even, there is ReLU of 5 bi"),
        (PLAIN, None, "the image needs ReLU of 17 bits, there is no ReLU"),
    ],
)
def test_another_relu_is_refused(
    hardware: DenseNetwork, image: Quantiser | None, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        engine(hardware).image_for([with_relu(image)])


@pytest.mark.parametrize(
    ("lanes", "words", "note"),
    [(1, 1536, "node 1 sum = 1"), (3, 2560, "node 1 sum: 1 and node 2 sum: 1")],
)
def test_make_image(tmp_path: Path, capsys, lanes: int, words: int, note: str) -> None:
    hardware = reloadable("digit", tmp_path, LANE_KEYS[lanes])
    call("image", "swing-single", "--hardware", hardware.path, "--build", tmp_path)
    twin = hardware.twin()
    image = scene_image(load_scene("swing-single"), twin)
    size = f"{len(image.words)} of {words} words of tables, weights and program, "
    size += f"{image.program.addresses} of 128 operand words, {len(image.to_bytes())} bytes"
    assert size in capsys.readouterr().out
    folder = tmp_path / "swing-single" / "image"
    assert (folder / "swing-single.bin").read_bytes() == image.to_bytes()
    read = [int(line, 16) for line in (folder / "swing-single.hex").read_text().splitlines()]
    assert tuple(read) == image.contents
    assert len(read) == words > len(image.words)
    assert not any(read[len(image.words) :])
    heading, *lines = (folder / "swing-single.mem").read_text().splitlines()
    assert ("for lanes 3, 512 program words" in heading) == (lanes == 3)
    assert [int(line.split()[1], 16) for line in lines] == list(image.words)
    assert any(note in line for line in lines)


def test_an_image_that_is_refused_leaves_the_one_before(tmp_path: Path) -> None:
    small = reloadable("digit-load", tmp_path, "operand_words = 32").path
    image = tmp_path / "digit-single" / "image" / "digit-single.bin"
    image.parent.mkdir(parents=True)
    image.write_bytes(b"before")
    command = [*CALL, "tactus.scene.image", "digit-single"]
    result = run(*command, "--hardware", small, "--build", tmp_path)
    assert result.returncode == 2
    assert "the image needs 40 operand words, there are 32" in result.stderr
    assert image.read_bytes() == b"before"


@pytest.mark.parametrize("kind", tiered(["shipped"], ["lanes", "exact-reload"]))
def test_two_scenes_of_the_same_sizes_are_the_same_hardware(tmp_path: Path, kind: str) -> None:
    """The networks differ, and with exact-reload also in how many hidden layers they have."""
    if case := cases("layered").get(kind):
        one = replace(case, shapes=[(5, 2, 1)], activations=("relu",))
        scenes = [scene_of(case, tmp_path, kind), scene_of(one, tmp_path, f"{kind}-one")]
    else:
        keys = LANE_KEYS[3 if kind == "lanes" else 1]
        scenes = [reloadable(name, tmp_path, keys) for name in ("digit", "swing-single")]
    for scene in scenes:
        command = [*CALL, "tactus.export.command", scene.path, "both", "--build", tmp_path]
        assert run(*command).returncode == 0
    for language in ("vhdl", "verilog"):
        first, second = (tmp_path / scene.name / language for scene in scenes)
        order = (first / "compile_order.txt").read_text()
        assert order == (second / "compile_order.txt").read_text()
        assert "engine" in order
        for file in order.split():
            assert (first / file).read_bytes() == (second / file).read_bytes(), file


@pytest.mark.parametrize("name", [*cases("reloaded"), "rails-lanes-reload"])
def test_the_bench_loads_every_shipped_scene(name: str, tmp_path: Path) -> None:
    """It passes over scenes for which the hardware of a user has no room, and over none here."""
    case = CASE[name]
    shipped = [bench_input(load_scene(other)) for other in SCENES]
    found = shipped_with_room(scene_of(case, tmp_path, name).twin(), shipped)
    assert tuple(scene.name for scene, _ in found) == SCENES


def test_words_stand_where_the_page_says() -> None:
    """Other loaders are written from docs/instruction-set.md."""
    hardware = engine(random_mlp((3, 5, 2), 1.0, seed=1), lanes=3)
    words, program = hardware.loaded.words, hardware.program
    low, high = [word & 0x3FFFF for word in words], [word >> 18 for word in words]
    assert low[:512] == high[:512] == list(program.table)
    rows = range(512, len(words), 4)
    assert [words[n] for n in rows][: len(program.words)] == list(program.words)
    own = [[low[n + 1], high[n + 1], low[n + 2]] for n in rows]
    codes = [tuple(signed_code(code) for code in row) for row in own]
    assert codes[: len(program.weights)] == [tuple(row) for row in program.weights]
