"""The keys of a scene's section ``[data]``."""

from tactus.core.schema import Alternatives, Key, KeyTable, List, Map, Number, Span, Text, Whole
from tactus.scene.past import MOST_PAST
from tactus.scene.scale import AUTO

_COLUMNS = List(Text(some=True), "column names, each once", "a list of texts", once=True)
_ABOVE_0 = Map(Number(Span(above=0), "a number above 0"))
_FRAMES = "whole numbers of frames, such as [0, 4, 8]"
_DELAY = Whole(Span(0, MOST_PAST), f"delays from 0 to {MOST_PAST}")
_SCALE = f"{AUTO!r} or {{ offset = , factor = }}"
_SCALE_KEYS = {
    "offset": Key(Number(finite=True), 0.0, "The reading that code 0 stands for."),
    "factor": Key(
        Number(Span(above=0), finite=True), meaning="What full scale adds to the reading of code 0."
    ),
}
_SCALES = Map(
    Alternatives((Text((AUTO,), said=_SCALE), KeyTable(_SCALE_KEYS, said=_SCALE)), _SCALE)
)

DATA = KeyTable(
    {
        "file": Key(
            Text(),
            "",
            "The CSV file with the recorded vectors. A scene has either this key or `recordings`.",
        ),
        "recordings": Key(
            List(Text(), "names of files, each once", "a list of texts", once=True),
            [],
            "Several CSV files, each of them a recording of its own: no file continues another.",
        ),
        "source": Key(
            Text(),
            "",
            "Where the data come from if they are not kept with the scene: a command or an "
            "address, and a digest. The message that there is no such file says it.",
        ),
        "sensors": Key(
            _COLUMNS,
            meaning="The columns of the samples, in the order in which they enter the hardware. "
            "There must be at least one, and each column is named once.",
        ),
        "outputs": Key(
            _COLUMNS,
            [],
            "The columns of the targets, in the order in which the outputs leave the "
            "hardware. There must be at least one, and each column is named once. A scene has "
            "either this key or `classes`.",
        ),
        "classes": Key(
            Text(some=True),
            "",
            "A column of labels, texts or whole numbers, which the network tells apart: it has an "
            "output for each label. See [classes](networks.md#classes).",
        ),
        "group_by": Key(
            Text(),
            "",
            "A column of numbers or texts; rows with the same value in it form a position. The "
            "largest mean error is the largest over the positions (equation 3.15). Without this "
            "key it is the mean of all rows.",
        ),
        "where": Key(
            Map(Alternatives((Number(finite=True), Text(some=True)))),
            {},
            "For each named column a number or a text, such as `{ width = 0.225 }` or "
            '`{ person = "anna" }`. Only rows with these values are used. '
            "A CSV file without such a row is refused.",
        ),
        "window": Key(
            Alternatives((List(_DELAY, _FRAMES), Map(List(_DELAY, _FRAMES, _FRAMES)))),
            [0],
            "The ages, in frames, of the samples that the networks take: `[0, 4, 8]` for every "
            "sensor, or `{ sensor1 = [0, 4] }` for some. For a sensor that is not named, the "
            "networks take only the newest sample. See [past samples](#past-samples).",
        ),
        "full_scale": Key(
            _ABOVE_0,
            {},
            "For each named output a number above 0, in the unit of the output. The error of the "
            "output is divided by it. The error of any other output is divided by the target "
            "(equation 3.16).",
        ),
        "length_mm": Key(
            _ABOVE_0,
            {},
            "For each named output with a `full_scale`, the length of this full scale in "
            "millimetres. The errors of the output are then also shown in millimetres.",
        ),
        "scale": Key(
            Alternatives((_SCALES, Text((AUTO,), said=f"{AUTO!r} or a table of columns"))),
            {},
            "For each named column of a sensor or an output, what its codes stand for [in the unit "
            'of the column](formats.md#units): `{ offset = , factor = }` or `"auto"`. '
            '`scale = "auto"` means "auto" for all columns. A column that is not named holds '
            "values from -1 to 1. Sensors of a scene with a `front_end.converter` need no scale "
            "here: see [what a converter reads](#what-a-converter-reads).",
        ),
        "units": Key(
            Map(Text(said="text, such as 'g'")),
            {},
            "For each named column of a sensor or an output, the name of its unit, such as "
            '`{ load = "g" }`. The name appears in what is printed.',
        ),
        "ends": Key(
            List(
                Number(finite=True),
                "a list of numbers, such as [0]",
                "a list of numbers",
                least=0,
            ),
            [],
            "The natural ends of the range of the sensors, such as `[0]` if they count something. "
            "If many readings lie at any other end, `make check` asks whether the range of a "
            "converter or an amplifier ends there.",
        ),
        "reference": Key(
            Text(),
            "",
            "A table of `scenes/data/thesis_numbers.toml`, such as `digit.hybrid`. `make demo` "
            "prints its list `simulation`, which has one figure for each output, beside the "
            "errors.",
        ),
    },
    name="a section",
)
