"""A recording looked at as a whole: which columns are what, and what is to be said about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from golden.networks.mlp import Real
from golden.precision import SIGNAL
from golden.rig import readings
from golden.rig.finding import FAULT, NOTE, Finding, fault
from golden.rig.recording import Recording
from golden.table import suggest


@dataclass(frozen=True)
class Survey:
    """What a scene of a recording can be made of.

    Attributes
    ----------
    recording : Recording
    sensors, outputs : dict
        Columns by name, in the order of the file and in that of the user.
    left_out : dict
        Names of the other columns, and why they are no sensors.
    findings : list of Finding
    """

    recording: Recording
    sensors: dict[str, Real]
    outputs: dict[str, Real]
    left_out: dict[str, str]
    findings: list[Finding]

    @property
    def beyond(self) -> bool:
        """Whether anything lies outside the hardware's range, and so needs a scale."""
        columns = [*self.sensors.values(), *self.outputs.values()]
        return any(readings.beyond("", column) for column in columns)

    @property
    def interpolated(self) -> bool:
        """Whether rows lie between others, so that one that is held out has been seen."""
        return bool(readings.interpolated("", np.column_stack(list(self.sensors.values()))))

    def lines(self) -> list[str]:
        """A line for every column: what it is, from where to where."""
        wide = max(map(len, self.recording.names))
        shown = []
        for kind, columns in (("sensor", self.sensors), ("output", self.outputs)):
            for name, values in columns.items():
                different = len(np.unique(values))
                shown.append(
                    f"  {name:{wide}}  {kind:8}  {values.min():g} to {values.max():g}, "
                    f"{different} different values"
                )
        shown += [f"  {name:{wide}}  left out  {why}" for name, why in self.left_out.items()]
        return shown


def survey(recording: Recording, outputs: Sequence[str]) -> Survey:
    """Look at a recording whose outputs are named; its other columns of numbers are sensors."""
    path = str(recording.path)
    findings = [
        Finding(FAULT, path, f"no column {name!r}{suggest(name, recording.names)}")
        for name in outputs
        if name not in recording.names
    ]
    if not outputs or len(set(outputs)) < len(outputs):
        got = ",".join(outputs) or "none"
        known = ", ".join(name for name in recording.names if name)
        text = f"got {got}, expected each once some of the columns {known}"
        findings.append(Finding(FAULT, "OUTPUTS=", text))
    sensors: dict[str, Real] = {}
    targets: dict[str, Real] = {}
    left_out: dict[str, str] = {}
    for name in dict.fromkeys(n for n in outputs if n in recording.names):
        column = recording.column(name)
        wrong = column.fault(recording.path)
        if not wrong and readings.constant(column.values):
            wrong = f"{path}: output {name!r}: got {column.values[0]:g} in every row"
            wrong += ", expected values that differ"
        if wrong:
            findings.append(fault(wrong))
        else:
            targets[name] = column.values
    for number, name in enumerate(recording.names, start=1):
        if name in outputs:
            continue
        if not name:
            left_out[f"column {number}"] = "has no name"
            continue
        column = recording.column(name)
        if not column.numeric:
            left_out[name] = f"no numbers, line {column.odd[0][0]} holds {column.odd[0][1]!r}"
        elif column.odd:
            findings.append(fault(column.fault(recording.path)))
        else:
            why = _no_sensor(column.values, sensors, targets)
            if why:
                left_out[name] = why
            else:
                sensors[name] = column.values
    if not sensors and not findings:
        findings.append(Finding(FAULT, path, "no column is a sensor, expected at least one"))
    findings += readings.few_rows(path, len(recording.rows))
    if sensors:
        findings += readings.interpolated(path, np.column_stack(list(sensors.values())))
    found = Survey(recording, sensors, targets, left_out, findings)
    scaled = found.beyond
    for name, values in sensors.items():
        findings += readings.at_an_end(name, values)
        findings += [] if scaled else readings.few_codes(name, values)
    if scaled:
        findings.append(_beyond(path, found))
    findings += readings.odd_names(path, [*sensors, *targets])
    return found


def _no_sensor(values: Real, sensors: dict[str, Real], outputs: dict[str, Real]) -> str:
    """Why a column of numbers is no sensor; empty where it is one."""
    if readings.constant(values):
        return f"{values[0]:g} in every row"
    for name, others in (sensors | outputs).items():
        if readings.repeats(values, others):
            what = "output" if name in outputs else "sensor"
            return f"repeats the {what} {name!r}, perhaps in another unit"
    if readings.counts_rows(values):
        return "counts the rows"
    return ""


def _beyond(path: str, found: Survey) -> Finding:
    columns = found.sensors | found.outputs
    far = max(columns, key=lambda name: np.abs(columns[name]).max())
    text = (
        f"{far!r} reaches {columns[far][np.abs(columns[far]).argmax()]:g}, the hardware's codes "
        f"{SIGNAL.to_real(SIGNAL.low):g} to {SIGNAL.to_real(SIGNAL.high):.4g}: the scene scales "
        "every column"
    )
    return Finding(NOTE, path, text)
