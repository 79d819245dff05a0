"""The image of a scene, for its own hardware or for that of another."""

from __future__ import annotations

from golden.engine.image import Image
from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.scene.scene import Scene


def scene_image(scene: Scene, hardware: Engine) -> Image:
    """What makes ``hardware`` run a scene.

    Parameters
    ----------
    scene : Scene
        Whatever its design: its networks matter, and that they see no past.
    hardware : Engine
        One that can be reloaded.

    Raises
    ------
    InputError
        See ``load_network``; also for past samples, for an arithmetic that the engine has not, and
        for an image that does not fit.
    """
    if hardware.loaded is None:
        raise InputError(f"{hardware.entity}: hardware.reload: got false, expected true")
    if not scene.window.plain:
        raise InputError(
            f"{scene.path}: data.window: got past samples, expected none for an image: what keeps "
            "the past is no part of it"
        )
    for key, got, known in (
        ("precision", scene.precision.name, Engine.precisions),
        ("activation", scene.activation, Engine.known_activations),
    ):
        if got not in known:
            raise InputError(
                f"{scene.path}: hardware.{key}: got {got!r}, expected {' or '.join(known)} for an "
                "image"
            )
    sizes = hardware.loaded.sizes
    options = {
        "reload": True,
        "pipeline": "deep" if sizes.pipeline.memory_registers else "short",
        "segment_width": sizes.segment_width,
        "program_words": sizes.program_words,
        "operand_words": sizes.operand_words,
    }
    try:
        made = Engine.of_several(scene.arrangement, scene.networks(), hardware=options)
    except InputError as error:
        raise InputError(f"{scene.path}: {error}") from None
    assert made.loaded is not None, "an engine with reload holds an image"
    return made.loaded
