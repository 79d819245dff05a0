"""The text of docs/limits.md on readings that are unlike those of the training."""

from tb.report.measure.table import Table


def rows(found: Table) -> str:
    """The rows of the recorded table, rounded to tenths of a percent."""
    lines = [f"| {' | '.join(found.columns)} |", f"|{'---|' * len(found.columns)}"]
    for rig, frames, *figures in found.rows:
        cells = ["" if figure is None else f"{figure:.1f}" for figure in figures]
        lines.append(f"| {' | '.join([str(rig), str(frames), *cells])} |")
    return "\n".join(lines)
