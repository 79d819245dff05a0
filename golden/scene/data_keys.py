"""The keys of a scene's section ``[data]``."""

from __future__ import annotations

from golden.scene.past import MOST_PAST
from golden.scene.scale import AUTO
from golden.schema import Alternatives, Key, List, Map, Number, Span, Table, Text, Whole

_COLUMNS = List(Text(some=True), "column names, each once", "a list of texts", once=True)
_ABOVE_0 = Map(Number(Span(above=0), "a number above 0"))
_FRAMES = "whole numbers of frames, such as [0, 4, 8]"
_DELAY = Whole(Span(0, MOST_PAST), f"delays from 0 to {MOST_PAST}")
_SCALE = f"{AUTO!r} or {{ offset = , factor = }}"
_SCALE_KEYS = {
    "offset": Key(Number(finite=True), 0.0, "the reading of code 0"),
    "factor": Key(Number(Span(above=0), finite=True), meaning="what full scale adds to it"),
}
_SCALES = Map(Alternatives((Text((AUTO,), said=_SCALE), Table(_SCALE_KEYS, said=_SCALE)), _SCALE))

DATA = Table(
    {
        "file": Key(
            Text(),
            "",
            "CSV with the recorded vectors; a scene has this key or the next",
        ),
        "recordings": Key(
            List(Text(), "names of files, each once", "a list of texts", once=True),
            [],
            "several such files, each a recording of its own: none goes on where another ends",
        ),
        "sensors": Key(
            _COLUMNS,
            meaning="columns of the samples, in the order in which they enter the hardware; at "
            "least one, each once",
        ),
        "outputs": Key(
            _COLUMNS,
            meaning="columns of the targets, in the order in which the outputs leave the hardware; "
            "at least one, each once",
        ),
        "group_by": Key(
            Text(),
            "",
            "column whose equal values form a position; the largest mean error is taken over "
            "positions (equation 3.15), or is the mean where there are none",
        ),
        "where": Key(
            Map(Number(finite=True)),
            {},
            "column name to a number: only rows with these values are used, `{ width = 0.225 }`; "
            "a CSV without such a row is refused",
        ),
        "window": Key(
            Alternatives((List(_DELAY, _FRAMES), Map(List(_DELAY, _FRAMES, _FRAMES)))),
            [0],
            "frames before the newest whose samples the networks take, `[0, 4, 8]` for every "
            "sensor or `{ sensor1 = [0, 4] }`, where a sensor that is not named has its newest "
            "sample alone; see [past samples](#past-samples)",
        ),
        "full_scale": Key(
            _ABOVE_0,
            {},
            "output name to a number above 0, in the output's unit, by which its error is "
            "divided; for any other output it is the target (equation 3.16)",
        ),
        "length_mm": Key(
            _ABOVE_0,
            {},
            "name of an output with a `full_scale` to what that is in millimetres; its errors are "
            "then shown in millimetres too",
        ),
        "scale": Key(
            Alternatives((_SCALES, Text((AUTO,), said=f"{AUTO!r} or a table of columns"))),
            {},
            'column name, sensor or output, to `{ offset = , factor = }` or `"auto"`; '
            '`scale = "auto"` alone is that for all of them. What the codes stand for, [in the '
            "unit of the column](formats.md#units); a column that is not named is in -1 to 1. For "
            "the sensors of a scene with a `front_end.converter` nothing need be written: see "
            "[what a converter reads](#what-a-converter-reads)",
        ),
        "units": Key(
            Map(Text(said="text, such as 'g'")),
            {},
            "column name, sensor or output, to the name of its unit, "
            '`{ load = "g" }`, for what is printed',
        ),
        "reference": Key(
            Text(),
            "",
            "table of `golden/data/thesis_numbers.toml`, written `digit.hybrid`, whose list "
            "`simulation`, one figure per output, `make demo` prints beside the errors",
        ),
    },
    name="a section",
)
