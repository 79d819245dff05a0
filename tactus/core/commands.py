"""Every command of ``make``: its purpose, its variables, and the module that does the work.

This one table is the source of ``make help``, of the command ``tactus`` (``tactus.cli.console``),
of the table of commands in ``docs/README.md``, of the words that a module is called with and how it
reads them, and of what the tests know about commands. ``make help`` must work before anything is
installed, so this file imports nothing but the standard library.
"""

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tactus.core.cli import MOST_SEED, whole
from tactus.core.folders import BUILD


@dataclass(frozen=True)
class Argument:
    """A variable that a command of make accepts.

    name: The name of the variable, such as ``BLOCK``.
    example: What the help shows after ``=``.
    option: What precedes the value when the module is called, such as ``--block=``. It is empty if
        the value is a word by itself.
    flag: Whether the module is called with ``option`` alone, if the value is 1.
    default: The word if the variable is not set; None for no word.
    needed: Whether the command requires the variable.
    kind: Makes the value of an option from its text.
    start: The value of an option that is not given.
    """

    name: str
    example: str = ""
    option: str = ""
    flag: bool = False
    default: str | None = None
    needed: bool = False
    kind: Callable[[str], Any] = str
    start: Any = None

    @property
    def usage(self) -> str:
        """The variable as the help shows it, in brackets if it may be left out."""
        text = f"{self.name}={self.example}"
        return text if self.needed else f"[{text}]"

    def words(self, given: Mapping[str, str]) -> list[str]:
        """The words that the variable adds to the call of the module."""
        value = given.get(self.name)
        if self.flag:
            return [self.option] if value not in (None, "", "0") else []
        if self.option:
            return [f"{self.option}{value}"] if value else []
        word = self.default if value is None else value
        return [] if word is None else [word]

    def add(self, parser: argparse.ArgumentParser) -> None:
        """Let the parser of a module read those words."""
        if self.flag:
            parser.add_argument(self.option, action="store_true")
        elif self.option:
            parser.add_argument(self.option.rstrip("="), type=self.kind, default=self.start)
        else:
            missing = "?" if not (self.needed or self.default) else None
            parser.add_argument(self.name.lower(), nargs=missing, default=self.default)


def word(
    name: str, example: str = "", default: str | None = None, needed: bool = False
) -> Argument:
    """A variable whose value is a word by itself."""
    return Argument(name, example, default=default, needed=needed)


def option(
    name: str, example: str = "", kind: Callable[[str], Any] = str, start: Any = None
) -> Argument:
    """A variable whose ``NAME=x`` becomes ``--name=x``."""
    return Argument(name, example, f"--{name.lower()}=", kind=kind, start=start)


def number(name: str, least: int, most: int, start: int | None = None) -> Argument:
    """An option that is a whole number."""
    return option(name, kind=whole(name, least, most), start=start)


def flag(name: str) -> Argument:
    """A variable whose ``NAME=1`` becomes ``--name``."""
    return Argument(name, "1", f"--{name.lower()}", flag=True)


@dataclass(frozen=True)
class Command:
    """A command of make.

    name: The name of the target.
    purpose: One sentence that says what the command does.
    arguments: The variables, in the order in which the module takes them.
    module: The module that does the work. It is empty if the Makefile does it itself.
    last: Words that always end the call of the module.
    """

    name: str
    purpose: str
    arguments: tuple[Argument, ...] = ()
    module: str = ""
    last: tuple[str, ...] = ()

    @property
    def usage(self) -> str:
        """The command with all of its variables, the required ones first."""
        ordered = sorted(self.arguments, key=lambda argument: not argument.needed)
        return " ".join(["make", self.name, *(argument.usage for argument in ordered)])

    def words(self, given: Mapping[str, str]) -> list[str]:
        """The words after ``python`` for the variables ``given``.

        If a word looks like an option, ``--`` separates the options from the words, so that it is
        still read as a word.
        """
        options: list[str] = []
        words: list[str] = []
        for argument in self.arguments:
            (options if argument.option else words).extend(argument.words(given))
        words += self.last
        if any(word.startswith("-") for word in words):
            words.insert(0, "--")
        return ["-m", self.module, *options, *words]


SCENE = word("SCENE", default="digit")
# For these the command itself chooses a scene if none is given.
OPTIONAL_SCENE = word("SCENE")
# These commands would refuse scene digit, which has no board with a serial line, no engine that can
# be reloaded, and not one network for all outputs.
BOARD_SCENE = word("SCENE", default="digit-board")
RELOADED_SCENE = word("SCENE", default="digit-reload")
SINGLE_SCENE = word("SCENE", default="digit-single")
BLOCK = option("BLOCK")
SEED = number("SEED", 0, MOST_SEED, 1)
BAUD = number("BAUD", 300, 12_000_000)
PORT = word("PORT", "/dev/ttyUSB0", default="", needed=True)
HARDWARE = option("HARDWARE", "scene")
RECORD = flag("RECORD")
FORCE = flag("FORCE")
TESTS = option("TESTS", "tests/test_x.py")

COMMANDS = (
    Command(
        "demo",
        "Simulates every block of a scene, exports it and prints the table of its errors; without "
        "SCENE= it does so for scenes thesis and digit, and compares with the thesis.",
        (OPTIONAL_SCENE,),
        "tactus.cli.demo",
    ),
    Command(
        "test",
        "Runs the tests: all, those that TESTS= names, those that name the block of BLOCK=, or "
        "with PAGES=1 those of the documentation. ALL=1 adds what takes longer.",
        (TESTS, BLOCK, flag("PAGES"), flag("ALL")),
    ),
    Command(
        "sim",
        "Runs the benches of one block, or of every block of a scene. Without SCENE= a block is "
        "taken in the first case of its bench, and every block in scenes thesis and digit. SIM= "
        "names one simulator; without it both run. SEED= changes the random stimuli, FRAMES= says "
        "how many random frames there are, and how many recorded ones are played at least; "
        "WAVES=1 records waveforms. NETLIST= runs the benches on the mapped cells of a family, of "
        "each family (1), or on registers that are unknown until they are written; RECORD=1 then "
        "records the result.",
        (
            OPTIONAL_SCENE,
            BLOCK,
            option("SIM", "ghdl|icarus"),
            SEED,
            number("FRAMES", 1, 1_000_000),
            flag("WAVES"),
            option("NETLIST", "1|virtex-2|series-7|ecp5|ice40|unknown"),
            RECORD,
        ),
        "tactus.verify.sim",
    ),
    Command(
        "vhdl",
        "Exports a scene as VHDL to build/<scene>/vhdl; without SCENE= the scenes thesis and "
        "digit.",
        (OPTIONAL_SCENE,),
        "tactus.export",
        ("vhdl",),
    ),
    Command(
        "verilog",
        "Exports a scene as Verilog to build/<scene>/verilog; without SCENE= the scenes thesis and "
        "digit.",
        (OPTIONAL_SCENE,),
        "tactus.export",
        ("verilog",),
    ),
    Command(
        "scene",
        "Writes a scene for your own readings, and prints what the readings show. OUTPUTS= names "
        "the columns that the hardware computes; CLASSES= names a column of labels instead. "
        "HARDWARE= names the scene whose board took the readings, and NETWORK= a trained network "
        "that the scene is for.",
        (
            word("CSV", "readings.csv", default="", needed=True),
            word("OUTPUTS", "a,b", default=""),
            option("CLASSES", "gesture"),
            option("TO", "my-rig.toml", Path),
            HARDWARE,
            option("NETWORK", "net.onnx", Path),
        ),
        "tactus.cli.scene",
    ),
    Command(
        "check",
        "Checks a scene, and reports every fault that it finds. It takes seconds, or minutes where "
        "design auto compares large networks of learned functions.",
        (SCENE,),
        "tactus.verify.check",
    ),
    Command(
        "designs",
        "Prints within seconds what each design that can compute the networks of a scene costs, "
        "and marks those that no other one beats. FAMILY= names the family of the device.",
        (SCENE, option("FAMILY", "xc2v|ecp5")),
        "tactus.report.designs",
    ),
    Command(
        "train",
        "Trains the networks of a scene and writes them beside it.",
        (SCENE, FORCE),
        "tactus.cli.train",
    ),
    Command(
        "recalibrate",
        "Finds gain and offset of each sensor from readings at known placements, and writes a "
        "corrected copy of the scene to the folder TO= if the correction is sure to help. Without "
        "CSV= it prints the placements that are most informative. NOISE= is the noise of a "
        "reading, DRIFT= the expected drift of gain and offset.",
        (
            SCENE,
            word("CSV", "placements.csv", default=""),
            word("TO", "folder", default=""),
            option("NOISE", "0.002"),
            option("DRIFT", "0.05,0.02"),
            FORCE,
        ),
        "tactus.cli.recalibrate",
    ),
    Command(
        "predict",
        "Writes the outputs of the hardware for the new readings in CSV= to the file TO=, and "
        "marks the readings that are unlike any that the networks were trained on.",
        (
            SCENE,
            word("CSV", "new.csv", default="", needed=True),
            word("TO", "out.csv", default="", needed=True),
            FORCE,
        ),
        "tactus.cli.predict",
    ),
    Command(
        "network",
        "Writes a network of a scene as an .npz, .mat or .onnx file; OUTPUT= chooses the network "
        "if the scene has several.",
        (SINGLE_SCENE, word("TO", "file.onnx", default="", needed=True), option("OUTPUT"), FORCE),
        "tactus.cli.network",
    ),
    Command(
        "image",
        "Writes the image with which a reloadable engine runs the networks of a scene. "
        "HARDWARE= names the scene whose hardware runs it, if that is another one.",
        (RELOADED_SCENE, HARDWARE),
        "tactus.scene.image",
    ),
    Command(
        "monitor",
        "Shows in the browser what a board sends over the serial line PORT=; PORT=twin "
        "simulates a board. HARDWARE= names the scene that the board was built from, if "
        "that is another one. TO= names a CSV file for all that is received, and BAUD= the bits "
        "per second of the line, if they are not those of the scene. DRIFT= lets the sensors of a "
        "simulated board drift, with these standard deviations of gain and offset, and SEED= draws "
        "another drift.",
        (
            BOARD_SCENE,
            PORT,
            HARDWARE,
            option("TO", "all.csv", Path),
            BAUD,
            option("DRIFT", "0.03,0.02"),
            SEED,
        ),
        "tactus.monitor",
    ),
    Command(
        "record",
        "Records readings of a board at known placements, in the format that make scene reads. "
        "LABELS= names a CSV file of the placements; without it the command asks for each. FRAMES= "
        "is the number of readings at a placement, and BAUD= the bits per second of the line.",
        (
            BOARD_SCENE,
            PORT,
            word("TO", "readings.csv", default="", needed=True),
            option("LABELS", "placements.csv"),
            number("FRAMES", 1, 100_000, 16),
            BAUD,
        ),
        "tactus.monitor.record",
    ),
    Command(
        "load",
        "Sends the image of a scene to a board, and waits until it runs there. HARDWARE= names the "
        "scene that the board was built from, if that is another one, and BAUD= the bits per "
        "second of the line.",
        (BOARD_SCENE, PORT, HARDWARE, BAUD),
        "tactus.monitor.load",
    ),
    Command(
        "listing",
        "Prints the program of a scene's engine, step by step.",
        (SCENE,),
        "tactus.cli.listing",
    ),
    Command(
        "activations",
        "Measures the errors of every activation against tanh.",
        (),
        "tactus.report.activations",
    ),
    Command(
        "study",
        "Measures a finished study again and says what differs from what it found; RECORD=1 "
        "records the result.",
        (word("NAME", "beans", needed=True), RECORD),
    ),
    Command(
        "sensors",
        "Finds the best places of gauges on the beam that RIG= describes, and writes a picture and "
        "a table.",
        (word("RIG", "my-beam.toml", default="digit"),),
        "tactus.report.gauges",
    ),
    Command(
        "lean",
        "Prints what the hardware of a scene leaves out, and what that saves; BESIDE= names other "
        "scenes to compare with.",
        (SCENE, option("BESIDE", "other", start="")),
        "tactus.synth.lean",
    ),
    Command(
        "synth",
        "Counts the cells of every block of a scene and finds its highest clock, prints both "
        "beside the thesis, and compares them with the recorded figures. RECORD=1 records them "
        "anew.",
        (SCENE, RECORD),
        "tactus.synth",
    ),
    Command(
        "bitstream",
        "Writes a file to program a board with, and prints its resource use on the board's device. "
        "DEVICE= names another device that the board is sold with, and RECORD=1 records the "
        "resource use.",
        (
            BOARD_SCENE,
            word("BOARD", "ulx3s", default="", needed=True),
            option("DEVICE"),
            RECORD,
        ),
        "tactus.boards",
    ),
    Command(
        "prove",
        "With SCENE= proves, in both languages, that the export computes its network for every "
        "frame that can come in; several scenes stand in quotes. Otherwise proves properties of "
        "one block or of every block, shows that broken copies of a block violate them, and proves "
        "that VHDL and Verilog compute the same function. RECORD=1 records the results, THETA= "
        "puts these codes into an engine that learns, and HARDWARE= names the scene whose hardware "
        "runs the image of SCENE=.",
        (BLOCK, option("SCENE"), option("THETA"), HARDWARE, RECORD),
        "tactus.verify.prove",
    ),
    Command(
        "mutate",
        "Counts how many random faults (mutants) of a block its bench detects; SCENE= "
        "takes the entities of a scene, SEED= draws other mutants, and RECORD=1 records the "
        "result.",
        (BLOCK, option("SCENE"), RECORD, SEED),
        "tactus.verify.sign_off.mutate.score",
    ),
    Command(
        "certify",
        "Writes a folder that shows that the export of a scene computes its network: frames in "
        "both simulators, a proof for every frame, digests, and a script that checks all of it "
        "again without tactus. FRAMES= is the number of random frames, and RECORDED= that of "
        "recorded ones; without it, it is all.",
        (
            SCENE,
            number("FRAMES", 0, 100_000),
            SEED,
            number("RECORDED", 1, 100_000),
        ),
        "tactus.certify",
    ),
    Command(
        "report",
        "Writes one HTML file about a scene: errors, effects of noise, results of the verification "
        "and pictures.",
        (SCENE,),
        "tactus.report.page.build",
    ),
    Command(
        "docs",
        "Builds the documentation as a site; LINKS=1 follows the links to other sites too.",
        (flag("LINKS"),),
    ),
    Command("pages", "Rewrites the generated parts of the documentation."),
    Command("lint", "Runs ruff, import-linter and mypy."),
    Command("clean", "Removes build and .venv."),
)
BY_NAME = {command.name: command for command in COMMANDS}
# What make takes beside any target.
EVERYWHERE = ("DRY", "PYTHON", "SITE", "VENV")
CLOSING = (
    "DRY=1 beside a command checks all that it is given, prints what it would do, and does "
    "nothing. FORCE=1 replaces a file that the command does not recognise as its own."
)


def arguments_of(name: str, doc: str | None, *more: Argument) -> argparse.Namespace:
    """What a module is called with, as the table says.

    doc: The docstring of the module, for its help.
    more: What only its Python callers give.
    """
    parser = argparse.ArgumentParser(prog=f"make {name}", description=doc)
    for argument in (*BY_NAME[name].arguments, option("BUILD", kind=Path, start=BUILD), *more):
        argument.add(parser)
    return parser.parse_args()
