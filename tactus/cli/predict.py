"""``make predict``: computes what a scene's hardware gives for new readings."""

from pathlib import Path

from golden.input_error import InputError
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.core.table import read_csv_file
from tactus.rig.predict import (
    Prediction,
    check_place,
    predict,
    readings_of,
    trained_on,
    write_prediction,
)
from tactus.scene import Scene, load_scene
from tactus.scene.labels import margins


def result_lines(scene: Scene, found: Prediction) -> list[str]:
    """The range of each output or, of classes, how many rows each has, and the least margin."""
    if scene.labels:
        by = margins(found.codes)
        counts = found.outputs.sum(axis=0).astype(int)
        rows = ", ".join(f"{n} {name}" for name, n in zip(scene.labels, counts, strict=True))
        return [f"{scene.classes}: {rows}", f"margins: {by.min()} to {by.max()} codes"]
    lines = []
    for name, values in zip(scene.outputs, found.outputs.T, strict=True):
        unit = f" {scene.units[name]}" if name in scene.units else ""
        lines.append(f"{name}: {values.min():g} to {values.max():g}{unit}")
    return lines


def main() -> None:
    arguments = arguments_of("predict", __doc__)
    for key, text in (("CSV", arguments.csv), ("TO", arguments.to)):
        if not text:
            raise InputError(f"{key}=: missing, expected a .csv file")
    scene = load_scene(arguments.scene)
    source, path = Path(arguments.csv), Path(arguments.to)
    check_place(scene, source, path, arguments.force)
    recording = read_csv_file(source)
    readings = readings_of(scene, recording)
    past = scene.window.past
    if len(readings) <= past:
        raise InputError(
            f"{source}: got {len(readings)} rows, expected more than the {past} that data.window "
            f"of {scene.path} reaches back"
        )
    stop_if_dry_run(f"write {path}")
    known, which = trained_on(scene)
    found = predict(scene, readings, known)
    write_prediction(scene, recording, found, path)
    print("\n".join([*result_lines(scene, found), *found.ranges]))
    outside = sum(map(bool, found.reasons))
    if past:
        print(f"the first {past} of {len(readings)} rows have no whole past and no outputs")
    print(f"{outside} of {len(found.reasons)} rows are outside {which}")
    print(
        f"about 1 in {known.one_in} rows like the recorded ones is called outside, too: the limit "
        f"is that of {known.held} held-out rows"
    )
    print(f"wrote {path}")
