"""``make report``: writes one HTML file about a scene, with all plots as SVG and tables as CSV.

``build/<scene>/report.html`` opens without a network connection. ``build/<scene>/report`` beside it
holds the plots, a CSV for each table, and report.json with all tables. What has not changed since
the last report is not measured again.
"""

import sys

from tactus.core.cli import run, stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.report.page.build import build_report
from tactus.verify.benches.runner import ready_scene


def main() -> None:
    arguments = arguments_of("report", __doc__)
    scene = ready_scene(arguments.scene)
    stop_if_dry_run(f"simulate and measure scene {scene.name} and write its report")
    with held([BUILD / scene.name]):
        build_report(scene)


if __name__ == "__main__":
    sys.exit(run(main))
