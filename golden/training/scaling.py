"""``data.scale = "auto"``: worked out from the recordings, before training."""

from __future__ import annotations

from dataclasses import replace

from golden.scene import Scene
from golden.scene.scale import AUTO, range_scale
from golden.scene.vectors import read_recorded
from golden.training.split import split_of


def scaled(scene: Scene) -> Scene:
    """The scene with a scale in place of every "auto".

    A sensor's is that of the rows that train: of the others nothing is known beforehand. An
    output's is that of all rows, because its range is what is asked for and is not learnt.

    Raises
    ------
    FileNotFoundError, ValueError
        See ``read_recorded``, ``split_of`` and ``range_scale``.
    """
    wanted = [name for name, scale in scene.scale.items() if scale == AUTO]
    if not wanted:
        return scene
    rows = read_recorded(scene)
    training = split_of(scene).training
    columns = dict(zip(scene.sensors, rows.sensors[training].T, strict=True))
    columns |= dict(zip(scene.outputs, rows.targets.T, strict=True))
    found = dict(scene.scale)
    for name in wanted:
        try:
            found[name] = range_scale(columns[name])
        except ValueError as error:
            raise ValueError(
                f"{scene.data_text}: column {name!r}: {error}, for data.scale.{name} in "
                f"{scene.path}"
            ) from None
    return replace(scene, scale=found)
