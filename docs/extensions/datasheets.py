"""What programs know of a block stands behind the hand-written part of its datasheet.

Ports and clocks are those that the twins publish, cells and sign-off those that are recorded. They
are written when the site is built, so no page that is committed can be out of date.
"""

from pathlib import Path

from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment

from tb.report.page.blocks import sections

FOLDER = "blocks"


def compute(app: Sphinx) -> None:
    there = (Path(app.srcdir) / FOLDER).is_dir()
    app.config.datasheet_sections = sections() if there else {}


def complete(app: Sphinx, page: str, source: list[str]) -> None:
    folder, _, name = page.rpartition("/")
    if folder == FOLDER:
        source[0] += f"\n{app.config.datasheet_sections[name]}\n"


def outdated(app: Sphinx, env: BuildEnvironment, *_: set[str]) -> list[str]:
    """Records may have changed though the page has not."""
    return [page for page in env.found_docs if page.startswith(f"{FOLDER}/")]


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_config_value("datasheet_sections", {}, "")
    app.connect("builder-inited", compute)
    app.connect("env-get-outdated", outdated)
    app.connect("source-read", complete)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
