"""Cases that several benches share: smallest and odd shapes, and weights that reach the rails.

``rails`` comes first. It drives its sums and its activation to every end, so that faults have an
effect there.
"""

from dataclasses import replace

from golden.numbers.precision import PRECISIONS
from golden.trained.dense import Quantiser
from golden.trained.window import Window
from tb.common.cases import FRONT_END, VISUALISATION, Case

RAILS = Case([(3, 4, 3)], "exact", spread=20.0, seed=2)
LEAST = Case([(1, 1, 1)], "exact")
# These have the smallest shapes, more outputs than inputs (which needs the spacing counter), one
# output, odd adder trees, and Q_j of several hundred.
FOLDED = {
    "rails": RAILS,
    "least": LEAST,
    "least-thesis": replace(LEAST, shapes=[(1, 2, 1)], precision="thesis"),
    "wide": replace(LEAST, shapes=[(2, 3, 5)]),
    "wide-thesis": replace(LEAST, shapes=[(3, 5, 4)], precision="thesis"),
    "huge": replace(LEAST, shapes=[(4, 3, 2)], precision="thesis", spread=100.0),
    "huge-exact": replace(LEAST, shapes=[(4, 3, 2)], spread=100.0),
}
# For a block inside a folded network.
PARTS = {"rails": RAILS}

PARALLEL = {
    "rails-parallel": replace(RAILS, precision="thesis", design="parallel"),
    "parallel": Case([(2, 3, 2)], "thesis", design="parallel"),
    "least-parallel": Case([(1, 1, 1)], "exact", design="parallel"),
    "wide-parallel": Case([(5, 4, 3)], "exact", design="parallel"),
    "huge-parallel": Case([(4, 3, 2)], "thesis", spread=100.0, design="parallel"),
    "pade-parallel": Case([(2, 3, 2)], "thesis", activation="pade", design="parallel"),
    "precise-parallel": Case([(2, 3, 2)], "exact", activation="precise", design="parallel"),
}

# These have sums that leave their formats, one sensor, few levels of adders between registers, rows
# without a weight, an odd number of hidden nodes, tables in LUTs, and adders of three operands.
ADDER_GRAPH = Case([(3, 4, 3)], "exact", activation="bipartite", design="adder_graph", seed=2)
ADDER_GRAPHS = {
    "rails-graph": replace(ADDER_GRAPH, spread=20.0),
    "least-graph": replace(ADDER_GRAPH, shapes=[(1, 1, 1)]),
    "short-graph": replace(
        ADDER_GRAPH, shapes=[(2, 3, 2)], spread=100.0, hardware="adders_per_clock = 1"
    ),
    "logic-graph": replace(ADDER_GRAPH, options='{ memory = "logic" }'),
    "operands-graph": replace(
        ADDER_GRAPH, shapes=[(3, 4, 2)], spread=20.0, hardware="adder_operands = 3"
    ),
    "three-graph": replace(
        ADDER_GRAPH, shapes=[(2, 4, 1), (2, 3, 1), (2, 2, 1)], arrangement="multiple"
    ),
}

# Layers without a table: a ReLU, whose words have 15 bits, or 6; codes of 4 bits, halves to even,
# where nothing is cut; none hidden. Layers with tables in front of others. All decide, and with
# these weights each output is the largest of some frames.
DECIDED = "argmax = true"
DEEP_GRAPHS = {
    "relu-graph": replace(
        ADDER_GRAPH, shapes=[(3, 4, 4, 3)], activations=("relu", "relu"), hardware=DECIDED, seed=22
    ),
    "narrow-graph": replace(
        ADDER_GRAPH,
        shapes=[(3, 4, 4, 3)],
        activations=("relu", "relu"),
        hardware=f"{DECIDED}\nword_width = 6",
        seed=22,
    ),
    "exact-graph": replace(
        ADDER_GRAPH,
        shapes=[(3, 5, 4, 3)],
        activations=("relu", "relu"),
        hardware=DECIDED,
        spread=2.0,
        seed=12,
        quantiser=Quantiser(2.0**-3, 0, 0, 15),
    ),
    "flat-graph": replace(ADDER_GRAPH, shapes=[(2, 5)], hardware=DECIDED, seed=15),
    "deep-graph": replace(
        ADDER_GRAPH,
        shapes=[(2, 3, 2, 3, 2)],
        activations=("tanh", "leaky_relu", "sigmoid"),
        hardware=DECIDED,
    ),
}
# Five outputs leave one without a pair in two levels, three outputs in one, and two in none.
ADDER_GRAPHS |= DEEP_GRAPHS

# Networks of learned functions: sums that leave their words, as few bits as there may be, one
# sensor, all bits of a sample, an adder between two registers, three operands, two networks, and a
# network that decides among classes.
TABLE_GRAPH = Case(
    [(2, 2, 2)],
    "exact",
    activation="precise",
    design="table_graph",
    learned=True,
    hardware="sample_bits = 7\nhidden_bits = 7\noutput_bits = 8",
)
TABLE_GRAPHS = {
    "rails-tables": replace(TABLE_GRAPH, spread=8.0),
    "least-tables": replace(
        TABLE_GRAPH,
        shapes=[(1, 1, 1)],
        hardware="sample_bits = 4\nhidden_bits = 4\noutput_bits = 4\nadders_per_clock = 1",
    ),
    "whole-tables": replace(
        TABLE_GRAPH,
        shapes=[(1, 2, 1)],
        hardware="sample_bits = 14\nhidden_bits = 9\noutput_bits = 14",
    ),
    "operands-tables": replace(
        TABLE_GRAPH, shapes=[(3, 3, 2)], hardware="adders_per_clock = 1\nadder_operands = 3", seed=9
    ),
    "two-tables": replace(TABLE_GRAPH, shapes=[(2, 3, 1), (2, 2, 1)], arrangement="multiple"),
    "argmax-tables": replace(
        TABLE_GRAPH, shapes=[(2, 3, 3)], hardware=f"{TABLE_GRAPH.hardware}\n{DECIDED}", seed=15
    ),
}

# Engines that learn: a cascade, and the smallest one.
LESSONS = {
    "lesson": Case(
        [(2, 2, 1), (3, 1, 1)],
        "exact",
        spread=0.3,
        activation="precise",
        design="engine",
        arrangement="cascade",
        hardware='learning = "lms"',
    ),
    "least-lesson": Case(
        [(1, 1, 1)],
        "exact",
        activation="precise",
        seed=4,
        design="engine",
        hardware='learning = "lms"',
    ),
}

# Networks that need more clocks from frame to frame than a frame has elements.
SLOW = Case([(2, 1, 1), (3, 1, 1)], "exact", activation="pade", arrangement="cascade", spread=2.0)
SLOWER = "{ rho = 1.5, iterations = 11 }"
# Networks of different depth, so that results wait for each other, and more networks than samples.
CASCADES = {
    "chain": Case([(2, 3, 1), (3, 3, 1), (4, 3, 1)], "exact", arrangement="cascade", seed=0),
    "least-cascade": Case([(1, 1, 1), (2, 2, 1)], "exact", arrangement="cascade"),
    "deep-cascade": Case(
        [(2, 1, 1), (3, 9, 1), (4, 2, 1), (5, 5, 1)], "thesis", arrangement="cascade"
    ),
    # One case needs as many clocks as a frame has elements, the other more.
    "slow-cascade": SLOW,
    "slower-cascade": replace(SLOW, options=SLOWER),
}
MULTIPLES = {
    "three": Case([(2, 4, 1), (2, 3, 1), (2, 2, 1)], "exact", arrangement="multiple", seed=0),
    "least-multiple": Case([(1, 2, 1), (1, 1, 1)], "thesis", arrangement="multiple"),
    "wide-multiple": Case([(2, 9, 1), (2, 1, 1), (2, 4, 1)], "exact", arrangement="multiple"),
}

# The ramp is short, because all tests of a bench run for each mutant.
DRAWN = {
    "drawn": Case(
        [(2, 3, 4)],
        "exact",
        seed=2,
        sections=f"{VISUALISATION}stop = 0.9\nstep = 0.3\n{FRONT_END}counter_width = 6\n",
    )
}
# These have samples of past frames; a cascade whose outputs are in another order, one of them not
# drawn; a ramp that starts below 0; and a gain that is not a whole number.
OTHER_PROFILES = DRAWN | {
    "drawn-past": Case(
        [(4, 2, 4)],
        "exact",
        activation="precise",
        design="engine",
        sections=f"{VISUALISATION}stop = 0.9\nstep = 0.3\n",
        window=Window(((0, 3), (0, 1))),
    ),
    "other-profile": Case(
        [(2, 1, 1), (3, 2, 1), (4, 1, 1), (5, 2, 1), (6, 1, 1)],
        "exact",
        arrangement="cascade",
        sections="""
[visualisation]
load = "y4"
position = "y2"
width = "y1"
shape = "y0"
start = -1.0
stop = 0.95
step = 0.15
shape_threshold = -0.25
""",
    ),
}
INSTRUMENTS = DRAWN | {
    # This has no profile and the narrowest counter, which takes a code one clock after its address.
    "least-instrument": Case([(3, 2, 3)], "exact", sections=f"{FRONT_END}counter_width = 3\n"),
    # Scans of 16 clocks start every 71 clocks, and samples of earlier scans are used.
    "past-instrument": Case(
        [(3, 2, 3)],
        "exact",
        activation="precise",
        design="engine",
        sections=f"{FRONT_END}counter_width = 4\nrate_hz = 900000\n",
        window=Window(((0, 2), (1,))),
    ),
    # The shortest scan that leaves the engine enough clocks.
    "engine-instrument": Case(
        [(3, 2, 3)],
        "exact",
        activation="precise",
        design="engine",
        sections=f"{FRONT_END}counter_width = 7\n",
    ),
    "one-sensor": Case([(1, 2, 4)], "thesis", sections=f"{FRONT_END}counter_width = 4\n"),
}

# The same hardware in every arrangement, with weights that take several steps, one sensor, and more
# outputs than samples.
ENGINE = Case([(3, 4, 3)], "exact", activation="precise", design="engine", spread=20.0, seed=2)
ENGINES = {
    "rails-engine": ENGINE,
    "least-engine": replace(ENGINE, shapes=[(1, 1, 1)], spread=1.0),
    "wide-engine": replace(ENGINE, shapes=[(2, 3, 5)], spread=0.5),
    "huge-engine": replace(ENGINE, shapes=[(4, 3, 2)], spread=100.0),
    "chain-engine": replace(
        ENGINE, shapes=[(2, 3, 1), (3, 3, 1), (4, 3, 1)], arrangement="cascade", spread=1.0
    ),
    "deep-engine": replace(ENGINE, hardware='pipeline = "deep"', spread=1.0),
    "deep-least-engine": replace(
        ENGINE, shapes=[(1, 1, 1)], hardware='pipeline = "deep"', spread=1.0
    ),
    "three-engine": replace(
        ENGINE, shapes=[(2, 4, 1), (2, 3, 1), (2, 2, 1)], arrangement="multiple", spread=1.0
    ),
    # The sums reach few segments of a finer table.
    "fine-engine": replace(ENGINE, shapes=[(2, 3, 2)], spread=0.5, hardware="segment_width = 7"),
}
# These functions are computed without a library, so that every machine has the same tables. The
# first is odd, and the second needs words for negative sums too.
SOFT, BELL = ("soft", "x / (1 + abs(x))"), ("bell", "1 / (1 + x * x)")
# Several multipliers: odd numbers of nodes, lanes and outputs; fewer nodes than lanes; weights of
# several parts; networks that read each other's outputs, and networks side by side; and several
# layers, so that results of each lane and of all lanes alike are read.
LANE = replace(ENGINE, shapes=[(3, 5, 3)], hardware="lanes = 3")
LANES = {
    "rails-lanes": LANE,
    "least-lanes": replace(LANE, shapes=[(1, 1, 1)], hardware="lanes = 2", spread=1.0),
    "huge-lanes": replace(LANE, shapes=[(4, 3, 2)], hardware="lanes = 2", spread=100.0),
    "chain-lanes": replace(
        LANE,
        shapes=[(2, 3, 1), (3, 3, 1), (4, 3, 1)],
        arrangement="cascade",
        hardware="lanes = 4",
        spread=1.0,
    ),
    "three-lanes": replace(
        LANE,
        shapes=[(2, 4, 1), (2, 3, 1), (2, 2, 1)],
        arrangement="multiple",
        hardware="lanes = 8",
        spread=1.0,
    ),
    "relu-lanes": replace(
        LANE, shapes=[(3, 10, 3)], activations=("relu",), hardware="lanes = 8", spread=1.0
    ),
    "layers-lanes": replace(
        LANE,
        shapes=[(3, 5, 4, 3, 2)],
        activations=("leaky_relu", "sigmoid", "relu"),
        hardware="lanes = 2\nsegment_width = 8",
        spread=1.5,
    ),
    "flat-lanes": replace(
        LANE, shapes=[(2, 3, 5, 2)], activations=("hard_tanh", "linear"), spread=1.5
    ),
    # These are quantised. The first has a zero point and rounds halves to even; the second rounds
    # down.
    "exact-lanes": replace(
        LANE,
        shapes=[(3, 5, 3, 2)],
        activations=("linear", "linear"),
        spread=1.5,
        quantiser=Quantiser(2.0**-3, 2, 0, 15),
    ),
    "floor-lanes": replace(
        LANE,
        shapes=[(2, 3, 3, 1)],
        activations=("relu", "relu"),
        hardware="lanes = 2",
        spread=1.5,
        quantiser=Quantiser(2.0**-5, 0, 0, 63, "floor"),
    ),
    # There are registers behind the memories.
    "deep-lanes": replace(
        LANE,
        shapes=[(3, 5, 3, 2)],
        activations=("tanh", "relu"),
        hardware='lanes = 4\npipeline = "deep"',
        spread=4.0,
    ),
    # Nodes of one layer have different functions, in front of a layer of tanh. The second case has
    # one function, which needs two blocks of few segments.
    "tables-lanes": replace(
        LANE,
        shapes=[(2, 5, 3, 2)],
        activations=("table:soft,bell,soft,bell,soft", "tanh"),
        functions=(SOFT, BELL),
        hardware="lanes = 2",
        spread=1.0,
    ),
    "bell-lanes": replace(
        LANE, shapes=[(2, 3, 1)], activations=("table:bell",), functions=(BELL,), spread=0.3
    ),
}
SMALL_TABLES = replace(
    ENGINE,
    shapes=[(2, 3, 2)],
    activations=("table:bell,soft,bell",),
    functions=(SOFT, BELL),
    spread=1.0,
)
# Several functions in one memory. The first case has sums that leave the tables, and tanh among
# them; the second has registers behind the memories, one function, and few segments; the third is
# short; into the last an image is loaded.
TABLES = {
    "tables-engine": replace(
        ENGINE,
        shapes=[(2, 3, 2, 2)],
        activations=("table:soft,bell,soft", "tanh"),
        functions=(SOFT, BELL),
    ),
    "deep-tables-engine": replace(
        ENGINE,
        shapes=[(2, 2, 1)],
        activations=("table:bell",),
        functions=(BELL,),
        hardware='pipeline = "deep"',
        spread=0.5,
    ),
    # A short program, and each weight is one step of it.
    "small-tables-engine": SMALL_TABLES,
    # Each image that is loaded brings tables of its own, in up to three blocks.
    "tables-reload": replace(
        SMALL_TABLES, shapes=[(2, 3, 1)], hardware="reload = true\nprogram_words = 2048"
    ),
}
# Learned functions, which are added up. In the second case a network takes the output of another
# one, and there are registers behind the memories.
LEARNED = {
    "learned-engine": replace(
        ENGINE, shapes=[(3, 3, 2)], learned=True, hardware="segment_width = 10", spread=1.0
    ),
    "learned-chain": replace(
        ENGINE,
        shapes=[(2, 2, 1), (3, 2, 1)],
        arrangement="cascade",
        learned=True,
        hardware='segment_width = 13\npipeline = "deep"',
        spread=1.0,
    ),
}
# Several hidden layers, each with an activation of its own. The first case has ReLU and tanh in one
# network; the second has registers behind the memories, and sums that leave the word; the third has
# a range from the data, which other frames leave.
LAYERED = {
    "layers-engine": replace(
        ENGINE, shapes=[(3, 4, 5, 3, 2)], activations=("relu", "sigmoid", "leaky_relu"), spread=1.5
    ),
    "deep-layers-engine": replace(
        ENGINE,
        shapes=[(2, 5, 3, 2)],
        activations=("relu", "hard_tanh"),
        hardware='pipeline = "deep"',
        spread=2.0,
    ),
    "ranged-engine": replace(
        ENGINE, shapes=[(12, 3, 3, 2)], activations=("leaky_relu", "relu"), seed=0, spread=1.5
    ),
    # The sums behind ReLU reach every segment of the table of tanh.
    "steep-engine": replace(
        ENGINE, shapes=[(3, 4, 3, 2)], activations=("relu", "tanh"), spread=4.0, seed=1
    ),
    # These are quantised. The first has a zero point and rounds halves to even; the second rounds
    # down.
    "exact-engine": replace(
        ENGINE,
        shapes=[(3, 4, 3, 2)],
        activations=("linear", "linear"),
        spread=1.5,
        quantiser=Quantiser(2.0**-3, 2, 0, 15),
    ),
    "floor-engine": replace(
        ENGINE,
        shapes=[(2, 3, 2, 1)],
        activations=("relu", "relu"),
        hardware='pipeline = "deep"',
        spread=1.5,
        quantiser=Quantiser(2.0**-5, 0, 0, 63, "floor"),
    ),
    # The first is loaded into hardware with ReLU. The second is loaded into hardware with registers
    # behind the memories, whose results are limited and rounded to even.
    "layers-reload": replace(
        ENGINE,
        shapes=[(3, 4, 3, 2)],
        activations=("relu", "leaky_relu"),
        hardware="reload = true",
        spread=1.5,
    ),
    "exact-reload": replace(
        ENGINE,
        shapes=[(2, 3, 3, 2)],
        activations=("relu", "linear"),
        hardware='reload = true\npipeline = "deep"',
        spread=1.5,
        quantiser=Quantiser(2.0**-3, 0, 0, 15),
    ),
}
# The index and the margin of the largest output: of three, of two, of so many that no code of the
# index is left over, and of a design without an engine.
WINNER = replace(ENGINE, hardware="argmax = true", seed=15)
WINNERS = {
    "winner": WINNER,
    "least-winner": replace(WINNER, shapes=[(1, 1, 2)], spread=1.0),
    "wide-winner": replace(WINNER, shapes=[(2, 3, 16)], spread=1.0),
    "hybrid-winner": Case([(2, 3, 5)], "exact", hardware="argmax = true"),
}
# Hardware that does not depend on its image.
RELOADED = {
    "rails-reload": replace(ENGINE, hardware="reload = true"),
    "deep-reload": replace(
        ENGINES["least-engine"],
        hardware='reload = true\npipeline = "deep"\nprogram_words = 1024\noperand_words = 256',
    ),
}
# The same of several multipliers: an odd number of them, of which one has no node of its own; with
# ReLU, registers behind the memories and tables of other functions.
RELOADED_LANES = {
    "rails-lanes-reload": replace(LANE, shapes=[(3, 2, 3)], hardware="lanes = 3\nreload = true"),
    "tables-lanes-reload": replace(
        LANES["tables-lanes"],
        shapes=[(2, 3, 3, 1)],
        activations=("table:soft,bell,soft", "relu"),
        hardware='lanes = 2\nreload = true\npipeline = "deep"\nsegment_width = 12\n'
        "program_words = 256",
    ),
}


def both_precisions(activation: str) -> dict[str, Case]:
    """An activation in a network with a neuron that reaches all of its segments."""
    return {
        f"{activation}-{precision}": Case(
            [(2, 1, 2)], precision, spread=2.0, activation=activation, seed=8
        )
        for precision in PRECISIONS
    }


def rails(activation: str) -> dict[str, Case]:
    """An activation after sums that reach their ends."""
    return {f"rails-{activation}": replace(RAILS, activation=activation)}


BLOCK_RAM = '{ coefficients = "block_ram" }'
# The coefficients are in logic or in block RAM. Each case has few segments or all of them.
PRECISE = {
    "logic": Case([(2, 3, 2)], "exact", activation="precise", spread=0.5),
    "logic-huge": Case([(2, 2, 1)], "exact", activation="precise", spread=100.0),
    "block-ram": Case([(2, 3, 2)], "exact", activation="precise", options=BLOCK_RAM, spread=0.5),
    "block-ram-huge": Case(
        [(2, 2, 1)], "exact", activation="precise", options=BLOCK_RAM, spread=100.0
    ),
}

# Networks with past samples: with other delays for each sensor; with a long past; with slots after
# the samples; with frames that come no faster than the window sends them.
WINDOW = Window(((0, 1, 3), (0,), (2, 5)))
PAST = Case([(6, 2, 2)], "exact", activation="precise", design="engine", window=WINDOW)
WINDOWS = {
    "past": PAST,
    "long-past": replace(
        PAST, shapes=[(4, 1, 1)], design="hybrid", window=Window(((0, 64), (0, 3)))
    ),
    "chain-past": replace(
        PAST,
        shapes=[(4, 1, 1), (5, 1, 1)],
        design="hybrid",
        arrangement="cascade",
        window=Window(((0, 2), (0, 2))),
    ),
    "few-past": replace(PAST, shapes=[(2, 2, 2)], design="hybrid", window=Window(((2,), (1,)))),
}

# A pair of nodes and a single one, with a q wider than 18 bits, a q below 2, and tables in LUTs.
BIPARTITE = {
    "bipartite-rails": replace(ADDER_GRAPH, shapes=[(2, 3, 2)], spread=20.0),
    "bipartite-low": replace(ADDER_GRAPH, shapes=[(2, 3, 2)], spread=0.3),
    "bipartite-logic": replace(
        ADDER_GRAPH, shapes=[(2, 3, 2)], spread=20.0, options='{ memory = "logic" }'
    ),
}
# Real converters. The first has 12 bits and repeats the code; sclk takes two clocks of the
# hardware, which is slow enough to need no divider; and there are slots. The second has 16 bits,
# which are rounded, and a scan with an idle turn and a pause. The third sends two's complement.
CONVERTER = Case(
    [(2, 2, 1), (3, 1, 1), (4, 1, 1)],
    "exact",
    arrangement="cascade",
    hardware="clock_mhz = 4.0",
    sections=f'{FRONT_END}converter = "mcp3208-5v"\ncounter_width = 7\n',
)
CONVERTERS = {
    "converter": CONVERTER,
    "wide-converter": replace(
        CONVERTER,
        shapes=[(3, 2, 3)],
        arrangement="single",
        activation="precise",
        design="engine",
        hardware="clock_mhz = 12.0",
        sections=f'{FRONT_END}converter = "ads8344"\ncounter_width = 10\nrate_hz = 11000\n',
    ),
    "signed-converter": replace(
        CONVERTER,
        shapes=[(1, 2, 4)],
        arrangement="single",
        hardware="clock_mhz = 5.0",
        sections=f'{VISUALISATION}stop = 0.9\nstep = 0.3\n{FRONT_END}converter = "ads8345"\n'
        "counter_width = 8\n",
    ),
}
# With a serial line. The first has an engine that can be reloaded, and a short ramp as codes and as
# pulse density. The second has no reload, no profile, slots, and an odd number of clocks in a bit.
_LINE = f'{FRONT_END}converter = "mcp3208-5v"\ncounter_width = 8\n\n[uart]\n'
_DRAWN = f'{VISUALISATION}stop = 0.9\nstep = 0.3\nanalogue = "pulse_density"\n{_LINE}'
UART = replace(
    CONVERTER,
    shapes=[(2, 3, 4)],
    arrangement="single",
    activation="precise",
    design="engine",
    hardware="clock_mhz = 4.0\nreload = true",
    sections=_DRAWN,
)
PLAIN_UART = replace(CONVERTER, sections=f"{CONVERTER.sections}\n[uart]\nbaud = 571_000\n")
UARTS = {"uart": UART, "plain-uart": PLAIN_UART}
# An engine that learns from what comes over the line.
LEARN_UART = replace(
    LESSONS["lesson"],
    shapes=[(2, 2, 1), (3, 1, 1), (4, 1, 1)],
    hardware='learning = "lms"\nclock_mhz = 4.0',
    sections=f'{FRONT_END}converter = "mcp3208-5v"\ncounter_width = 9\n\n[uart]\n',
)
# The largest output in packets, before the point of a profile.
WINNER_UART = replace(UART, hardware="clock_mhz = 4.0\nargmax = true")
# For the whole top: the first case, whose image takes thousands of clocks; high profiles; one
# without an image; an engine that learns; and lanes with past samples.
UART_INSTRUMENTS = {
    "reload-uart": UART,
    # With these weights the profiles are high and deep.
    "drawn-uart": replace(UART, hardware="clock_mhz = 4.0", spread=4.0, seed=15),
    "plain-uart": PLAIN_UART,
    "learn-uart": LEARN_UART,
    "past-uart": replace(
        UART,
        shapes=[(4, 3, 4)],
        design="lanes",
        hardware="clock_mhz = 4.0\nlanes = 2",
        window=Window(((0, 1), (0, 2))),
        spread=4.0,
    ),
}

# For a readout: the largest output beside the stream alone, of a network with past samples, of an
# engine that is loaded, and beside held outputs and a profile.
# With the weights of the first and of the last case each output is the largest of some frames.
READ_WINNERS = {
    "winner": WINNER,
    "winner-past": replace(PAST, hardware="argmax = true"),
    "winner-reload": replace(WINNER, hardware="argmax = true\nreload = true"),
    "drawn-winner": replace(DRAWN["drawn"], hardware="argmax = true", seed=14),
}
