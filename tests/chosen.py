"""``make test``: runs pytest on all cores, for named tests, for those of a block, or for all."""

import argparse
import os
import sys
from pathlib import Path

from tactus.core.cli import run, stop_if_dry_run, words
from tactus.verify.benches.blocks import check_name

CORES = ("-n", "logical", "--dist", "worksteal")


def files_of_pages() -> list[str]:
    """The files that hold tests of the documentation: to collect the others takes longer."""
    files = sorted(Path(__file__).parent.glob("test_*.py"))
    marked = [file for file in files if "mark.pages" in file.read_text(encoding="utf-8")]
    return [f"tests/{file.name}" for file in marked]


def main() -> int:
    parser = argparse.ArgumentParser(prog="make test", description=__doc__)
    parser.add_argument("--tests", default="", help="arguments of pytest, quoted as for a shell")
    parser.add_argument("--block", help="tests that name a block, or files that do")
    parser.add_argument("--pages", action="store_true", help="the tests of the documentation")
    parser.add_argument("--all", action="store_true", help="what ALL=1 adds, too")
    arguments = parser.parse_args()
    command = [sys.executable, "-m", "pytest", *CORES, *["--all"] * arguments.all]
    chosen = words("TESTS", arguments.tests)
    if arguments.block is not None:
        check_name(arguments.block)
        # The site takes longer than all others of a block; make docs builds it.
        chosen += ["-k", f"{arguments.block} and not test_site"]
    if arguments.pages:
        chosen += ["-m", "pages", *([] if arguments.tests else files_of_pages())]
    stop_if_dry_run(f"run {' '.join(['pytest', *chosen])}")
    return os.execv(sys.executable, [*command, *chosen])


if __name__ == "__main__":
    sys.exit(run(main))
