"""Determines the scales for ``data.scale = "auto"`` from the recordings, before training."""

from dataclasses import replace

from golden.input_error import InputError
from tactus.scene import Scene
from tactus.scene.scale import AUTO, range_scale
from tactus.scene.vectors import read_recorded
from tactus.train.descent.split import split_of


def scaled(scene: Scene) -> Scene:
    """The scene with a scale in the place of every "auto".

    The scale of a sensor comes from the rows that train, because nothing about the other rows is
    known beforehand. The scale of an output comes from all rows, because its range is required and
    not learnt. Sensors that a converter reads have the scale of its data sheet.
    """
    wanted = scene.auto
    kept = {n: s for n, s in scene.scale.items() if s != AUTO or n in wanted}
    known = kept | scene.converter_scales
    if not wanted:
        return scene if known == scene.scale else replace(scene, scale=known)
    rows = read_recorded(scene)
    training = split_of(scene).training
    columns = dict(zip(scene.sensors, rows.sensors[training].T, strict=True))
    columns |= dict(zip(scene.outputs, rows.targets.T, strict=True))
    found = known
    for name in wanted:
        try:
            found[name] = range_scale(columns[name])
        except InputError as error:
            raise InputError(
                f"{scene.data_text}: column {name!r}: {error}, for data.scale.{name} in "
                f"{scene.path}"
            ) from None
    return replace(scene, scale=found)
