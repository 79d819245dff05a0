"""Commands with wrong arguments, or that cannot write, print one line and leave no files."""

import os
import secrets
import shlex
from pathlib import Path

import pytest
from refused import COMMANDS, Desk

from tactus.cli.commands import BY_NAME
from tactus.verify.benches.runner import BUILD
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

# Commands that need more than a scene, or none, and those that need no more.
MORE = ("network", "figures", "scene", "check", "predict", "bitstream")
SCENES = [n for n in COMMANDS if n not in MORE]
# Scenes that no command can read, and the message for each.
NAMES = {
    "finger": "scene 'finger': no such scene, expected a path to a .toml file or one of digit",
    "digit-singel": "scene 'digit-singel': no such scene, .* did you mean 'digit-single'?",
    "": "scene '': no such scene, expected a path",
    "/": "scene '/': no such scene, expected a path",
    "a\nb": r"scene 'a\nb': no such scene, expected a path",
    "no.toml": "scene 'no.toml': no such scene, expected a path",
    "mine.toml/a.toml": "mine.toml/a.toml: cannot be read: Not a directory",
    f"{'a' * 5000}.toml": "a.toml: cannot be read: File name too long",
    "a\0.toml": "cannot be read: embedded null byte",
    "folder.toml": "folder.toml: got a folder, expected a file",
    "loop.toml": "loop.toml: cannot be read: Too many levels of symbolic links",
    "device.toml": "device.toml: got no regular file, expected a file",
    "pipe.toml": "pipe.toml: got no regular file, expected a file",
    "latin.toml": "latin.toml: got the byte 0xe9 at 2, expected UTF-8 text",
    "binary.toml": "binary.toml: not TOML: ",
    "-x": "the following arguments are required: scene",
}
# Names of files for a network, and the message for each.
TARGETS = {
    "": ".: got the ending '', expected one of .npz, .mat, .onnx",
    "net.onx": "net.onx: got the ending '.onx', .* did you mean '.onnx'?",
    "pipe.npz": "pipe.npz: cannot be written: got no regular file, expected a file",
    "folder.npz": "folder.npz: cannot be written: got a folder, expected a file",
    "mine.toml/a.npz": "mine.toml/a.npz: cannot be written: mine.toml: File exists",
    f"{'a' * 5000}.npz": "a.npz: cannot be written: ",
    "a\0.npz": "cannot be written: embedded null byte",
}
# Calls, and the message for each.
CALLS = {
    "sim mine.toml --block engin": "BLOCK=engin: no such block; did you mean 'engine'?",
    "sim mine.toml --block ramp": "BLOCK=ramp: ramp is a part of load_profile; ask for",
    "sim mine.toml --block engine": (
        "BLOCK=engine: scene mine has no such block, .*; scene digit contains"
    ),
    "sim mine.toml --block axis_network": (
        "scene mine has no such block, .*; case axis-chain of its bench"
    ),
    "sim mine.toml --sim icaru": "SIM=icaru: no such simulator, .* did you mean 'icarus'?",
    "sim mine.toml --seed=-1": "SEED=-1: expected a whole number, 0 to 4294967295",
    "sim mine.toml --frames 0": "FRAMES=0: expected a whole number, 1 to 1000000",
    "bench mine.toml --frames 0": "FRAMES=0: expected a whole number, 1 to 10000000",
    "bench mine.toml --frame-rate 5": "unrecognized arguments: --frame-rate 5",
    "image mine.toml": "mine.toml: hardware.reload: got false, expected true, or HARDWARE=",
    "image mine.toml --hardware finger": "scene 'finger': no such scene, expected a path",
    "listing mine.toml": (
        "mine.toml: hardware.design: got hybrid, which has no program, expected engine"
    ),
    "lean mine.toml --beside finger": "scene 'finger': no such scene, expected a path",
    'lean mine.toml --beside "digit \'x"': "BESIDE=digit 'x: No closing quotation",
    "train mine.toml --cluster nowhere": "CLUSTER=nowhere: no scheduler answers: ",
    "certify mine.toml --parts 0": "PARTS=0: expected a whole number, 1 to 100000",
    "sim --netlist virtex": "NETLIST=virtex: no such netlist, expected one of 1, virtex-2",
    "sim --netlist 1 --sim ghdl": "netlists run in icarus alone",
    "sim --netlist ecp5 --record": "every family, expected NETLIST=1 or NETLIST=unknown",
    "sim --record": "RECORD=1: got no NETLIST, expected 1 or unknown",
    "mutate --record --seed 2": "RECORD=1: got SEED=2, expected none",
    f"prove --scene '{'finger ' * 50}'": "scene 'finger': no such scene, expected a path",
    "prove --scene 'mine.toml ./mine.toml'": "expected scenes of different hardware",
    "figures netwroks": "TABLE=netwroks: no such table, .* did you mean",
    **{
        f"image {scene} --hardware=digit-reload": f"{scene}.toml: data.window: got past samples, "
        "expected none: an image has no memory"
        for scene in ("swing-window", "swing-window-cascade")
    },
    "scene '' y0": "CSV=: missing, expected a file of readings",
    "scene . y0": ".: got a folder, expected a file",
    "scene no.csv y0": "no.csv: no such file",
    "scene mine.csv y0": "mine.toml: is there already; choose another name with TO=",
    "scene mine.csv 'a\nb' --to a.toml": r"OUTPUTS='a\nb': got no names between commas",
    "scene mine.csv y0 --to a.csv": "TO=a.csv: got the ending '.csv', expected .toml",
    "scene mine.csv y0 --to folder.toml": "folder.toml: cannot be written: got a folder",
    "predict mine.toml '' a.csv": "CSV=: missing, expected a .csv file",
    "predict mine.toml no.csv a.csv": "no.csv: no such file",
    "predict mine.toml mine.csv ./mine.csv": "TO=mine.csv: is read by this command, expected",
    "predict mine.toml mine.npz a.csv": "mine.npz:1: got byte 0x",
    "predict mine.toml mine.csv mine.provenance.toml": "is read by this command, expected another",
    "predict mine.toml mine.csv other.npz": "TO=other.npz: is there already",
    "predict mine.toml mine.csv none/a.csv": "TO=none/a.csv: got no folder none, expected one that",
    "network mine.toml mine.npz --force": "TO=mine.npz: is read by this command, expected another",
    "network mine.toml other.npz": "TO=other.npz: is there already",
    "designs mine.toml --picture other.svg": "PICTURE=other.svg: is there already",
    "recalibrate mine.toml mine.csv other": "TO=other/mine.npz: is there already",
    "check loop.toml": "loop.toml: 1 fault, listed above",
}
# What blocks the output of a command: the command, a file or a folder, and the message.
IN_THE_WAY = [
    ("train", "build", "build/store/training/.*0.jsonl: cannot be written: build"),
    ("train", "build/mine", "build/mine/report.html: cannot be written: build/mine"),
    ("train", "build/store/training", "0.jsonl: cannot be written: build/store/training"),
    ("train", "mine.npz/", "mine.npz: cannot be written: got a folder, expected a file"),
    ("train", "mine.provenance.toml/", "mine.provenance.toml: cannot be written: got a folder"),
    ("vhdl", "build", "build/mine/vhdl: cannot be written: build"),
    ("vhdl", "build/mine", "build/mine/vhdl: cannot be written: build/mine"),
    ("vhdl", "build/mine/vhdl", "build/mine/vhdl: cannot be written: got a file, expected a fold"),
    ("synth", "build", "build/mine/synth: cannot be written: build"),
    ("synth", "build/mine/synth", "build/mine/synth: cannot be written: got a file, expected"),
    ("image", "build", "build/loaded/image: cannot be written: build"),
    ("image", "build/loaded/image", "build/loaded/image: cannot be written: got a file, expect"),
    ("figures", "build", "build/figures: cannot be written: build"),
    ("figures", "build/figures", "build/figures: cannot be written: got a file, expected a fold"),
]


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
    (desk.folder / "latin.toml").write_bytes(b"# \xe9\n")
    (desk.folder / "binary.toml").write_bytes(bytes(99))
    return desk


@pytest.mark.parametrize(("name", "message"), NAMES.items(), ids=lambda text: ascii(text)[:30])
def test_a_name_is_refused(crowded: Desk, name: str, message: str) -> None:
    crowded.refuses("listing", name, says=message)


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
@pytest.mark.parametrize("command", [c for c in COMMANDS if c not in ("scene", "figures")])
def test_a_scene_like_an_option_is_a_scene(desk: Desk, command: str, name: str) -> None:
    """The command is called as make calls it, with the other values that it needs."""
    known = BY_NAME[command]
    given = {argument.name: argument.example for argument in known.arguments if argument.needed}
    words = known.words(given | {"SCENE": name})[2:]
    code, said = desk.call(command, *words[: len(words) - len(known.last)])
    assert code == 2
    if command == "check":
        assert said == f"error: {name}: 1 fault, listed above\n"
    else:
        assert said.startswith(f"error: scene {name!r}: no such scene, expected a path to a ")
        assert said.count("\n") == 1


@pytest.mark.parametrize(("name", "message"), TARGETS.items(), ids=lambda text: ascii(text)[:30])
def test_a_target_is_refused(crowded: Desk, name: str, message: str) -> None:
    crowded.refuses("network", "mine.toml", name, says=message)


@pytest.mark.parametrize(("words", "message"), CALLS.items(), ids=ascii)
def test_a_call_is_refused(crowded: Desk, words: str, message: str) -> None:
    crowded.refuses(*shlex.split(words), says=message)


@pytest.mark.parametrize("words", ["predict mine.toml mine.csv", "designs mine.toml --picture"])
def test_a_command_replaces_its_own_file_and_others_by_force(crowded: Desk, words: str) -> None:
    name = "other.svg" if "picture" in words else "other.csv"
    (crowded.folder / name).write_text("of the user", encoding="utf-8")
    crowded.refuses(*words.split(), name, says=f"{name}: is there already")
    assert crowded.call(*words.split(), name, "--force") == (0, "")
    assert crowded.call(*words.split(), name) == (0, "")


def test_training_replaces_only_its_own_networks(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
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


@pytest.mark.parametrize(("command", "name", "message"), IN_THE_WAY, ids=str)
def test_what_stands_in_the_way_is_named(desk: Desk, command: str, name: str, message: str) -> None:
    write_scene(
        desk.folder,
        "loaded",
        "exact",
        [random_mlp((3, 5, 2), 1.0, 1)],
        design="engine",
        activation="precise",
        hardware="reload = true",
    )
    path = desk.folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    if name.endswith("/"):
        path.unlink(missing_ok=True)
        path.mkdir()
    else:
        path.touch()
    words = {"image": ["loaded.toml"], "figures": ["networks"]}.get(command, ["mine.toml"])
    desk.refuses(command, *words, says=message)
    assert Path(name).exists()


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
