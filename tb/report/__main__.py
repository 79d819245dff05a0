"""``make report``: one HTML file about a scene, with every plot as SVG and number as CSV and JSON.

``build/<scene>/report.html`` opens without a network; ``build/<scene>/report`` beside it holds the
plots, a CSV for each table, and report.json with all of them. What has not changed since the last
report is not measured again.
"""

from __future__ import annotations

import argparse
import sys

from golden.cli import run, would
from tb.common.runner import ready_scene
from tb.report.page.build import build_report


def main() -> None:
    parser = argparse.ArgumentParser(prog="make report", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--full", action="store_true", help="the project's own tables too")
    arguments = parser.parse_args()
    scene = ready_scene(arguments.scene)
    would(f"simulate and measure scene {scene.name} and write its report")
    build_report(scene, arguments.full)


if __name__ == "__main__":
    sys.exit(run(main))
