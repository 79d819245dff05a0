"""``make record``: record readings at known placements, in the form that ``make scene`` takes."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import islice
from pathlib import Path

import numpy as np

from golden.input_error import InputError, suggest
from golden.numbers.real import Real
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.files import same_file
from tactus.core.finding import fault, refuse
from tactus.core.table import read_csv_file
from tactus.monitor.board import Board, board_of
from tactus.monitor.csv_file import GrowingCsv, refuse_there
from tactus.monitor.line import Line, frames_from, open_line
from tactus.monitor.twin_board import TWIN, TwinBoard
from tactus.scene import Scene

# The first packets may still belong to the placement before: one in the board, one on the line.
SETTLE = 2

Placement = tuple[str, ...]


def asked_for(scene: Scene) -> list[str]:
    """The columns that say what a reading is of: the column of classes, or every output."""
    return [scene.classes] if scene.labels else list(scene.outputs)


def labels_of(path: Path, scene: Scene, simulated: bool) -> tuple[list[str], list[Placement]]:
    """The names of the outputs, and the placement in each row of a file of labels.

    A column holds numbers, or labels of which none is a number. An output of the scene holds
    numbers.

    scene: The scene whose sensors are read.
    simulated: Whether the board is simulated. Such a board can only be touched at placements of its
        recording.
    """
    table, known, found = read_csv_file(path), asked_for(scene), []
    placements = [tuple(cell.strip() for cell in row) for row in table.rows]
    for place, name in enumerate(table.names):
        column = table.column(name)
        labels = len(column.odd) == len(placements) and all(row[place] for row in placements)
        labels = labels and name not in scene.outputs
        if not labels and (text := column.fault(path)):
            found.append(fault(text))
    refuse(found)
    for number, name in enumerate(table.names, 1):
        if not name:
            found.append(fault(f"{path}: column {number} has no name, expected that of an output"))
        elif name in scene.sensors:
            text = f"got a sensor of {scene.path}, which is read, expected an output"
            found.append(fault(f"{path}: column {name!r}: {text}"))
        elif simulated and name not in known:
            text = (
                f"got no output of {scene.path}, expected one of {', '.join(known)}: a "
                "simulated board can only be touched at placements of its recording"
            )
            found.append(fault(f"{path}: column {name!r}: {text}{suggest(name, known)}"))
    refuse(found)
    return list(table.names), placements


def read_placement(line: str, outputs: Sequence[str], labelled: bool) -> Placement:
    """The label that was typed, or the values, separated by blanks or commas."""
    if labelled and "," in line:
        raise InputError(f"got {line!r}, expected one {outputs[0]}, without a comma")
    cells = (line,) if labelled else tuple(line.replace(",", " ").split())
    if len(cells) != len(outputs):
        raise InputError(f"got {len(cells)} values, expected {len(outputs)}: {', '.join(outputs)}")
    for name, cell in zip(outputs, cells, strict=True):
        with suppress(ValueError):
            if labelled or math.isfinite(float(cell)):
                continue
        raise InputError(f"{name}: got {cell!r}, expected a number")
    return cells


def asked(prompt: str) -> str | None:
    """A line that is typed; None at the end of the input."""
    # Without any input there is a RuntimeError.
    try:
        return input(prompt)
    except (EOFError, RuntimeError):
        return None


def typed(outputs: Sequence[str], labelled: bool) -> Iterator[Placement]:
    """The placements that are typed, until an empty line or the end of the input."""
    print(f"type {', '.join(outputs)} when a placement is there; an empty line ends the recording")
    while line := (asked("> ") or "").strip():
        try:
            placement = read_placement(line, outputs, labelled)
        except InputError as error:
            print(error)
            continue
        yield placement


def listed(outputs: Sequence[str], placements: Sequence[Placement]) -> Iterator[Placement]:
    """The placements of a list, each after the user has confirmed that it is there."""
    for number, placement in enumerate(placements, 1):
        told = ", ".join(f"{n} {cell}" for n, cell in zip(outputs, placement, strict=True))
        if asked(f"{number} of {len(placements)}: {told}; Enter when it is there ") is None:
            return
        yield placement


def touched(
    outputs: Sequence[str], placements: Sequence[Placement], board: TwinBoard
) -> Iterator[Placement]:
    """The placements of a list, at each of which a simulated board is touched."""
    for placement in placements:
        board.place(dict(zip(outputs, placement, strict=True)))
        yield placement


def gather(line: Line, board: Board, frames: int) -> Real:
    """The readings of the next frames, shape (frames, sensors)."""
    found = []
    for frame in islice(frames_from(line, board), SETTLE + frames):
        if "converter_error" in frame.flags:
            said = "converter_error: the converter is missing or stuck"
            raise InputError(f"PORT={line.label}: {said}")
        found.append(frame)
    return board.in_units(found[SETTLE:])[:, : len(board.scene.sensors)]


def record(
    line: Line,
    board: Board,
    placements: Iterator[Placement],
    csv: GrowingCsv,
    frames: int,
) -> Real:
    """Append a row for each placement: the means of its readings, and its values.

    Returns, shape (sensors,): The standard deviation of a reading within a placement.
    """
    spreads = []
    sensors = board.scene.sensors
    for placement in placements:
        readings = gather(line, board, frames)
        # The mean of many readings gets one more digit.
        cells = [
            f"{mean.round(d + 1) + 0:.{d + 1}f}"
            for mean, d in zip(readings.mean(axis=0), board.decimals, strict=False)
        ]
        csv.append([[*cells, *placement]])
        spreads.append(readings.var(axis=0))
        shown = ", ".join(f"{name} {cell}" for name, cell in zip(sensors, cells, strict=True))
        print(f"{csv.rows}: {shown}")
    return np.sqrt(np.mean(spreads, axis=0)) if spreads else np.zeros(len(sensors))


def main() -> None:
    arguments = arguments_of("record", __doc__)
    if not arguments.to:
        raise InputError("TO=: missing, expected a .csv file")
    board = board_of(arguments.scene)
    to = Path(arguments.to)
    refuse_there(to)
    outputs, placements = asked_for(board.scene), None
    if arguments.labels:
        labels = Path(arguments.labels)
        if same_file(labels, to):
            raise InputError(f"TO={to}: is read by this command, expected another file")
        outputs, placements = labels_of(labels, board.scene, arguments.port == TWIN)
    stop_if_dry_run(f"record readings from {arguments.port} into {to}")
    with (
        open_line(arguments.port, arguments.baud, board) as line,
        GrowingCsv(to, [*board.scene.sensors, *outputs]) as csv,
    ):
        interrupted = False
        if placements is None:
            source = typed(outputs, bool(board.scene.labels))
        elif isinstance(line, TwinBoard):
            source = touched(outputs, placements, line)
        else:
            source = listed(outputs, placements)
        try:
            spread = record(line, board, source, csv, arguments.frames)
        except KeyboardInterrupt:
            print()
            interrupted = True
            spread = np.zeros(len(board.scene.sensors))
        finally:
            if not csv.rows:
                to.unlink()
        if csv.rows:
            print(f"wrote {to}, {csv.rows} placements")
        if spread.any():
            worst = int(spread.argmax())
            print(
                f"noise of a reading: at most {spread[worst]:.2g} ({board.scene.sensors[worst]}); "
                f"of a mean of {arguments.frames} readings: "
                f"{spread[worst] / arguments.frames**0.5:.2g}"
            )
        if not csv.rows:
            why = "interrupted" if interrupted else "the input ended"
            raise InputError(f"TO={to}: not written: {why} before the first placement")
        # A recording that Ctrl-C ended is as long as was wanted.
        if placements and csv.rows < len(placements) and not interrupted:
            raise InputError(
                f"TO={to}: got {csv.rows} placements, expected {len(placements)}, those of "
                "LABELS=: the input ended before the others"
            )
