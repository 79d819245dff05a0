"""``make report``: one HTML file about a scene, with every plot as SVG and number as CSV and JSON.

``build/<scene>/report.html`` opens without a network; ``build/<scene>/report`` beside it holds the
plots, a CSV for each table, and report.json with all of them. What has not changed since the last
report is not measured again.
"""

from __future__ import annotations

import argparse
import sys

from golden.cli import run
from golden.scene import load_scene
from tb.common.tools import SIMULATORS, check_simulator
from tb.report.build import build_report


def main() -> None:
    parser = argparse.ArgumentParser(prog="make report", description=__doc__)
    parser.add_argument("scene")
    scene = load_scene(parser.parse_args().scene)
    for simulator in SIMULATORS:
        check_simulator(simulator)
    scene.vectors()
    build_report(scene)


if __name__ == "__main__":
    sys.exit(run(main))
