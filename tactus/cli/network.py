"""``make network``: writes a network of a scene as .npz, .mat or .onnx."""

from pathlib import Path

from golden.input_error import InputError, suggest
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import check_output
from tactus.network_files.network_file import form_of, write_network
from tactus.scene import Scene, SceneNetwork, load_scene


def member_of(scene: Scene, output: str | None) -> SceneNetwork:
    """The network that computes ``output``, which may be None if the scene has one network."""
    if output is None and len(scene.members) == 1:
        return scene.members[0]
    for member in scene.members:
        if output in member.outputs:
            return member
    raise InputError(
        f"OUTPUT={output or ''}: scene {scene.name} has {len(scene.members)} networks, expected "
        f"one of {', '.join(scene.outputs)}{suggest(output or '', scene.outputs)}"
    )


def main() -> None:
    arguments = arguments_of("network", __doc__)
    scene, file = load_scene(arguments.scene), Path(arguments.to)
    network = member_of(scene, arguments.output).load()
    form_of(file)
    check_output(file, scene.own_files, force=arguments.force)
    stop_if_dry_run(f"write {file}")
    write_network(file, network)
    print(f"wrote {file}, {':'.join(str(n) for n in network.shape)}")
