"""The mapped cells of a family, on which the Verilog test bench plays the frames."""

from pathlib import Path

from tactus.verify.benches.runner import Job
from tactus.verify.sign_off.cell_models import models_for
from tactus.verify.sign_off.netlist import CELLS, MODELS, cells_of


def write_cells(top: Job, family: str, folder: Path) -> None:
    """Write ``cells/<family>`` below a folder: the top's netlist and the models of its cells."""
    place = folder / "cells" / family
    place.mkdir(parents=True)
    found = cells_of(top, family)
    for entity, text in found.items():
        (place / f"{entity}.v").write_text(text, encoding="utf-8")
    models = models_for(CELLS[family], "".join(found.values()))
    (place / MODELS).write_text(models, encoding="utf-8")
