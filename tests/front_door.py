"""The variables that the Makefile accepts from a user."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
# A user may set these on the command line or in the environment.
GIVEN = re.sub(r"\\\n", "", MAKEFILE).partition("GIVEN := ")[2].splitlines()[0].split()
