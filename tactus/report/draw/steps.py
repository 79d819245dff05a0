"""Animates a picture: it shows steps one after the other, with a style sheet alone."""

from collections.abc import Sequence

from tactus.report.draw.drawing import group, identifier, number

# Paper, and readers who ask for less motion, get only the step in the middle.
_STYLE = """\
.{name}-step{{visibility:hidden;animation:{name}-show {total}s step-end infinite}}
.{name}-still{{visibility:visible}}
@keyframes {name}-show{{0%{{visibility:visible}}{end}%,100%{{visibility:hidden}}}}
@media (prefers-reduced-motion:reduce){{.{name}-step{{animation:none}}}}
@media print{{.{name}-step{{animation:none}}}}
"""


def steps(kind: str, scene: str, seconds: float, bodies: Sequence[list[str]]) -> list[str]:
    """Elements that show one step at a time, again and again.

    kind, scene: Those of the picture; see ``identifier``.
    seconds: How long each step is shown.
    bodies: The elements of each step.
    """
    total, name = seconds * len(bodies), identifier(kind, scene)
    style = _STYLE.format(name=name, total=number(total), end=number(100 / len(bodies)))
    body = ["<style>", style, "</style>"]
    for n, step in enumerate(bodies):
        still = f" {name}-still" if n == len(bodies) // 2 else ""
        # Each step starts in the past, so that all run at once, each at its own point of the cycle.
        delay = f"animation-delay:{number(seconds * n - total)}s"
        body.append(group(step, class_=f"{name}-step{still}", style=delay))
    return body
