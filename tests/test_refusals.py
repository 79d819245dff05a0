"""A bad file is refused by one line that names it. The entries are in tests/refusals/."""

import io
import os
import re
import secrets
import shlex
import shutil
import struct
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import onnx.parser
import pytest
from onnx import TensorProto, helper, numpy_helper
from refused import COMMANDS, Desk
from scipy.io import savemat
from scipy.sparse import csc_matrix

from tactus.boards.board import FOLDER as BOARDS
from tactus.core.commands import BY_NAME
from tactus.core.finding import faults
from tactus.physics.gauges import FOLDER as RIGS
from tactus.scene import scene_path
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.runner import BUILD
from tactus.verify.benches.written import scene_of, write_scene
from tactus.verify.check import check
from tb.common.cases import random_mlp

FOLDER = Path(__file__).parent / "refusals"
READ = {path.stem: tomllib.loads(path.read_text("utf-8")) for path in FOLDER.glob("*.toml")}
TEXTS = {kind: read.pop("text", "").lstrip() for kind, read in READ.items()}
# The file of a base, and the command that reads a copy of it.
SHIPPED = {
    "ulx3s": (BOARDS / "ulx3s.toml", ["bitstream", "digit-board"]),
    "rig": (RIGS / "digit.toml", ["sensors"]),
}


def repeated(text: str) -> str:
    return re.sub("(.)…", lambda found: found[1] * 200_000, text)


def entries(kind: str) -> list[Any]:
    """The name of a base, a text of its file, what stands for it, and the words of the refusal."""
    return [
        pytest.param(base, old, repeated(new), words, id=ascii(f"{base}: {new or old}")[1:60])
        for base, edits in READ[kind].items()
        for old, changes in edits.items()
        for new, words in changes.items()
    ]


@pytest.mark.parametrize(("base", "old", "new", "words"), entries("scene"))
def test_a_scene_is_refused(
    desk: Desk, base: str, old: str, new: str, words: str | list[str]
) -> None:
    *call, name = ["vhdl", *base.split()][-2:]
    if name in CASES:
        scene_of(CASES[name], desk.folder, "mine")
    elif name != "mine":
        path = scene_path(name)
        shutil.copytree(path.parent, desk.folder, dirs_exist_ok=True)
        (desk.folder / path.name).rename("mine.toml")
    (desk.folder / "link.npz").symlink_to("mine.npz")
    (desk.folder / "loop").symlink_to("loop")
    desk.edit(old, new)
    desk.refuses(*call, "mine.toml", says=words)
    if isinstance(words, list):
        said = desk.call("vhdl", "mine.toml")[1].splitlines()
        assert [f"error: {text}" for text in faults(check("mine.toml", Path("build")))] == said


@pytest.mark.parametrize(("call", "old", "new", "words"), entries("readings"))
def test_readings_are_refused(desk: Desk, call: str, old: str, new: str, words: str) -> None:
    (desk.folder / "mine.csv").write_text(TEXTS["readings"])
    desk.edit(old, new, "mine.csv", "latin-1")
    desk.refuses(*shlex.split(call), says=words)


@pytest.mark.parametrize(("base", "old", "new", "words"), entries("shipped"))
def test_a_board_or_a_rig_is_refused(
    desk: Desk, base: str, old: str, new: str, words: str | list[str]
) -> None:
    path, call = SHIPPED[base]
    shutil.copy(path, "mine.toml")
    desk.edit(old, new)
    said = [words] if isinstance(words, str) else words
    desk.refuses(*call, "mine.toml", says=[f"mine.toml: {text}" for text in said])


@pytest.mark.parametrize(("form", "old", "new", "words"), entries("network"))
def test_a_network_is_refused(desk: Desk, form: str, old: str, new: str, words: str) -> None:
    text = TEXTS["network"]
    assert old in text
    model = onnx.parser.parse_model(text.replace(old, new))
    (desk.folder / f"mine.{form}").write_bytes(model.SerializeToString())
    desk.edit("mine.npz", f"mine.{form}")
    desk.edit("hidden = 5", "hidden = 0")
    desk.refuses("vhdl", "mine.toml", says=f"mine.{form}: .*{words}")


@pytest.fixture
def crowded(desk: Desk) -> Desk:
    """A desk with many files beside the scene that are not scenes."""
    (desk.folder / "folder.toml").mkdir()
    (desk.folder / "folder.npz").mkdir()
    (desk.folder / "loop.toml").symlink_to("loop.toml")
    (desk.folder / "device.toml").symlink_to("/dev/full")
    (desk.folder / "other").mkdir()
    for name in ("other.npz", "other.svg", "other/mine.npz"):
        (desk.folder / name).write_text("of the user", encoding="utf-8")
    for name in ("pipe", "pipe.npz", "pipe.toml"):
        os.mkfifo(desk.folder / name)
    scene = (desk.folder / "mine.toml").read_text(encoding="utf-8")
    (desk.folder / "untrained.toml").write_text(scene.replace("mine.npz", "no.npz"))
    (desk.folder / "latin.toml").write_bytes(b"# \xe9\n")
    (desk.folder / "binary.toml").write_bytes(bytes(99))
    return desk


@pytest.mark.parametrize(("call", "words"), READ["calls"]["calls"].items(), ids=ascii)
def test_a_call_is_refused(crowded: Desk, call: str, words: str) -> None:
    crowded.refuses(*shlex.split(repeated(call)), says=words)


@pytest.mark.parametrize(
    ("call", "name", "words"),
    [
        (call, *entry)
        for call, ways in READ["calls"]["in_the_way"].items()
        for entry in ways.items()
    ],
)
def test_what_stands_in_the_way_is_named(desk: Desk, call: str, name: str, words: str) -> None:
    scene_of(CASES["rails-reload"], desk.folder, "loaded")
    path = desk.folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    if name.endswith("/"):
        path.unlink(missing_ok=True)
        path.mkdir()
    else:
        path.touch()
    desk.refuses(*call.split(), says=words)
    assert path.exists()


MLP = random_mlp((3, 5, 2), 1.0, 1)
ROWS = {
    f"{kind}{n}": array
    for n, layer in enumerate(MLP.layers, start=1)
    for kind, array in (("w", layer.weights), ("b", layer.biases))
}
COLUMNS = {name: array.T if "w" in name else array[None] for name, array in ROWS.items()}
NONE = {
    "w1": np.zeros((0, 3)),
    "b1": np.zeros(0),
    "w2": np.zeros((2, 0)),
    "b2": ROWS["b2"],
}


def npz(**changed: Any) -> bytes:
    file = io.BytesIO()
    np.savez(file, **{k: v for k, v in (ROWS | changed).items() if v is not None})
    return file.getvalue()


def npy(header: str) -> bytes:
    """An archive of one array with a header of its own."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        length = struct.pack("<H", len(header))
        archive.writestr("w1.npy", b"\x93NUMPY\x01\x00" + length + header.encode())
    return file.getvalue()


def damaged(content: bytes, at: int, count: int = 4) -> bytes:
    return content[:at] + bytes(b ^ 255 for b in content[at : at + count]) + content[at + count :]


def mat(variables: dict[str, Any], **options: Any) -> bytes:
    file = io.BytesIO()
    savemat(file, variables, **options)
    return file.getvalue()


def netlab(**changed: Any) -> bytes:
    return mat({"net": {k: v for k, v in (COLUMNS | changed).items() if v is not None}})


def onnx_file(**changed: Any) -> bytes:
    """A network in which some constants are replaced."""
    ends = [[helper.make_tensor_value_info(n, TensorProto.DOUBLE, [None, 3])] for n in "xy"]
    constants = COLUMNS | {"b1": ROWS["b1"], "b2": ROWS["b2"]} | changed
    tensors = [
        value if isinstance(value, TensorProto) else numpy_helper.from_array(np.array(value), name)
        for name, value in constants.items()
    ]
    steps = [
        helper.make_node("MatMul", ["x", "w1"], ["a"]),
        helper.make_node("Add", ["a", "b1"], ["b"]),
        helper.make_node("Tanh", ["b"], ["c"]),
        helper.make_node("MatMul", ["c", "w2"], ["d"]),
        helper.make_node("Add", ["b2", "d"], ["y"]),
    ]
    return helper.make_model(helper.make_graph(steps, "test", *ends, tensors)).SerializeToString()


def tensor(**fields: Any) -> TensorProto:
    """The weights of layer 1 with some fields changed, or removed if the value is None."""
    made = numpy_helper.from_array(ROWS["w1"].T, "w1")
    for name, value in fields.items():
        made.ClearField(name)
        if name == "dims":
            made.dims.extend(value)
        elif value is not None:
            setattr(made, name, value)
    return made


def elsewhere(location: str) -> TensorProto:
    """The weights of layer 1 in another file."""
    made = tensor(raw_data=None, data_location=TensorProto.EXTERNAL)
    made.external_data.add(key="location", value=location)
    return made


NPZ = {
    "empty": (b"", "no zip archive"),
    "damaged": (damaged(npz(), 300), "not an NPZ of numbers"),
    "asks for terabytes": (
        npy(f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({10**12}, 3)}}"),
        "not an NPZ of numbers",
    ),
    "code": (npy("__import__('os')"), "not an NPZ of numbers"),
    "objects": (npz(w1=np.array([object()])), "not an NPZ of numbers"),
    "complex": (npz(w1=ROWS["w1"] + 1j), "w1: got complex128, expected real numbers"),
    "dates": (npz(b1=np.full(5, np.datetime64(1, "D"))), "b1: got datetime64[D], expected real"),
    "an array is missing": (npz(w2=None), "no array 'w2', got w1, b1, b2"),
    "transposed": (
        npz(w1=ROWS["w1"].T),
        "w1: got shape (3, 5), expected (5, 3) of .*; it is transp",
    ),
    "a number": (npz(b1=5.0), "b1: got shape (), expected (5,) of a 3:5:2 network"),
    "NaN": (
        npz(b2=ROWS["b2"] * np.nan),
        "b2: got NaN or infinity, expected finite numbers",
    ),
    "does not fit": (npz(w1=ROWS["w1"] * 1e300), "layer 1 weights: largest magnitude"),
}
MAT = {
    "empty": (b"", "not a MATLAB file up to version 7"),
    "version 7.3": (
        b"MATLAB 7.3 MAT-file" + b" " * 105 + b"\x00\x02IM" + b"\x89HDF\r\n\x1a\n" + bytes(400),
        "not a MATLAB file up to version 7",
    ),
    "damaged": (damaged(netlab(), 130), "not a MATLAB file up to version 7"),
    "damaged, compressed": (
        damaged(mat({"net": COLUMNS}, do_compression=True), 150, 30),
        "not a MATLAB file up to version 7",
    ),
    "no network": (mat({"a": 1}), "got 0 networks among the variables a, expected one with"),
    "two networks": (mat({"a": COLUMNS, "b": COLUMNS}), "got 2 networks among the variables a, b"),
    "a field is missing": (netlab(w2=None), "got 0 networks among the variables net"),
    "transposed": (
        netlab(w1=ROWS["w1"]),
        "w1: got shape (5, 3), expected (3, 5) of .*; it is transp",
    ),
    "sparse": (
        netlab(w1=csc_matrix(ROWS["w1"].T)),
        "w1: got object, expected real numbers",
    ),
}
ONNX = {
    "empty": (b"", "got 0 inputs and 0 outputs, expected a graph with one of each"),
    "an image": (b"\xff\xd8\xff\xe0" + bytes(100), "not an ONNX file"),
    "values in a file that is missing": (onnx_file(w1=elsewhere("no.bin")), ".*no.bin"),
    "values in a file outside": (
        onnx_file(w1=elsewhere("../a.bin")),
        "not an ONNX file: .*outside",
    ),
    "values in a file of the system": (
        onnx_file(w1=elsewhere("/etc/passwd")),
        "not an ONNX file: ",
    ),
    "values of a type that is not known": (onnx_file(w1=tensor(data_type=77)), "tensor 'w1' holds"),
    "more values than any memory": (
        onnx_file(w1=tensor(dims=[1 << 40, 5])),
        "tensor 'w1' holds number",
    ),
    "a size below 0": (
        onnx_file(w1=tensor(dims=[3, -1])),
        "tensor 'w1': got the shape [3, -1], exp",
    ),
    "text": (
        onnx_file(w1=helper.make_tensor("w1", TensorProto.STRING, [3, 5], [b"a"] * 15)),
        "w1: got object, expected real numbers",
    ),
}
TABLE = [
    pytest.param(form, content, message, id=f"{form}-{name}".replace(" ", "_"))
    for form, rows in (("npz", NPZ), ("mat", MAT), ("onnx", ONNX))
    for name, (content, message) in rows.items()
]


@pytest.mark.parametrize(("form", "content", "message"), TABLE)
def test_a_network_file_is_refused(desk: Desk, form: str, content: bytes, message: str) -> None:
    desk.edit("mine.npz", f"mine.{form}")
    (desk.folder / f"mine.{form}").write_bytes(content)
    desk.refuses("vhdl", "mine.toml", says=f"mine.{form}: .*{message}")


@pytest.mark.parametrize("form", ["npz", "mat", "onnx"])
def test_a_network_without_hidden_nodes_is_refused(desk: Desk, form: str) -> None:
    """Also if the scene takes as many hidden nodes as the file has."""
    none = {"npz": npz(**NONE), "mat": mat({k: v.T for k, v in NONE.items()})}
    none["onnx"] = onnx_file(w1=NONE["w1"].T, b1=NONE["b1"], w2=NONE["w2"].T)
    desk.edit("mine.npz", f"mine.{form}")
    desk.edit("hidden = 5", "hidden = 0")
    (desk.folder / f"mine.{form}").write_bytes(none[form])
    desk.refuses("vhdl", "mine.toml", says=f"mine.{form}: b1: got 0 hidden nodes, expected 1 or")


def test_what_the_rows_change_is_read_without_a_change(desk: Desk) -> None:
    named = "mine.npz"
    for form, content in (("npz", npz()), ("mat", netlab()), ("onnx", onnx_file())):
        desk.edit(named, f"mine.{form}")
        named = f"mine.{form}"
        (desk.folder / named).write_bytes(content)
        assert desk.call("vhdl", "mine.toml") == (0, "")


# Commands that need more than a scene, or none, and those that need no more.
MORE = ("network", "scene", "check", "predict", "bitstream")
SCENES = [n for n in COMMANDS if n not in MORE]


@pytest.mark.parametrize("command", SCENES)
def test_every_command_refuses_a_scene(desk: Desk, command: str) -> None:
    """The scene is missing, is broken, or has no network or, for training, no data."""
    desk.refuses(command, "digit-singel", says="scene 'digit-singel': no such scene")
    desk.edit('file = "mine.csv"', 'file = "no.csv"')
    if command == "train":
        desk.refuses(command, "mine.toml", says="no.csv: no such file")
    else:
        desk.edit('file = "no.csv"', 'file = "mine.csv"')
        (desk.folder / "mine.npz").write_bytes(b"")
        if command == "image":
            desk.edit(
                'design = "hybrid"\nactivation = "gradient"', 'design = "engine"\nreload = true'
            )
        desk.refuses(command, "mine.toml", says="mine.npz: not an NPZ of numbers")
        if command == "image":
            desk.edit('"engine"', '"hybrid"')
    desk.edit('"hybrid"', '"hybird"')
    desk.refuses(command, "mine.toml", says="mine.toml: hardware.design: got 'hybird', expected")


@pytest.mark.parametrize("name", ["--help", "--"])
@pytest.mark.parametrize("command", [c for c in COMMANDS if c != "scene"])
def test_a_scene_like_an_option_is_a_scene(desk: Desk, command: str, name: str) -> None:
    """The command is called as make calls it, with the other values that it needs."""
    known = BY_NAME[command]
    given = {argument.name: argument.example for argument in known.arguments if argument.needed}
    words = known.words(given | {"SCENE": name})[3:]
    code, said = desk.call(command, *words[: len(words) - len(known.last)])
    assert code == 2
    if command == "check":
        assert said == f"error: {name}: 1 fault, listed above\n"
    else:
        assert said.startswith(f"error: scene {name!r}: no such scene, expected a path to a ")
        assert said.count("\n") == 1


def test_a_command_replaces_its_own_file_and_others_by_force(desk: Desk) -> None:
    words = ["predict", "mine.toml", "mine.csv", "other.csv"]
    (desk.folder / "other.csv").write_text("of the user", encoding="utf-8")
    desk.refuses(*words, says="other.csv: is there already")
    assert desk.call(*words, "--force") == (0, "")
    assert desk.call(*words) == (0, "")


def test_training_replaces_only_its_own_networks(desk: Desk, monkeypatch) -> None:
    monkeypatch.setenv("DRY", "1")
    assert desk.call("train", "mine.toml") == (0, "")
    (desk.folder / "mine.provenance.toml").unlink()
    desk.refuses("train", "mine.toml", says="network.weights=mine.npz: is there already")
    assert desk.call("train", "mine.toml", "--force") == (0, "")


@pytest.mark.parametrize("output", ["y9", "", "x0"])
def test_an_output_is_refused(desk: Desk, output: str) -> None:
    mlps = [random_mlp((3 + i, 4, 1), 1.0, i) for i in range(2)]
    write_scene(desk.folder, "chain", "exact", mlps, "cascade")
    message = f"OUTPUT={output}: scene chain has 2 networks, expected one of y0, y1"
    desk.refuses("network", "chain.toml", "a.npz", "--output", output, says=message)
    desk.refuses("network", "chain.toml", "a.npz", says="OUTPUT=: scene chain has 2 networks")


@pytest.mark.parametrize("command", ["sim", "demo", "report"])
def test_what_stands_in_the_way_of_benches_is_named(desk: Desk, command: str) -> None:
    """They write into the checkout, wherever the command is called."""
    name = f"refused-{secrets.token_hex(8)}"
    write_scene(desk.folder, name, "exact", [random_mlp((3, 5, 2), 1.0, 1)])
    (BUILD / name).parent.mkdir(exist_ok=True)
    (BUILD / name).touch()
    try:
        desk.refuses(command, f"{name}.toml", says=f"{name}/.*: cannot be written: .*{name}: ")
    finally:
        (BUILD / name).unlink()
