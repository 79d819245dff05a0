"""Commands with wrong arguments, or that cannot write, print one line and leave no files."""

import secrets

import pytest
from refused import COMMANDS, Desk

from tactus.core.commands import BY_NAME
from tactus.verify.benches.runner import BUILD
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

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
    words = known.words(given | {"SCENE": name})[2:]
    code, said = desk.call(command, *words[: len(words) - len(known.last)])
    assert code == 2
    if command == "check":
        assert said == f"error: {name}: 1 fault, listed above\n"
    else:
        assert said.startswith(f"error: scene {name!r}: no such scene, expected a path to a ")
        assert said.count("\n") == 1


@pytest.mark.parametrize("words", ["predict mine.toml mine.csv", "designs mine.toml --picture"])
def test_a_command_replaces_its_own_file_and_others_by_force(desk: Desk, words: str) -> None:
    name = "other.svg" if "picture" in words else "other.csv"
    (desk.folder / name).write_text("of the user", encoding="utf-8")
    desk.refuses(*words.split(), name, says=f"{name}: is there already")
    assert desk.call(*words.split(), name, "--force") == (0, "")
    assert desk.call(*words.split(), name) == (0, "")


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
