"""Examines a recording before there is a scene: the role of each column, and what is wrong."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from golden.input_error import suggest
from golden.numbers.real import Real
from tactus.core.finding import FAULT, Finding, fault, faults
from tactus.core.table import Column, CsvFile
from tactus.rig import readings


@dataclass(frozen=True)
class Survey:
    """The parts of a recording from which a scene can be made.

    sensors, outputs: Columns by name: the sensors in the order of the file, the outputs in that of
        the user.
    classes: The column of labels, instead of outputs; empty if there is none.
    left_out: Names of the other columns, with the reasons why they are no sensors.
    """

    recording: CsvFile
    sensors: dict[str, Real]
    outputs: dict[str, Real]
    classes: str
    left_out: dict[str, str]
    findings: list[Finding]

    @property
    def beyond(self) -> bool:
        """Whether any value lies outside the hardware's range, so that a scale is needed."""
        columns = [*self.sensors.values(), *self.outputs.values()]
        return any(readings.beyond("", column) for column in columns)

    @property
    def interpolated(self) -> list[Finding]:
        """A finding if rows are interpolated, so that a held-out row would have been seen."""
        sensors = np.column_stack(list(self.sensors.values()))
        return readings.interpolated(str(self.recording.path), sensors)

    def lines(self) -> list[str]:
        """A line for every column: its role and its range."""
        wide = max(map(len, self.recording.names))
        shown = []
        for kind, columns in (("sensor", self.sensors), ("output", self.outputs)):
            for name, values in columns.items():
                different = len(np.unique(values))
                shown.append(
                    f"  {name:{wide}}  {kind:8}  {values.min():g} to {values.max():g}, "
                    f"{different} different values"
                )
        if self.classes and self.classes in self.recording.names:
            labels = set(labels_in(self.recording, self.classes))
            shown.append(f"  {self.classes:{wide}}  classes   {len(labels)} different labels")
        shown += [f"  {name:{wide}}  left out  {why}" for name, why in self.left_out.items()]
        return shown


def labels_in(recording: CsvFile, name: str) -> list[str]:
    at = recording.names.index(name)
    return [row[at].strip() for row in recording.rows]


def survey(recording: CsvFile, outputs: Sequence[str], classes: str = "") -> Survey:
    """Examine a recording; the columns of numbers that are not asked for are sensors.

    ``outputs`` are columns to be computed. Instead of them ``classes`` may name a column of labels.
    """
    named = [classes] if classes else outputs
    key = "CLASSES" if classes else "OUTPUTS"
    found = Survey(recording, {}, {}, classes, {}, _wrong_outputs(recording, named, key))
    for name in dict.fromkeys(name for name in outputs if name in recording.names):
        _take_output(found, recording.column(name))
    for number, name in enumerate(recording.names, start=1):
        if not name:
            found.left_out[f"column {number}"] = "has no name"
        elif name not in named:
            _take_other(found, recording.column(name))
    path = str(recording.path)
    if not found.sensors and not faults(found.findings):
        found.findings.append(Finding(FAULT, path, "no column is a sensor, expected at least one"))
    found.findings.extend(readings.few_rows(path, len(recording.rows)))
    if found.sensors:
        found.findings.extend(found.interpolated)
    return found


def _wrong_outputs(recording: CsvFile, outputs: Sequence[str], key: str) -> list[Finding]:
    """Find outputs that are no columns, or that are named more than once."""
    path, names = str(recording.path), recording.names
    findings = [
        Finding(FAULT, path, f"no column {name!r}{suggest(name, names)}")
        for name in outputs
        if name not in names
    ]
    if not outputs or len(set(outputs)) < len(outputs):
        got = ",".join(outputs) or "none"
        known = ", ".join(name for name in names if name)
        text = f"got {got}, expected each once some of the columns {known}"
        findings.append(Finding(FAULT, f"{key}=", text))
    return findings


def _take_output(found: Survey, column: Column) -> None:
    path = found.recording.path
    wrong = column.fault(path)
    if wrong and not column.numeric:
        wrong += f"; if these are labels, CLASSES={column.name} tells them apart"
    if not wrong and readings.constant(column.values):
        got = f"{column.values[0]:g} in every row"
        wrong = f"{path}: output {column.name!r}: got {got}, expected values that differ"
    if wrong:
        found.findings.append(fault(wrong))
    else:
        found.outputs[column.name] = column.values
        found.findings.extend(readings.perhaps_labels(column.name, column.values))


def _take_other(found: Survey, column: Column) -> None:
    """Classify a column that is no output: as a sensor, as left out, or as wrong."""
    if not column.numeric:
        line, text = column.odd[0]
        found.left_out[column.name] = f"no numbers, line {line} holds {text!r}"
    elif column.odd:
        found.findings.append(fault(column.fault(found.recording.path)))
    else:
        why = _no_sensor(column.values, found.sensors, found.outputs)
        if why:
            found.left_out[column.name] = why
        else:
            found.sensors[column.name] = column.values


def _no_sensor(values: Real, sensors: dict[str, Real], outputs: dict[str, Real]) -> str:
    """The reason why a column of numbers is no sensor; empty if it is one."""
    if readings.constant(values):
        return f"{values[0]:g} in every row"
    for name, others in (sensors | outputs).items():
        if readings.repeats(values, others):
            what = "output" if name in outputs else "sensor"
            return f"repeats the {what} {name!r}, perhaps in another unit"
    if readings.counts_rows(values):
        return "counts the rows"
    return ""
