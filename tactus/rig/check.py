"""Checks that find in seconds what is wrong with a scene, before a search that takes minutes.

Each function checks one part and returns a finding for everything in it, also for what is right.
``make train`` stops at the faults among ``before_training``.
"""

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from golden.trained.function import by_name
from golden.trained.function_network import of_parabolas
from tactus.core import store
from tactus.core.files import check_writable
from tactus.core.finding import (
    FAULT,
    NOTE,
    OK,
    WARNING,
    Finding,
    collect_faults,
    fault,
    faults,
    several,
)
from tactus.core.folders import is_installed
from tactus.core.table import read_csv_file
from tactus.network_files.network_file import check_targets, held_in, write_network
from tactus.network_files.parsed import stand_for_order
from tactus.rig import readings, sensors_tell
from tactus.scene import Scene, scene_names
from tactus.scene.codes import quantised_lines, range_lines, saturating
from tactus.scene.scale import on_readings, signals
from tactus.scene.vectors import Recorded, read_recorded
from tactus.train.search import random_layers
from tactus.train.split import scaled, split_of

# With more rows in the largest class than so many times those in the smallest, a network may name
# the largest too often.
UNEQUAL = 3


def before_training(scene: Scene, build: Path) -> list[Finding]:
    """All checks that a search needs."""
    return _once(
        *data(scene),
        *networks_writable(scene),
        *build_writable(scene, build),
        *design(scene, trained=False),
    )


def everything(scene: Scene, build: Path) -> list[Finding]:
    """All checks of a scene, except those of the tools."""
    networks = networks_there(scene)
    missing = any(finding.verdict != OK for finding in networks)
    shown = data(scene)
    installed = "belongs to the installed package, so train cannot write its networks"
    return _once(
        Finding(OK, str(scene.path), _summary(scene, trained=not missing)),
        *shown,
        *([] if faults(shown) else sensors_tell.findings(scaled(scene))),
        *(
            [Finding(NOTE, str(scene.path), installed)]
            if is_installed(scene.path)
            else networks_writable(scene)
        ),
        *networks,
        *build_writable(scene, build),
        *design(scene, trained=not missing),
    )


def _once(*findings: Finding) -> list[Finding]:
    """Remove findings that two functions have both found."""
    return list(dict.fromkeys(findings))


def _summary(scene: Scene, trained: bool) -> str:
    # Until a network is there, and can be read, its activations are those that the scene names.
    activation = scene.activation_text
    with suppress(InputError):
        activation = scene.hidden_text() if trained else activation
    count = len(scene.members)
    networks = "one network" if count == 1 else f"{count} networks, {scene.arrangement}"
    return (
        f"{len(scene.sensors)} sensors, {len(scene.outputs)} outputs, {networks}; design "
        f"{scene.design}, {activation}, {scene.precision.name} precision"
    )


def data(scene: Scene) -> list[Finding]:
    """Check the recordings: whether they can be read, and what they show."""
    path = scene.data_text
    findings: list[Finding] = []
    with collect_faults(findings):
        for file in scene.data_paths:
            read_csv_file(file)
        rows = read_recorded(scene)
        without = f"; {rows.without_past} without a whole past are not used"
        text = f"{len(rows.inputs)} rows{without if rows.without_past else ''}"
        findings.append(Finding(OK, path, text))
        findings += readings.few_rows(path, len(rows.inputs))
        # With only one or two rows every column looks constant.
        findings += [] if faults(findings) else _constant(scene, rows)
        if not faults(findings):
            scene = scaled(scene)
            findings += classes(scene)
            findings += _converter(scene)
            border = len(rows.inputs) - split_of(scene).count
            if border:
                text = f"{border} rows share samples with rows of another part and are in none"
                findings.append(Finding(OK, "training.split", text))
            findings += _columns(scene, rows)
    return findings


def classes(scene: Scene) -> list[Finding]:
    """What the numbers of rows of each class spoil; nothing if outputs are numbers."""
    if not scene.labels:
        return []
    wanted, split = read_recorded(scene).targets, split_of(scene)
    parts = (wanted, *(wanted[rows] for rows in (split.training, split.test)))
    rows, trains, held = (part.sum(axis=0).astype(int) for part in parts)
    counts = ", ".join(f"{n} of {label!r}" for n, label in zip(rows, scene.labels, strict=True))
    subject = f"data.classes {scene.classes}"
    found = [Finding(OK, subject, f"rows: {counts}")]
    none_trains = [label for label, n in zip(scene.labels, trains, strict=True) if not n]
    if none_trains:
        text = (
            f"no row of {several(none_trains)} trains, expected one or more of each class; record "
            "more rows, or change training.split or training.seed"
        )
        found.append(Finding(FAULT, subject, text))
    once = [label for label, n in zip(scene.labels, rows, strict=True) if n == 1]
    if once:
        text = f"{several(once)} stands in a single row, which cannot both train and test"
        found.append(Finding(WARNING, subject, text))
    unseen = [label for label, n in zip(scene.labels, held, strict=True) if not n]
    if unseen:
        text = f"no row of {several(unseen)} is held out: the errors say nothing about it"
        found.append(Finding(WARNING, subject, text))
    if rows.max() > UNEQUAL * rows.min():
        text = (
            f"classes are unequal: who always said {scene.labels[int(rows.argmax())]!r} would be "
            f"right in {100 * rows.max() / rows.sum():.0f} % of the rows"
        )
        found.append(Finding(WARNING, subject, text))
    return found


def _columns(scene: Scene, rows: Recorded) -> list[Finding]:
    path, vectors = scene.data_text, scene.vectors()
    findings = []
    sensors = signals(rows.sensors, scene.scales(scene.sensors))
    as_signals = np.concatenate([sensors, vectors.targets], axis=1)
    own = np.concatenate([rows.sensors, rows.targets], axis=1)
    for c, name in enumerate([*scene.sensors, *([] if scene.labels else scene.outputs)]):
        ends = SIGNAL.quantise([as_signals[:, c].min(), as_signals[:, c].max()], name)[0]
        text = f"{own[:, c].min():g} to {own[:, c].max():g}, codes {ends[0]} to {ends[1]}"
        findings += [Finding(OK, name, text), *readings.few_codes(name, as_signals[:, c])]
    findings += [fault(text, WARNING) for text in vectors.outside]
    columns = dict(zip(scene.sensors, rows.sensors.T, strict=True))
    findings += readings.at_ends(columns, scene.ends)
    if scene.training.split == "random":
        findings += readings.interpolated(path, rows.sensors)
    # Of two classes, each is always what the other is not.
    compared = scene.sensors if scene.labels else (*scene.sensors, *scene.outputs)
    findings += readings.twins(path, compared, own)
    return findings


def _converter(scene: Scene) -> list[Finding]:
    """Describe the range of the scene's converter, which its data sheet determines."""
    if not (scene.front_end and scene.front_end.converter):
        return []
    scale = scene.scales(scene.sensors)[0]
    low, high = scale.offset - scale.factor, scale.offset + scale.factor
    text = f"reads each sensor from {low:g} to below {high:g}"
    return [Finding(OK, f"front_end.converter {scene.front_end.converter}", text)]


def _constant(scene: Scene, rows: Recorded) -> list[Finding]:
    findings = []
    for key, names, values in (
        ("sensors", scene.sensors, rows.sensors),
        ("outputs", scene.outputs, rows.targets),
    ):
        for name, column in zip(names, values.T, strict=True):
            if readings.constant(column):
                text = (
                    f"column {name!r}: got {column[0]:g} in every row, expected values that "
                    f"differ; take it out of data.{key} in {scene.path}"
                )
                findings.append(Finding(FAULT, scene.data_text, text))
    return findings


def networks_writable(scene: Scene) -> list[Finding]:
    """Check the files that training writes: their endings, and whether they can be written."""
    findings: list[Finding] = []
    for path in scene.weights_paths:
        with collect_faults(findings):
            check_targets([path])
    if not findings:
        folders = ", ".join(sorted({str(path.parent) for path in scene.network_files}))
        findings.append(Finding(OK, folders, "networks can be written"))
    return findings


def networks_there(scene: Scene) -> list[Finding]:
    """Check the network files that exist: whether they fit the scene."""
    findings: list[Finding] = []
    for member in scene.members:
        path = member.weights_path
        with collect_faults(findings):
            try:
                shape = ":".join(map(str, member.load().shape))
                ending = _ending(path, member.labels)
                findings.append(Finding(OK, str(path), f"a {shape} network{ending}"))
            except FileNotFoundError:
                findings.append(Finding(NOTE, str(path), "not there yet; make train writes it"))
    return findings


def _ending(path: Path, labels: Sequence[str]) -> str:
    """What a classifier's file has behind the network, and for which labels it stands, in words."""
    held = held_in(path)
    if held.ending is None:
        return ""
    text, found = f" that ends in front of {held.ending.operator}", held.labels
    if not found:
        return text
    text += f"; its classes are {', '.join(found)}"
    if labels and stand_for_order(found, labels):
        text += f", which are taken for {', '.join(labels)} in this order"
    return text


def build_writable(scene: Scene, build: Path) -> list[Finding]:
    """Check the folders into which exports, benches, searches and reports write."""
    folder = build / scene.name
    findings: list[Finding] = []
    with collect_faults(findings):
        check_writable([store.store(build) / "training" / "search" / "0.jsonl"])
        check_writable([folder / "report.html"])
        findings.append(Finding(OK, str(folder), "can be written"))
    if scene.name in scene_names() and scene.path.parent.name != scene.name:
        text = f"is the folder of the shipped scene {scene.name} too; give the file another name"
        findings.append(Finding(WARNING, str(folder), text))
    return findings


def design(scene: Scene, trained: bool) -> list[Finding]:
    """Check the hardware with the trained networks or, without them, with the least and largest."""
    if trained:
        return [*_built(scene, ""), *_recorded_frames(scene)]
    unknown: list[Finding] = []
    with collect_faults(unknown):
        scene = scaled(scene)
    if unknown:
        return []  # It is a fault of the data, and is reported with the data.
    low, high = scene.training.hidden
    fewest, most = scene.training.layers or (1, 1)
    findings: list[Finding] = []
    for hidden, verdict in (((low,) * fewest, FAULT), ((high,) * most, WARNING)):
        findings, before = [], ""
        with _stand_in(scene, hidden) as other:
            with collect_faults(findings):
                sizes = ", ".join(":".join(map(str, n.shape[1:-1])) for n in other.networks())
                before = f"with {sizes or 0} hidden nodes: "
                findings += _built(other, before)
            findings = [_of_own_files(one, scene, other) for one in findings]
        if faults(findings):
            return [
                replace(one, verdict=verdict, text=f"{before}{one.text}")
                if one.verdict == FAULT
                else one
                for one in findings
            ]
    return findings


def _of_own_files(finding: Finding, scene: Scene, other: Scene) -> Finding:
    """A finding about stand-ins, with the names of the networks that they stand for."""
    subject, text = finding.subject, finding.text
    for own, stand_in in zip(scene.weights_paths, other.weights_paths, strict=True):
        subject, text = (one.replace(str(stand_in), str(own)) for one in (subject, text))
    return replace(finding, subject=subject, text=text)


def _built(scene: Scene, before: str) -> list[Finding]:
    findings: list[Finding] = []
    # Warnings about weights do not matter here, because training will find others and warn of them.
    with collect_faults(findings), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        core = scene.twin().core
        facts = "; ".join(core.facts()) or f"clocks from frame to frame: {core.interval}"
        place = f"hardware.design {scene.design}"
        findings.append(Finding(OK, place, f"{before}{facts}"))
        chosen = scene.choice.lines() if scene.choice else []
        findings += [Finding(OK, place, f"{before}{line}") for line in chosen]
    if scene.front_end:
        findings.append(Finding(OK, "front_end", scene.front_end.describe()))
        if not scene.front_end.rate_hz and not scene.window.plain:
            text = "got none, expected the rate of the rows, as data.window counts scans"
            findings.append(Finding(WARNING, "front_end.rate_hz", text))
    return findings


def _recorded_frames(scene: Scene) -> list[Finding]:
    """Tell how quantised networks differ from their files, ranges of layers, and what saturates."""
    findings: list[Finding] = []
    with collect_faults(findings):
        lines = quantised_lines(scene)
        lines += range_lines(scene, scene.twin().core.saturations(scene.vectors().codes))
        findings += [Finding(OK, f"hardware.design {scene.design}", line) for line in lines]
        findings += [Finding(WARNING, str(scene.path), text) for text in saturating(scene)]
    return findings


@contextmanager
def _stand_in(scene: Scene, hidden: tuple[int, ...]) -> Iterator[Scene]:
    """The scene with small random networks in place of those that are still to be trained.

    Where training searches, they have the nodes ``hidden`` in their hidden layers.
    """
    settings = scene.training
    rng = np.random.default_rng(0)
    with TemporaryDirectory() as folder:
        members = []
        for number, member in enumerate(scene.members):
            hiddens = member.layers or (member.hidden,) * (member.hidden > 0)
            if not hiddens and (settings.layers or settings.functions or not scene.labels):
                hiddens = hidden
            widths = (member.inputs, *hiddens, len(member.outputs))
            path = Path(folder) / f"{number}.npz"
            scales = scene.scales_of(number)
            members.append(replace(member, weights_path=path))
            if settings.functions:
                bent = of_parabolas(widths, member.inputs - scene.members[0].inputs)
                write_network(path, on_readings(bent.layers(), *scales))
                continue
            kinds = member.activations or (settings.activation,) * len(hiddens)
            network = random_layers(widths, kinds, rng, by_name(member.functions))
            write_network(path, on_readings(network, *scales))
        options = scene.design_options
        if "search_runs" in options:
            # Thousands of runs for random weights take minutes and tell nothing more.
            options = {**options, "search_runs": 1}
        yield replace(scene, members=tuple(members), design_options=options)
