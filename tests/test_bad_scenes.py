"""An invalid scene is refused by a line with file, key, the value and what was expected."""

from pathlib import Path

import pytest
from refused import Desk

from tactus.core.finding import faults
from tactus.verify.check import check

LONG = "1" * 400
TEXT = "expected text"
COLUMNS = "expected column names, each once"
NUMBER = "expected a number"
HIDDEN = "expected the least and the largest number of hidden nodes"
OPTIONS = "activation_options = {}"
CASCADE = 'arrangement = "cascade"\nweights = ["a.npz", "b.npz"]'
PARALLEL = f'{CASCADE}\n\n[hardware]\ndesign = "parallel"'

# A text of the scene, and its replacements with the message for each.
TABLE: dict[str, dict[str, str]] = {
    'file = "mine.csv"': {
        "file = 5": f"data.file: got 5, {TEXT}",
        "file = []": f"data.file: got [], {TEXT}",
        "file = 1979-05-27": "data.file: got datetime.date(1979, 5, 27), expected",
        'file = ""': "data.file: got '', expected the name of a file",
        r'file = "a\u0000b"': r"data.file: got 'a\x00b', expected the name",
        'file = "a': "not TOML: Illegal character",
        'file = "mine.csv"\nfile = "a"': "not TOML: Cannot overwrite a value",
        'fiel = "mine.csv"': "data: key 'fiel' is not known, .* did you mean 'file'?",
    },
    'sensors = ["x0", "x1", "x2"]': {
        'sensors = "x0"': "data.sensors: got 'x0', expected a list",
        "sensors = {}": "data.sensors: got {}, expected a list",
        "sensors = []": f"data.sensors: got [], {COLUMNS}",
        "sensors = [1]": f"data.sensors: got [1], {COLUMNS}",
        'sensors = ["x0"]': "mine.npz: w1: got shape (5, 3), expected (5, 1)",
        'sensors = ["y0", "x1", "x2"]': "data.outputs: got 'y0', a sensor, expected columns",
    },
    'outputs = ["y0", "y1"]': {
        'outputs = ["x0", "y1"]': "data.outputs: got 'x0', a sensor, expected columns",
        'outputs = ["y0"]': "mine.npz: w2: got shape (2, 5), expected (1, 5)",
    },
    'group_by = "y0"': {
        "where = 5": "data.where: got 5, expected a table",
        "where = { x0 = true }": f"data.where.x0: got true, {NUMBER}",
        "where = { x0 = 1e999 }": f"data.where.x0: got inf, {NUMBER}",
        f"where = {{ x0 = {LONG} }}": "data.where.x0: got a number of 1326 bits, expected 64",
        "full_scale = { y9 = 1 }": "data.full_scale: 'y9' is no output, expected one of y0, y1",
        f"full_scale = {{ y0 = -{LONG} }}": "data.full_scale.y0: got a number of 1326 bits",
        "length_mm = { y0 = 1 }": "data.length_mm: 'y0' is no output with a full_scale",
        'reference = "digit"': "data.reference: got 'digit', expected a table of thesis_numbers",
        'reference = "digit.hybrid"': "with 2 simulation figures",
    },
    'arrangement = "single"': {
        'arrangement = "cascad"': "network.arrangement: got 'cascad', .* did you mean 'cascade'?",
    },
    "hidden = 5": {
        "hidden = -1": "network.hidden: got -1, expected 0 to 1024",
        "hidden = 1000000000000": "network.hidden: got 1000000000000, expected 0 to 1024",
        "hidden = true": "network.hidden: got true, expected a whole number",
        "hidden = 5.0": "network.hidden: got 5.0, expected a whole number",
        "hidden = []": "network.hidden: got [], expected one: single has one for all outputs",
        "hidden = [0]": "network.hidden: got [0], expected 1 or more nodes in each layer, or 0",
        "hidden = [5, 5]": "mine.npz: hidden layers: got 1, expected 2 of a 3:5:5:2 network",
        "hidden = [5, 0]": "network.hidden: got [5, 0], expected 1 or more nodes in each layer",
        "hidden = 4": "mine.npz: w1: got shape (5, 3), expected (4, 3) of a 3:4:2 network",
        'hidden = 5\nactivations = ["relu", "tanh"]': (
            "network.activations: got 2 for 1 hidden layers, expected one for each"
        ),
        'hidden = 5\nquantised = "nearest"': "mine.npz: got a network without quantisers, expected",
        'hidden = 5\nfunctions = { step = "x < 1" }': "functions.step: got 'x < 1', expected",
    },
    'arrangement = "single"\nhidden = 5': {
        'arrangement = "cascade"\nhidden = 5\nactivations = ["relu"]': (
            "network.activations: got ['relu'] with arrangement 'cascade', expected none"
        ),
    },
    'weights = "mine.npz"': {
        "weights = []": "network.weights: got [], expected one: single has one",
        'weights = "mine.csv"': "mine.csv: got the ending '.csv', expected one of .npz, .mat",
        'weights = "mine"': "mine: got the ending '', expected one of .npz, .mat, .onnx",
        'weights = "no.npz"': "no.npz: no such network; make train SCENE=... writes it",
    },
    'design = "hybrid"': {
        'design = "engine"': "hardware.activation: got 'gradient' with design 'engine', expected",
        'design = "hybrid"\nmultiplier = "dsp"': "hardware.multiplier: got 'dsp' with design",
        'design = "hybrid"\nmultiplier = "x"': "hardware.multiplier: got 'x', expected one of dsp",
        'design = "hybrid"\npipeline = "deep"': "hardware.pipeline: got 'deep' with design",
        'design = "hybrid"\nclocks = 5': "hardware.clocks: got 5, expected .*, which design hybrid",
        'design = "hybrid"\ninterval = 1': "hardware.interval: got 1, expected .* design hybrid",
        'design = "hybrid"\nreload = true': "hardware.reload: got true with design 'hybrid'",
        'design = "hybrid"\nreload = "yes"': "hardware.reload: got 'yes', expected true or false",
        'design = "hybrid"\nspeed = 1': "hardware: key 'speed' is not known, expected design",
        'design = "hybrid"\nclock_mhz = 0': "hardware.clock_mhz: got 0.0, expected 0.001 to",
        'design = "hybrid"\nclock_mhz = nan': "hardware.clock_mhz: got nan, expected 0.001 to",
        'design = "hybrid"\nclock_mhz = 1e-320': "hardware.clock_mhz: got 1e-320, expected",
    },
    'activation = "gradient"': {
        'activation = "bipartite"': "hardware.activation: got 'bipartite', whose codes stand for",
        'activation = "tanh"': "hardware.activation: got 'tanh', expected one of gradient",
        'activation = "gradiant"': "hardware.activation: got 'gradiant', .* you mean 'gradient'",
        'activation = ""': "hardware.activation: got '', expected one of gradient, ",
    },
    f'activation = "gradient"\n{OPTIONS}': {
        'activation = "pade"\nactivation_options = { rho = -1 }': "rho: got -1.0, expected",
        'activation = "pade"\nactivation_options = { rho = nan }': "rho: got nan, expected",
    },
    'arrangement = "single"\nhidden = 5\nweights = "mine.npz"\n\n[hardware]\ndesign = "hybrid"': {
        PARALLEL: "network.arrangement: got 'cascade' with design 'parallel', expected single",
    },
    f'design = "hybrid"\nactivation = "gradient"\n{OPTIONS}': {
        f'design = "engine"\nactivation = "precise"\n{OPTIONS[:-2]}{{ coefficients = "logic" }}': (
            "hardware.activation_options: got coefficients with design 'engine', expected none"
        ),
    },
    'interface = "stream"': {
        'interface = "axi"': "hardware.interface: got 'axi', expected one of stream, axi_stream",
        'interface = "axi_stream"\n[front_end]': "with a section [front_end], expected stream",
    },
    "restarts = 2": {
        "restarts = 0": "training.restarts: got 0, expected above 0 and 100000 at most",
        "restarts = 1000000000000": "training.restarts: got 1000000000000, expected above 0 and",
        "hidden = []": f"training.hidden: got [], {HIDDEN}",
        "hidden = [4]": f"training.hidden: got [4], {HIDDEN}",
        "seed = -1": "training.seed: got -1, expected 0 or more",
        "weight_decay = -1": "training.weight_decay: got -1.0, expected 0 or more",
        'earlier_outputs = "x"': "training.earlier_outputs: got 'x', expected one of bit-true",
        "epochs = 5": "training: key 'epochs' is not known, expected",
        'split_by = ["y0"]': "training.split_by: got ['y0'] with split 'random', expected",
        'split = "groups"': "training.split_by: got none with split 'groups', expected",
        "split_by = []": "training.split_by: got [], expected columns, each once",
        'split = "groups"\nsplit_by = ["y0", "y0"]': "split_by: got .*, expected columns, each",
        "digits = 2": "training.digits: got 2, expected at least 3: one for each",
        "digits = -1": "training.digits: got -1, expected at least 3",
        'digits = "fewest"\ndigits_tolerance = -0.1': "digits_tolerance: got -0.1, expected 0 or",
        "digits = 30\ndigits_tolerance = 0.1": "tolerance: got 0.1 with digits 30, expected digits",
    },
    "steps = 20": {
        'functions = "line"': "training.functions: got 'line', expected",
        'functions = "spline"\ndigits = 30': "got 'spline' with training.digits, expected one of",
        "intervals = [2, 4]": "training.intervals: got [2, 4] without training.functions, expected",
        "intervals = []": "training.intervals: got [], expected whole numbers from 0 to 32",
        "intervals = [33]": "training.intervals: got [33], expected whole numbers from 0 to",
    },
    "[training]": {
        "[[training]]": "training: got [{.*}], expected a section",
        "[front_end]\ncounter_width = 0\n[training]": "front_end.counter_width: got 0, expected",
        "[front_end]\ncounter_width = 2\n[training]": "front_end: scan_sequencer: got counter_",
        "[front_end]\ncounter_width = 64\n[training]": "counter_width: got 64, expected 1 to 24",
        "[front_end]\nsample_at = 0\n[training]": "front_end.sample_at: got 0.0, expected above",
        "[front_end]\nsample_at = nan\n[training]": "front_end.sample_at: got nan, expected above",
        "[front_end]\nsample_at = 1e-9\n[training]": "front_end: scan_sequencer: got sample_",
        "[front_end]\nreference = 5\n[training]": "front_end.reference: got 5 without a converter",
    },
}
ENGINE: dict[str, str] = {
    "program_words = 8": "program_words: got 8 without reload, expected hardware.reload = true",
    "reload = true\nprogram_words = 5": "hardware.program_words: got 5, expected a power of two",
    'reload = true\nmultiplier = "serial"': "hardware.reload: got true with multiplier 'serial'",
    'reload = true\ninterface = "axi_stream"': "hardware.reload: got true with interface",
    "segment_width = -1": "segment_width: got -1, expected one of 7, 8, 9",
    "segment_width = 1000000000000": "segment_width: got 1000000000000, expected one of 7, 8, 9",
    "clocks = 1": "hardware.clocks: got 1, expected 53 or more, which multiplier 'dsp' takes",
    **{
        f"{key} = 0": f"hardware.{key}: got 0, expected a number above 0, or no such key"
        for key in ("clocks", "segment_width", "adders_per_clock")
    },
    "clocks = -1": "hardware.clocks: got -1, expected 53 or more",
    'pipeline = "deep"\nmultiplier = "serial"': "hardware.pipeline: got 'deep' with multiplier",
    "[front_end]\ncounter_width = 3": "front_end: instrument: got counter_width=3, a scan of 8",
}
ROWS = [(old, new, message) for old, rows in TABLE.items() for new, message in rows.items()]


@pytest.mark.parametrize(("old", "new", "message"), ROWS, ids=lambda text: text[:40])
def test_a_key_is_refused(desk: Desk, old: str, new: str, message: str) -> None:
    desk.edit(old, new)
    desk.refuses("bench", "mine.toml", says=message)


# The messages for an empty file.
MISSING = [
    "data.sensors: missing, expected a list",
    *(f"{key}: missing, {TEXT}" for key in ("network.arrangement", "network.weights")),
    *(f"{key}: missing, {TEXT}" for key in ("hardware.design", "hardware.precision")),
    "data.file: missing, expected text, the name of a file",
    "data.outputs: missing, expected a list of column names, or a column of labels",
]
SECTIONS = "[visualisation]\nload = 'y0'\nposition = 'y1'\n[uart]\nbaud = 5\n[front_end]"
# Sections of a board's scene, and all messages that come at once.
BOARD = {
    SECTIONS: [
        "front_end.converter: got none with a section [uart], expected a part",
        "visualisation.width: got 'width', expected one of the outputs y0, y1",
        "visualisation.shape: got 'shape', expected one of the outputs y0, y1",
        "data.length_mm: 'y1' is missing, expected the length of the output that is the position",
    ],
    "[visualisation]": [
        f"visualisation.{key}: got {key!r}, expected one of the outputs y0, y1"
        for key in ("load", "position", "width", "shape")
    ],
    '[front_end]\nconverter = "mcp3208"\nsample_at = 2\n[uart]\nbaud = 99_000_000': [
        "front_end.sample_at: got 2.0, expected above 0 and below 1",
        "uart.baud: got 99000000, expected 1 to",
    ],
}


def test_every_key_that_is_missing_is_named(desk: Desk) -> None:
    (desk.folder / "mine.toml").write_text("")
    desk.refuses("bench", "mine.toml", says=MISSING[0], faults=len(MISSING))
    said = desk.call("bench", "mine.toml")[1].splitlines()
    for line, message in zip(said, MISSING, strict=True):
        assert f"error: mine.toml: {message}" in line


@pytest.mark.parametrize(("keys", "messages"), BOARD.items(), ids=["all", "drawn", "line"])
def test_the_faults_of_a_boards_scene_are_told_at_once(
    desk: Desk, keys: str, messages: list[str]
) -> None:
    desk.edit("[training]", f"{keys}\n\n[training]")
    desk.refuses("bench", "mine.toml", says=messages[0], faults=len(messages))
    said = desk.call("bench", "mine.toml")[1].splitlines()
    for line, message in zip(said, messages, strict=True):
        assert f"error: mine.toml: {message}" in line
    told = faults(check("mine.toml", Path("build")))
    assert [f"error: {text}" for text in told] == said


@pytest.mark.parametrize(("keys", "message"), ENGINE.items(), ids=lambda text: text[:40])
def test_a_key_of_an_engine_is_refused(desk: Desk, keys: str, message: str) -> None:
    desk.edit('design = "hybrid"\nactivation = "gradient"', 'design = "engine"')
    desk.edit('interface = "stream"', keys)
    desk.refuses("listing", "mine.toml", says=message)
