"""What can be wrong with a scene, found in seconds: before a search that takes minutes.

Each function looks at one part and gives a finding for everything in it, what is right included.
``make train`` stops at the faults among ``before_training``.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from golden.network_files.network_file import FORMS, provenance_path, write_network
from golden.networks.mlp import Mlp
from golden.precision import SIGNAL
from golden.rig import readings
from golden.rig.finding import FAULT, NOTE, OK, WARNING, Finding, fault
from golden.rig.places import refusal
from golden.rig.recording import read_recording
from golden.scene import Scene, scene_names
from golden.scene.scale import on_readings
from golden.scene.vectors import Recorded, read_recorded
from golden.training.scaling import scaled


def before_training(scene: Scene, build: Path) -> list[Finding]:
    """Everything that a search needs."""
    return [
        *data(scene),
        *networks_writable(scene),
        *build_writable(scene, build),
        *design(scene, trained=False),
    ]


def everything(scene: Scene, build: Path) -> list[Finding]:
    """Everything about a scene but the tools."""
    networks = networks_there(scene)
    missing = any(finding.verdict != OK for finding in networks)
    return [
        Finding(OK, str(scene.path), _summary(scene)),
        *data(scene),
        *networks_writable(scene),
        *networks,
        *build_writable(scene, build),
        *design(scene, trained=not missing),
    ]


def _summary(scene: Scene) -> str:
    count = len(scene.members)
    networks = "one network" if count == 1 else f"{count} networks, {scene.arrangement}"
    return (
        f"{len(scene.sensors)} sensors, {len(scene.outputs)} outputs, {networks}; design "
        f"{scene.design}, {scene.activation_text}, {scene.precision.name} precision"
    )


def data(scene: Scene) -> list[Finding]:
    """The recordings: whether they can be read, and what they show."""
    try:
        read_recording(scene.data_path)
        rows = read_recorded(scene)
    except (FileNotFoundError, ValueError) as error:
        return [fault(error)]
    path = str(scene.data_path)
    few = readings.few_rows(path, len(rows.inputs))
    same = _constant(scene, rows)
    findings = [Finding(OK, path, f"{len(rows.inputs)} rows"), *few, *same]
    if same or any(finding.verdict == FAULT for finding in few):
        return findings
    try:
        scene = scaled(scene)
        vectors = scene.vectors()
    except ValueError as error:
        return [*findings, fault(error)]
    # Rows of another unit are as telling as those of signals.
    signals = np.concatenate([vectors.inputs, vectors.targets], axis=1)
    own = np.concatenate([rows.inputs, rows.targets], axis=1)
    for c, name in enumerate([*scene.sensors, *scene.outputs]):
        ends = SIGNAL.quantise([signals[:, c].min(), signals[:, c].max()], name)[0]
        text = f"{own[:, c].min():g} to {own[:, c].max():g}, codes {ends[0]} to {ends[1]}"
        findings.append(Finding(OK, name, text))
    findings += [fault(text, WARNING) for text in vectors.outside]
    for c, name in enumerate(scene.sensors):
        findings += readings.few_codes(name, vectors.inputs[:, c])
        findings += readings.at_an_end(name, rows.inputs[:, c])
    findings += readings.interpolated(path, rows.inputs)
    findings += readings.twins(path, [*scene.sensors, *scene.outputs], own)
    return findings


def _constant(scene: Scene, rows: Recorded) -> list[Finding]:
    findings = []
    for key, names, values in (
        ("sensors", scene.sensors, rows.inputs),
        ("outputs", scene.outputs, rows.targets),
    ):
        for name, column in zip(names, values.T, strict=True):
            if readings.constant(column):
                text = (
                    f"column {name!r}: got {column[0]:g} in every row, expected values that "
                    f"differ; take it out of data.{key} in {scene.path}"
                )
                findings.append(Finding(FAULT, str(scene.data_path), text))
    return findings


def networks_writable(scene: Scene) -> list[Finding]:
    """The files that training writes: their endings, and whether each can be written."""
    findings = []
    for path in scene.weights_paths:
        if path.suffix not in FORMS:
            text = f"got the ending {path.suffix!r}, expected one of {', '.join(FORMS)}"
            findings.append(Finding(FAULT, str(path), text))
            continue
        for file in (path, provenance_path(path)):
            refused = refusal(file)
            if refused:
                findings.append(Finding(FAULT, str(file), refused))
    if not findings:
        folders = ", ".join(sorted({str(path.parent) for path in scene.weights_paths}))
        findings.append(Finding(OK, folders, "networks can be written"))
    return findings


def networks_there(scene: Scene) -> list[Finding]:
    """The network files that are there: whether they fit the scene."""
    findings = []
    for member in scene.members:
        path = member.weights_path
        try:
            shape = member.load().shape
            findings.append(Finding(OK, str(path), "a {}:{}:{} network".format(*shape)))
        except FileNotFoundError:
            findings.append(Finding(NOTE, str(path), "not there yet; make train writes it"))
        except ValueError as error:
            findings.append(fault(error))
    return findings


def build_writable(scene: Scene, build: Path) -> list[Finding]:
    """The folder that exports, benches and searches write into."""
    folder = build / scene.name
    refused = refusal(folder / "file")
    if refused:
        return [Finding(FAULT, str(folder), refused)]
    findings = [Finding(OK, str(folder), "can be written")]
    if scene.name in scene_names() and scene.path.parent.name != scene.name:
        text = f"is the folder of the shipped scene {scene.name} too; give the file another name"
        findings.append(Finding(WARNING, str(folder), text))
    return findings


def design(scene: Scene, trained: bool) -> list[Finding]:
    """The hardware: of the networks where they are there, else of the least and the largest."""
    if trained:
        return _built(scene, "")
    try:
        scene = scaled(scene)
    except (FileNotFoundError, ValueError):
        return []  # A fault of the data, which is told there.
    low, high = scene.training.hidden
    findings = []
    for hidden, verdict in ((low, FAULT), (high, WARNING)):
        with _stand_in(scene, hidden) as other:
            sizes = [mlp.shape[1] for mlp in other.mlps()]
            found = _built(other, f"with {', '.join(map(str, sizes))} hidden nodes: ")
        wrong = [f for f in found if f.verdict == FAULT]
        if wrong:
            return [replace(f, verdict=verdict) for f in wrong]
        findings = found
    return findings


def _built(scene: Scene, before: str) -> list[Finding]:
    try:
        # What is said of weights is said of those that will come.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            core = scene.twin().core
    except (FileNotFoundError, ValueError) as error:
        return [fault(error)]
    facts = "; ".join(core.facts()) or f"clocks from frame to frame: {core.interval}"
    return [Finding(OK, f"hardware.design {scene.design}", f"{before}{facts}")]


@contextmanager
def _stand_in(scene: Scene, hidden: int) -> Iterator[Scene]:
    """The scene with small random networks in the place of those that are to be trained."""
    rng = np.random.default_rng(0)
    with TemporaryDirectory() as folder:
        members = []
        for number, member in enumerate(scene.members):
            nodes, outputs = member.hidden or hidden, len(member.outputs)
            shapes = ((nodes, member.inputs), nodes, (outputs, nodes), outputs)
            mlp = Mlp(*(rng.uniform(-0.5, 0.5, shape) for shape in shapes))
            path = Path(folder) / f"{number}.npz"
            write_network(path, on_readings(mlp, *scene.scales_of(number)))
            members.append(replace(member, weights_path=path))
        yield replace(scene, members=tuple(members))
