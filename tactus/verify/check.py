"""``make check``: looks for everything that can be wrong with a scene, and prints each check."""

import shutil
from pathlib import Path

from golden.input_error import InputError
from tactus.core.commands import arguments_of
from tactus.core.finding import OK, WARNING, Finding, collect_faults, faults
from tactus.core.machine import versions
from tactus.core.progress import stage
from tactus.rig.check import everything
from tactus.scene import load_scene
from tactus.verify.benches.tools import SIMULATORS, version


def tools() -> list[Finding]:
    """Findings about the simulators, which training and export do not need."""
    found = versions("tactus", "python", "numpy", "scipy", "myhdl", "cocotb")
    text = ", ".join(f"{name} {number}" for name, number in found.items())
    findings = [Finding(OK, "versions", text)]
    for name, (program, package, _) in SIMULATORS.items():
        if shutil.which(program):
            findings.append(Finding(OK, program, version(name)))
        else:
            text = f"not installed, make sim and make demo need it; apt-get install {package}"
            findings.append(Finding(WARNING, program, text))
    return findings


def check(name: str, build: Path) -> list[Finding]:
    findings: list[Finding] = []
    with collect_faults(findings):
        findings += everything(load_scene(name), build)
    return findings + tools()


def main() -> None:
    arguments = arguments_of("check", __doc__)
    with stage(f"checking {arguments.scene}", quick=True):
        findings = check(arguments.scene, arguments.build)
    print("\n".join(map(str, findings)))
    wrong = len(faults(findings))
    if wrong:
        raise InputError(
            f"{arguments.scene}: {wrong} {'fault' if wrong == 1 else 'faults'}, listed above"
        )
