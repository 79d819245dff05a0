"""Images of random networks, for the benches of engines that load their program."""

from golden.engine.image import Image
from golden.networks.engine import Engine
from tb.common.cases import random_mlp


def image_for(hardware: Engine, shape: tuple[int, int, int], seed: int) -> Image:
    """The image of a random network for an engine."""
    assert hardware.loaded, "no image can be loaded"
    sizes = hardware.loaded.sizes
    options = {
        "reload": True,
        "pipeline": "deep" if sizes.pipeline.memory_registers else "short",
        "segment_width": sizes.segment_width,
        "program_words": sizes.program_words,
        "operand_words": sizes.operand_words,
    }
    image = Engine.of_several("single", [random_mlp(shape, 1.0, seed)], hardware=options).loaded
    assert image
    return image
