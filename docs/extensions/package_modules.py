"""The reference: a page for each package, with the docstrings of its modules.

The pages are written when the site is built, into ``api`` beside its index: a new package needs no
page of its own. Each holds the directive ``package-modules``, which this defines.
"""

import pkgutil
import re
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from docutils import nodes
from numpy.typing import ArrayLike
from sphinx.application import Sphinx
from sphinx.config import Config
from sphinx.util.docutils import SphinxDirective
from sphinx.util.typing import stringify_annotation

from golden.numbers.fixed import Codes
from golden.numbers.real import Real

FIELD = re.compile(r"((?:Returns|Warns with|[*a-z_])[^:]*): (?=\S)")
ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("golden", "hdl", "tactus", "tb")
SHORT = {
    f"PosixPath('{ROOT}/": "Path('",
    stringify_annotation(ArrayLike, "smart"): "ArrayLike",
    stringify_annotation(Codes, "smart"): "Codes",
    stringify_annotation(Real, "smart"): "Real",
}


class PackageModules(SphinxDirective):
    """A section for each module, with a link to its file.

    Packages inside the package have pages of their own. ``__main__`` is a command, which has no
    caller.
    """

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        package = import_module(self.arguments[0])
        lines = [package.__doc__ or "", ""]
        for found in pkgutil.iter_modules(package.__path__):
            if found.ispkg or found.name == "__main__":
                continue
            name = f"{package.__name__}.{found.name}"
            path = f"{name.replace('.', '/')}.py"
            lines += [
                found.name,
                "-" * len(found.name),
                "",
                f":download:`{path} <../../{path}>`",
                "",
                f".. automodule:: {name}",
                "   :members:",
                "   :show-inheritance:",
                "",
            ]
        return self.parse_text_to_nodes("\n".join(lines), allow_section_headings=True)


def packages() -> list[str]:
    """Every package of the rooms that can be imported here."""
    folders = [path.parent for room in ROOMS for path in (ROOT / room).rglob("__init__.py")]
    return sorted(".".join(folder.relative_to(ROOT).parts) for folder in folders)


def write_pages(app: Sphinx, config: Config) -> None:
    """A page for each package, where the source has a folder for them."""
    folder = Path(app.srcdir) / "api"
    if not folder.is_dir():
        return
    for name in packages():
        text = f"{name}\n{'=' * len(name)}\n\n.. package-modules:: {name}\n"
        page = folder / f"{name}.rst"
        # What has not changed keeps its time, so Sphinx does not read it again.
        if not page.is_file() or page.read_text(encoding="utf-8") != text:
            page.write_text(text, encoding="utf-8")
    for page in folder.glob("*.rst"):
        if page.stem not in (*packages(), "index"):
            page.unlink()


def shorten(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, signature: str | None, returned: Any
) -> tuple[str, Any] | None:
    """Paths stand relative to the repository, and arrays have the names of the code."""
    if not signature:
        return None
    for full, short in SHORT.items():
        signature, returned = (
            signature.replace(full, short),
            returned and returned.replace(full, short),
        )
    return signature, returned


def skip_defaults(
    app: Sphinx, what: str, name: str, obj: Any, skip: bool, options: Any
) -> bool | None:
    """Defaults that are numbers of numpy bring a docstring of their own."""
    return True if isinstance(obj, np.generic) else None


def mark_fields(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """``name: meaning`` becomes a field, where all first lines of a paragraph begin with names."""
    start = 0
    for end in range(len(lines) + 1):
        if end < len(lines) and lines[end].strip():
            continue
        first = [n for n in range(start, end) if not lines[n].startswith(" ")]
        if first and first[0] == start and all(FIELD.match(lines[n]) for n in first):
            for n in first:
                lines[n] = FIELD.sub(lambda found: f":{found[1].replace('*', '')}: ", lines[n], 1)
        start = end + 1


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("package-modules", PackageModules)
    app.connect("config-inited", write_pages)
    app.connect("autodoc-process-docstring", mark_fields)
    app.connect("autodoc-process-signature", shorten)
    app.connect("autodoc-skip-member", skip_defaults)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
