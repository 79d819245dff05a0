"""Writes into the pages what programs know, as the site is built: ``tactus.report.page.made``.

In the place of ``<!-- made: name -->`` stands the text of this name. Behind the hand-written part
of a block's page follow its ports, clocks, cells and sign-off.
"""

import re
import warnings

from sphinx.application import Sphinx

from golden.activation.pade import UnsettledWarning
from tactus.core.commands import CLOSING, COMMANDS
from tactus.report.measure.table import markdown
from tactus.report.page.blocks import sections
from tactus.report.page.made import MARK, made

FOLDER = "blocks/"
# Some cases of benches provoke it.
warnings.simplefilter("ignore", UnsettledWarning)


def commands() -> str:
    """Every command of make, with all of its variables."""
    rows = []
    for command in COMMANDS:
        # A text between < and > would be read as HTML.
        purpose = re.sub(r"\S*<\w+>[\w/]*", r"`\g<0>`", command.purpose)
        rows.append([f"`{command.usage.replace('|', ' or ')}`", purpose])
    lines = markdown("command | what it does", rows)
    return "\n".join([lines, "", CLOSING.replace("DRY=1", "`DRY=1`")])


def complete(app: Sphinx, page: str, source: list[str]) -> None:
    source[0] = MARK.sub(
        lambda mark: commands() if mark[1] == "commands" else made(mark[1]), source[0]
    )
    if page.startswith(FOLDER):
        source[0] += f"\n{sections()[page.removeprefix(FOLDER)]}\n"


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("source-read", complete)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
