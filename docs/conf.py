"""Settings of the documentation site: ``make docs``."""

import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# The modules that are documented are those beside this file, wherever else tactus is installed.
sys.path[:0] = [str(ROOT), str(Path(__file__).parent / "extensions")]

project = "tactus"
version = release = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]

extensions = [
    "myst_parser",
    "made",
    "repository_files",
]
exclude_patterns = ["extensions"]
# A link to a heading is written as GitHub writes it.
myst_heading_anchors = 3
# Equations, diagrams and what programs print stand in code blocks without a language.
highlight_language = "none"
# Quotes and dashes stay as they are written: they may be code.
smartquotes = False

html_theme = "furo"
html_title = "tactus"
html_copy_source = False
html_show_copyright = False
