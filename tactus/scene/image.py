"""The image of a scene, for its own hardware or for that of another scene."""

from golden.engine.image import Image
from golden.input_error import InputError
from golden.networks.engine import Engine
from tactus.scene.scene import Scene


def scene_image(scene: Scene, hardware: Engine) -> Image:
    """The image with which ``hardware`` runs a scene.

    scene: It may have any design, but must use no past samples; only its networks enter the image.
    hardware: An engine that can be reloaded.
    """
    if hardware.loaded is None:
        raise InputError(f"{hardware.entity}: hardware.reload: got false, expected true")
    if not scene.window.plain:
        raise InputError(
            f"{scene.path}: data.window: got past samples, expected none: an image has no memory "
            "for past samples"
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
    try:
        return hardware.image_for(scene.networks(), scene.arrangement, scene.settings().met)
    except InputError as error:
        raise InputError(f"{scene.path}: {error}") from None
