"""Every design and option that a scene can name is certified once, and no step is red.

``make test ALL=1 TESTS=tests/test_certified.py`` certifies all of them, and ``-rA`` prints what the
steps of each found: the colours, and beside them what was found where a step is not green.
"""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from golden.activation.schemes import SCHEMES
from golden.networks.designs import DESIGNS
from tactus.certify.__main__ import certify
from tactus.certify.benches import STEP as BENCHES
from tactus.certify.delivered import CELLS, STEPS, CertifyOptions
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of

# One frame of each kind is played, and the bench of one entity: properties, equality and the proof
# of every frame, which hang on options most, are about all of the design in any case.
FEW = CertifyOptions(frames=1, seed=1, recorded=1, parts=1)
ONE = "least-lanes"
# Cases of the benches, and combinations that no bench has. Options that do not touch each other
# share a row.
NAMES = (
    # Engines: with a program of their own, or one that is loaded.
    *("least-engine", "exact-engine", "tables-engine", "learned-chain", "winner-past"),
    *("layers-serial", "tables-serial", "deep-reload", "lesson"),
    # Engines of several multipliers.
    *("deep-loop", "chain-lanes", "three-lanes", "layers-lanes", "tables-lanes", "winner-loop"),
    # As the reference folds networks, and everything at once.
    *("wide-thesis", "gradient_parallel-thesis", "lut-thesis", "pade-thesis", "polynomial-exact"),
    *("block-ram", "three", "slow-cascade", "few-past"),
    *("wide-parallel", "pade-parallel", "precise-parallel"),
    # A frame a clock.
    *("narrow-graph", "argmax-tables"),
    # What may stand around a network.
    *("axis-past", "axis-cascade", "winner-axis", "past-instrument", "winner-instrument"),
    *("drawn-winner", "wide-converter", "signed-converter", "winner-converter"),
    *("plain-uart", "drawn-uart", "wide-uart", "learn-uart"),
)
ROWS = {name: CASES[name] for name in NAMES} | {
    "clocks-three": replace(CASES["three-engine"], hardware="clocks = 4000"),
    "deep-layers": replace(CASES["layers-engine"], hardware='pipeline = "deep"'),
    "blocks-reload": replace(
        CASES["tables-reload"], hardware="reload = true\ntable_blocks = 3\nprogram_words = 2048"
    ),
    "blocks-lanes-reload": replace(
        CASES["tables-lanes-reload"],
        hardware="lanes = 2\nreload = true\noperand_words = 256\nsegment_width = 12"
        '\npipeline = "deep"\ntable_blocks = 4\nprogram_words = 4096',
    ),
    "serial-axis": replace(CASES["axis-past"], hardware="lanes = 0"),
    "loop-axis": replace(CASES["axis-past"], hardware="lanes = 2\ninterval = 30"),
    "lanes-drawn": replace(
        CASES["drawn-past"],
        hardware="lanes = 2",
        sections=f"{CASES['drawn-past'].sections}\n[front_end]\ncounter_width = 7\n",
    ),
    "lanes-uart": replace(
        CASES["wide-converter"],
        hardware="clock_mhz = 12.0\nlanes = 2\nargmax = true",
        sections=f"{CASES['wide-converter'].sections}\n[uart]\n",
    ),
    **{
        f"{activation}-row": replace(CASES["pade-parallel"], activation=activation)
        for activation in ("gradient_parallel", "lut", "polynomial")
    },
    "winner-reload-uart": replace(
        CASES["reload-uart"], hardware="clock_mhz = 4.0\nreload = true\nargmax = true"
    ),
    "options-graph": replace(
        CASES["three-graph"],
        hardware="search_runs = 2\nadders_per_clock = 1\nadder_operands = 3",
    ),
    "logic-deep-graph": replace(CASES["deep-graph"], options=CASES["logic-graph"].options),
    "options-tables": replace(
        CASES["two-tables"],
        hardware=f"{CASES['two-tables'].hardware}\nadders_per_clock = 1\nadder_operands = 3",
    ),
}


@pytest.mark.all_only
@pytest.mark.parametrize("row", [ONE, *ROWS])
def test_no_step_is_red(row: str, tmp_path: Path) -> None:
    scene = scene_of((ROWS | {ONE: CASES[ONE]})[row], tmp_path, row)
    wanted = replace(FEW, frames=1 + scene.twin().past)
    results = certify(scene, wanted, tmp_path)
    print(f"{row}:", ", ".join(f"{result.step} {result.colour}" for result in results))
    for result in results:
        if result.colour != "green":
            print(f"    {result.colour}: {result.step}: {result.figure}")
    assert [result.step for result in results] == [*(s for s in STEPS if s != CELLS), BENCHES]
    assert "red" not in {result.colour for result in results}
    page = (tmp_path / row / "certificate" / "certificate.md").read_text(encoding="utf-8")
    assert not re.findall("^- red.*", page, re.M)


@pytest.mark.parametrize("name", DESIGNS)
def test_every_option_of_a_design_has_a_row(name: str) -> None:
    design = DESIGNS[name]
    scenes = [
        f"{row.arrangement} {row.activation} {row.precision} {row.interface} {row.hardware} "
        f"{row.sections}"
        for row in ROWS.values()
        if row.design == name
    ]
    activations = design.known_activations or [one for one in SCHEMES if one != "bipartite"]
    words = [*design.arrangements, *design.precisions, *design.options, *activations]
    if name in ("engine", "hybrid"):
        words += ["axi_stream", "[front_end]", "converter", "[uart]", "[visualisation]", "argmax"]
    assert [word for word in words if not any(word in scene for scene in scenes)] == []
