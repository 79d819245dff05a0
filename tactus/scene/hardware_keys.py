"""The keys of a scene's section ``[hardware]``."""

from golden.activation.schemes import SCHEMES
from golden.networks.designs import DESIGNS
from golden.numbers.precision import PRECISIONS
from tactus.core.schema import Anything, Flag, Key, KeyTable, Map, Number, Span, Text, Whole
from tactus.sizing.choice import UNDECIDED
from tactus.sizing.price import DEFAULT, DEVICES

_PRICE = Number(Span(0.0, 1e9))

HARDWARE = KeyTable(
    {
        "design": Key(
            Text((*DESIGNS, UNDECIDED)),
            meaning="How the networks are built. [engine](blocks/engine.md) has one multiplier and "
            "a program; it takes any arrangement in `exact` precision with the activation "
            "`precise`. [lanes](blocks/lanes.md) is an engine with 1 to 16 multipliers, which "
            "takes fewer clocks for the same networks. "
            "[hybrid](blocks/hybrid.md) is folded over inputs and outputs. "
            "[parallel](blocks/parallel.md) does every multiplication at once, and takes only the "
            "arrangement `single`. [adder_graph](blocks/adder_graph.md) takes a frame every clock "
            "and needs no multiplier; it takes networks of any depth as `single`, and one hidden "
            "layer of tanh as `multiple`, in `exact` precision with the activation `bipartite`. "
            "[table_graph](blocks/table_graph.md) does the same for networks of learned functions, "
            "which it looks up in small tables. "
            "`auto` is the smallest of them that is fast enough, see "
            "[designs](designs.md#the-smallest-that-is-fast-enough); in `thesis` precision that is "
            "`hybrid` or `parallel`, with the activation that the scene names.",
        ),
        "activation": Key(
            Text(tuple(SCHEMES)),
            "",
            "The approximation of tanh: [gradient](blocks/gradient.md), "
            "[gradient_parallel](blocks/gradient_parallel.md), [lut](blocks/lut.md), "
            "[pade](blocks/pade.md), [polynomial](blocks/polynomial.md), "
            "[precise](blocks/precise.md) or [bipartite](blocks/bipartite.md). `precise` and "
            "`bipartite` need `exact` precision, and `bipartite` needs the design `adder_graph` "
            "as well.",
            "`bipartite` with `adder_graph`; else `precise` in `exact` precision, `gradient` in "
            "`thesis`",
        ),
        "activation_options": Key(
            Map(Anything()),
            {},
            "The options of the activation. `pade` has `{ rho = 4.5, iterations = 32 }`. "
            '`precise` has `{ coefficients = "logic" }` or `"block_ram"`. `bipartite` has '
            '`{ memory = "block_ram" }` or `"logic"`. The other activations have none.',
        ),
        "precision": Key(
            Text(tuple(PRECISIONS)),
            meaning="The number formats and rounding, `thesis` or `exact`. See "
            "[formats](formats.md#the-two-precisions).",
        ),
        "clock_mhz": Key(
            Number(Span(0.001, 10_000.0)),
            64.0,
            "The frequency of the clock. The report of `make demo` turns clocks into times with "
            "it, and the exported [ise.ucf](handover.md#constraints) states its period.",
        ),
        "interface": Key(
            Text(("stream", "axi_stream")),
            "stream",
            "The ports of the top entity. `stream` gives it the ports of the network. `axi_stream` "
            "puts the network behind AXI4-Stream with back-pressure "
            "([axis_network](blocks/axis_network.md)), for `engine` and `hybrid` and `lanes` "
            "without front end and visualisation.",
        ),
        "argmax": Key(
            Flag(),
            False,
            "With `true` the top entity has the ports `winner_index`, `winner_margin` and "
            "`winner_valid` beside its stream of outputs: the number of the largest output, how "
            "far the second largest is below it, and when both are there "
            "([argmax](blocks/argmax.md)). This is the class that a network for classes decides "
            "for. It is for two outputs or more. `engine`, `hybrid` and `lanes` have it with any "
            "front end. `adder_graph` and `table_graph` give their outputs in one clock and have a "
            "tree ([argmax_tree](blocks/argmax_tree.md)). Behind `axi_stream` both "
            "numbers are `m_axis_tuser` of the last output "
            "([axis_network](blocks/axis_network.md)).",
        ),
        "multiplier": Key(
            Text(("dsp", "serial")),
            "",
            "Only for `engine`. `dsp` uses one multiplier. `serial` works [without a "
            "multiplier](blocks/engine.md#without-a-multiplier): it takes about twelve times "
            "the clocks and gives the same results.",
            "`dsp`",
        ),
        "learning": Key(
            Text(("lms",)),
            "",
            "Only for `engine`, with a cascade or one network of one output. With `lms` the engine "
            "[learns gains and offsets of its sensors](blocks/learning_engine.md) from frames "
            "whose outputs are known. It has one multiplier and the pipeline `short`, no reload, "
            "no `axi_stream` and no `argmax`. A front end or a visualisation asks for a section "
            "`[uart]` too, through which the known outputs come.",
            "it does not learn",
        ),
        "pipeline": Key(
            Text(("short", "deep")),
            "",
            "Only for `engine` and `lanes`. `deep` puts registers behind their memories. The clock "
            "can then be faster, and a frame takes some clocks more.",
            "`short`",
        ),
        "lanes": Key(
            Whole(absent=True),
            0,
            "Only for `lanes`. The number of multipliers, 1 to 16. The results are those of an "
            "engine with one.",
            "2",
        ),
        "segment_width": Key(
            Whole(absent=True),
            0,
            "Only for `engine` and `lanes`. The number of bits of a hidden sum, 9, 8 or 7, that "
            "lie within a [segment of tanh](blocks/engine.md#numeric-behaviour); 7 to 13 where "
            "every table is that of another function. With fewer bits the error is smaller and the "
            "table has more words.",
            "9",
        ),
        "clocks": Key(
            Whole(absent=True),
            0,
            "The most clocks that a frame may take from the last sample to the last output. With "
            "`engine` the smallest one within this limit is chosen, and if there is time enough, "
            "it has no multiplier; `make vhdl` and `make demo` print the choice. With `auto` it "
            "is the smallest design. Any other design that takes more is refused.",
            "with `engine` and `auto`, what a front end leaves; else no limit",
        ),
        "interval": Key(
            Whole(absent=True),
            0,
            "The most clocks from one frame to the next. In `lanes` frames [overlap]"
            "(blocks/lanes.md#frames-that-overlap) if they must. Any other design that takes more "
            "is refused, and `auto` chooses another one.",
            "no limit",
        ),
        "frames_a_second": Key(
            Number(finite=True, absent=True),
            0.0,
            "The least number of frames a second, at the clock of `clock_mhz`: another way to "
            "give `interval`.",
            "no limit",
        ),
        "device": Key(
            Text(tuple(DEVICES)),
            "",
            "Only for `auto`. The device whose share is the price of a design.",
            f"`{DEFAULT}`",
        ),
        "prices": Key(
            KeyTable({"lut": Key(_PRICE), "multiplier": Key(_PRICE), "block_ram": Key(_PRICE)}),
            None,
            "Only for `auto`. What a LUT, a multiplier and a block RAM cost, in any unit, such as "
            "`{ lut = 1, multiplier = 50, block_ram = 80 }`.",
            "each is its share of the device",
        ),
        "reload": Key(
            Flag(),
            False,
            "Only for `engine` and `lanes`. With `true` the program is not part of the hardware: "
            "it is an image that is loaded ([image_loader](blocks/image_loader.md)). The hardware "
            "then depends only on `program_words`, `operand_words`, `table_blocks`, "
            "`segment_width`, `pipeline` and `lanes`, on whether the scene's own network has ReLU, "
            "and on the kinds of its quantisers. A scene with a section [uart](#uart) loads the "
            "image over that line. Any other scene must have no front end, no visualisation and "
            "no `axi_stream`.",
        ),
        "program_words": Key(
            Whole(absent=True),
            0,
            "Only with `reload`. The number of words of the program memory, a power of two. With "
            "`lanes` each half of a lane's memory has as many: 8192 at most, and no fewer than the "
            "tables take, which for tanh are 512.",
            "512",
        ),
        "operand_words": Key(
            Whole(absent=True),
            0,
            "Only with `reload`. The number of words of the operand memory, a power of two.",
            "128",
        ),
        "table_blocks": Key(
            Whole(absent=True),
            0,
            "Only with `reload`. The number of blocks for [tables of functions]"
            "(networks.md#functions-of-your-own) in the program memory, or in that of each lane. "
            "With any blocks, each image brings the functions of its own network, as many as the "
            "blocks hold; without them there is the table of tanh alone.",
            "what the scene's own functions take",
        ),
        "adders_per_clock": Key(
            Whole(Span(1, 100), absent=True),
            0,
            "Only for `adder_graph` and `table_graph`. How many adders stand one behind the other "
            "between two registers. Fewer adders make the clock faster and the latency longer.",
            "5",
        ),
        "adder_operands": Key(
            Whole(absent=True),
            0,
            "Only for `adder_graph` and `table_graph`. How many numbers an adder adds, 2 or 3. "
            "With 3 the hardware "
            "is smaller where LUTs have six inputs, as in Series 7 and UltraScale, and larger "
            "where they have four.",
            "2",
        ),
        "word_width": Key(
            Whole(Span(3, 18), absent=True),
            0,
            "Only for `adder_graph`, behind layers of ReLU or other layers without a table. How "
            "many bits a word from layer to layer has. Each bit less makes every adder "
            "behind it shorter. A network for classes often decides the same with 8.",
            "15",
        ),
        "search_runs": Key(
            Whole(Span(1, 10_000), absent=True),
            0,
            "Only for `adder_graph`. How often the [search for sums that results share]"
            "(blocks/constant_matrix.md) is run for each matrix. More runs "
            "take longer, and their graph never has more bits of adders in as many clocks.",
            "up to 40, fewer for a large matrix",
        ),
        "sample_bits": Key(
            Whole(absent=True),
            0,
            "Only for `table_graph`. How many of the upper bits of a sample its tables read, 4 to "
            "14. A bit that is below the noise of the readings only makes tables larger.",
            "10",
        ),
        "hidden_bits": Key(
            Whole(absent=True),
            0,
            "Only for `table_graph`. How many bits a hidden sum has for the tables behind it, 4 to "
            "14.",
            "10",
        ),
        "output_bits": Key(
            Whole(absent=True),
            0,
            "Only for `table_graph`. How many bits of an output its tables give, 4 to 14. The bits "
            "below them are 0.",
            "10",
        ),
    },
    name="a section",
)
