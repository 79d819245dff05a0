"""Links that leave ``docs/``: what they lead to becomes a page of the site.

The guides link to files as GitHub needs it, ``../golden/numbers/fixed.py``. Here such a link leads
to ``files/golden/numbers/fixed.py.html``, which shows the file.
"""

from pathlib import Path
from typing import Any

from docutils import nodes
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import get_lexer_by_name
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.transforms import SphinxTransform

ROOT = Path(__file__).resolve().parents[2]
LANGUAGES = {".md": "markdown", ".py": "python", ".toml": "toml"}
# The files that pages link to. The site is always built anew, so every page is read.
LINKED: set[str] = set()


class RepositoryLinks(SphinxTransform):
    """Mark links to what stands outside ``docs/``."""

    # Before MyST resolves its links and Sphinx copies what can be downloaded.
    default_priority = 5

    def apply(self, **_: Any) -> None:
        # The first page is the README of the repository, whose links start there.
        first = self.env.docname == self.config.root_doc
        folder = ROOT if first else Path(self.env.doc2path(self.env.docname)).parent
        links = [
            *self.document.findall(addnodes.download_reference),
            *self.document.findall(addnodes.pending_xref),
        ]
        for link in links:
            named = Path(link["reftarget"])
            # MyST names a page of Markdown by its whole path without the suffix.
            target = (folder / (f"{named}.md" if named.is_absolute() else named)).resolve()
            outside = target.is_relative_to(ROOT) and not target.is_relative_to(self.env.srcdir)
            if not outside or not target.is_file():
                continue
            path = target.relative_to(ROOT).as_posix()
            LINKED.add(path)
            link.replace_self(
                addnodes.pending_xref(
                    "",
                    *link.children,
                    refdomain=None,
                    reftype="repository",
                    reftarget=path,
                    refdoc=self.env.docname,
                )
            )


def resolve(
    app: Sphinx, env: BuildEnvironment, link: addnodes.pending_xref, content: nodes.Element
) -> nodes.Node | None:
    if link["reftype"] != "repository":
        return None
    uri = app.builder.get_relative_uri(link["refdoc"], f"files/{link['reftarget']}")
    return nodes.reference("", "", *link.children, internal=True, refuri=uri)


def write_pages(app: Sphinx, exception: Exception | None) -> None:
    """The pages of files, without the theme: that would double the time."""
    if exception or app.builder.format != "html":
        return
    for path in LINKED:
        text = (ROOT / path).read_text(encoding="utf-8")
        lexer = get_lexer_by_name(LANGUAGES.get(Path(path).suffix, "text"))
        page = app.outdir / "files" / f"{path}.html"
        page.parent.mkdir(parents=True, exist_ok=True)
        formatter = HtmlFormatter(full=True, title=path)
        page.write_text(highlight(text, lexer, formatter), encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_transform(RepositoryLinks)
    app.connect("missing-reference", resolve)
    app.connect("build-finished", write_pages)
    return {"parallel_read_safe": False, "parallel_write_safe": True}
