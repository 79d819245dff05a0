"""What stands in docs/limits.md of readings that no network was trained on."""

from __future__ import annotations

from tb.report.measure.table import Table


def rows(found: Table) -> str:
    """The recorded table, in tenths of a percent."""
    lines = [f"| {' | '.join(found.columns)} |", f"|{'---|' * len(found.columns)}"]
    for rig, frames, *figures in found.rows:
        cells = ["" if figure is None else f"{figure:.1f}" for figure in figures]
        lines.append(f"| {' | '.join([str(rig), str(frames), *cells])} |")
    return "\n".join(lines)
