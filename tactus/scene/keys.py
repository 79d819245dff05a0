"""The keys of a scene, as ``keys.toml`` declares them, with what the program knows of their values.

Whoever adds a key writes it there; what is checked beyond that stands with the code of its section.
"""

from pathlib import Path

from golden.activation.schemes import SCHEMES
from golden.networks.arrangement import ARRANGEMENTS
from golden.networks.designs import DESIGNS
from golden.numbers.expression import ALLOWED
from golden.numbers.precision import PRECISIONS
from golden.sensing.converter_parts import PARTS
from golden.trained.dense import ACTIVATIONS
from golden.visualisation.load_profile import SHAPE_THRESHOLD
from tactus.core.schema import load_keys
from tactus.scene.training import INTERVALS
from tactus.sizing.choice import DEFAULT, DEVICES, UNDECIDED

SCENE = load_keys(
    Path(__file__).with_name("keys.toml"),
    activations=tuple(ACTIVATIONS),
    arrangements=ARRANGEMENTS,
    converters=tuple(PARTS),
    designs=(*DESIGNS, UNDECIDED),
    devices=tuple(DEVICES),
    precisions=tuple(PRECISIONS),
    schemes=tuple(SCHEMES),
)
# The keys of each section.
KEYS = {section: table["properties"] for section, table in SCENE["properties"].items()}
KEYS["network"]["functions"]["description"] += f" An expression holds {ALLOWED}."
KEYS["hardware"]["device"]["shown"] = f"`{DEFAULT}`"
KEYS["training"]["intervals"]["shown"] = str(INTERVALS)
KEYS["visualisation"]["shape_threshold"]["default"] = SHAPE_THRESHOLD
# The schema of SCENE for an editor, which finds it by the first line of a file that make scene has
# written. ``make pages`` writes it.
EDITOR_SCHEMA = Path(__file__).with_name("scene.schema.json")
