"""``make report``: writes one HTML file about a scene, with all plots as SVG and tables as CSV.

``build/<scene>/report.html`` opens without a network connection. ``build/<scene>/report`` beside it
holds the plots, a CSV for each table, and report.json with all tables.
"""

import dataclasses
import time

from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import check_writable, replace_file, replace_folder, write_json
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.machine import facts, versions
from tactus.core.progress import stage
from tactus.report.draw.svg import Picture
from tactus.report.page.content import Page, content
from tactus.scene import Scene
from tactus.verify.benches.runner import ready_scene
from tactus.verify.benches.tools import simulator_versions


def write(scene: Scene, page: Page) -> None:
    """Write the page, and the pictures and tables beside it.

    Each is written whole or not at all.
    """
    tables = {table.name: table for table in page.tables}
    pictures: dict[str, Picture] = {}
    for section in page.sections:
        for table in (*section.tables, *section.folded):
            tables[table.name] = table
        for picture in section.pictures:
            pictures[picture.name] = picture
    data = {
        "title": page.title,
        "built": list(page.built),
        "sections": {part.name: [*part.text, *part.points] for part in page.sections},
        "made": list(page.made),
        "pictures": {name: {"title": p.title, "says": p.sentence} for name, p in pictures.items()},
        "tables": {name: table.as_data() for name, table in tables.items()},
    }
    with replace_folder(BUILD / scene.name / "report") as folder:
        for name, picture in pictures.items():
            (folder / f"{name}.svg").write_text(picture.svg, encoding="utf-8")
        for name, table in tables.items():
            table.write_csv(folder / f"{name}.csv")
        write_json(folder / "report.json", data)
    with replace_file(BUILD / scene.name / "report.html") as path:
        path.write_text(page.render(), encoding="utf-8")


def made(seconds: float) -> list[str]:
    """The lines that say with which tools the report was made."""
    machine = facts(**versions("matplotlib"), **simulator_versions())
    return [
        f"Made by make report in {seconds:.0f} s on {machine['processor']}; "
        f"{machine['instructions']}; {machine['versions']}.",
        "Run times are those of this machine, which reproduces every other figure exactly. Another "
        "processor rounds last bits differently. That changes where trainings end, but nothing in "
        "the hardware. Each plot is an SVG and each table a CSV in the folder beside this file. "
        "report.json holds all of them.",
    ]


def main() -> None:
    arguments = arguments_of("report", __doc__)
    scene = ready_scene(arguments.scene)
    stop_if_dry_run(f"simulate and measure scene {scene.name} and write its report")
    with held([BUILD / scene.name]):
        build_report(scene)


def build_report(scene: Scene) -> Page:
    """Write the report, and return its page."""
    started = time.perf_counter()
    check_writable([BUILD / scene.name / "report.html"])
    with stage(f"{scene.name}: measuring and drawing the report"):
        page = content(scene)
    write(scene, dataclasses.replace(page, made=made(time.perf_counter() - started)))
    print(f"wrote {BUILD / scene.name / 'report.html'}")
    return page
