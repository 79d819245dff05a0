"""Directive ``package-modules``: the docstrings of every module of a package."""

from __future__ import annotations

import pkgutil
from importlib import import_module
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

ROOT = Path(__file__).resolve().parents[2]


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


def shorten(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, signature: str | None, returned: Any
) -> tuple[str, Any] | None:
    """Defaults that are paths stand relative to the repository, wherever the site is built."""
    return signature and (signature.replace(f"PosixPath('{ROOT}/", "Path('"), returned)


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("package-modules", PackageModules)
    app.connect("autodoc-process-signature", shorten)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
