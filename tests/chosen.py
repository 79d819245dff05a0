"""``make test``: runs pytest on all cores, for the named tests or for all."""

from __future__ import annotations

import argparse
import os
import sys

from machines import CORES

from golden.cli import run, whole, words, would

MOST_SECONDS = 86400


def main() -> None:
    parser = argparse.ArgumentParser(prog="make test", description=__doc__)
    parser.add_argument("--tests", default="", help="arguments of pytest, quoted as for a shell")
    parser.add_argument("--all", action="store_true", help="what ALL=1 adds, too")
    parser.add_argument("--sample", type=whole("SAMPLE", 1, MOST_SECONDS))
    parser.add_argument("--record", action="store_true", help="with ALL=1, how long its tests take")
    arguments = parser.parse_args()
    command = [sys.executable, "-m", "pytest", *CORES, *["--all"] * arguments.all]
    would(f"run {' '.join(['pytest', *words('TESTS', arguments.tests)])}")
    command += ["--record"] * arguments.record
    if arguments.sample:
        command += ["--sample", str(arguments.sample)]
    os.execv(sys.executable, [*command, *words("TESTS", arguments.tests)])


if __name__ == "__main__":
    sys.exit(run(main))
