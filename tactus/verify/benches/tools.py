"""The simulators: which package each needs, and which language each reads."""

import re
import shutil
import subprocess

from golden.input_error import InputError, suggest

# Simulator name to (program, Debian package, language).
SIMULATORS = {"ghdl": ("ghdl", "ghdl-llvm", "vhdl"), "icarus": ("iverilog", "iverilog", "verilog")}


def check_simulator(name: str) -> None:
    """Refuse an unknown simulator, or one that is not installed, and say what to do."""
    if name not in SIMULATORS:
        known = list(SIMULATORS)
        raise InputError(
            f"SIM={name}: no such simulator, expected one of {', '.join(known)}"
            f"{suggest(name, known)}"
        )
    program, package, _ = SIMULATORS[name]
    if shutil.which(program) is None:
        raise InputError(
            f"SIM={name}: {program} is not installed; on Debian: apt-get install {package}"
        )


def language(name: str) -> str:
    """The language whose export the simulator runs."""
    return SIMULATORS[name][2]


def version(name: str) -> str:
    """The first line that the simulator prints about itself."""
    flag = "--version" if name == "ghdl" else "-V"
    result = subprocess.run(
        [SIMULATORS[name][0], flag], capture_output=True, text=True, check=False
    )
    return result.stdout.splitlines()[0] if result.stdout else "unknown"


def simulator_versions() -> dict[str, str]:
    """The version number of each simulator by name, or ``none`` if it is not installed."""
    found = {}
    for name, (program, *_) in SIMULATORS.items():
        line = version(name) if shutil.which(program) else "none"
        number = re.search(r"\d+(\.\d+)+\S*", line)
        found[name] = number[0] if number else line
    return found
