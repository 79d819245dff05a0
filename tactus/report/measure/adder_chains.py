"""``python -m tactus.report.measure.adder_chains``: how many adders an ECP5 takes in one clock.

For each number of adders in a chain and each speed grade, it measures the clock that the chain
reaches: alone between two registers, with a saturation after it, and as ``adders_per_clock`` of a
whole network. Placing and routing takes a quarter of an hour of processor time, so the figures are
recorded. Table ``adder_chains`` of ``make figures`` shows the record.

    python -m tactus.report.measure.adder_chains --record
"""

import json
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from golden.networks.adder_graph import AdderGraph
from tactus.export.exporter import export
from tactus.export.repeatable import run_repeatable
from tactus.report.measure.table import Cell, Table, print_or_record, read_csv
from tactus.scene import Scene, load_scene
from tactus.synth.timing import DEVICE, PLACER, ROUTER, SEED, TOOLS, mapped, place
from tactus.synth.tools import stored

SCENE = "digit-fast"
RECORD = Path(__file__).with_suffix(".csv")
# The speed grades in which Lattice sells an ECP5. A larger number is faster.
GRADES = (6, 7, 8)
ADDERS = (1, 2, 3, 4, 5)
# Networks with so many adders. Scenes with 1 and with 5 exist, and make synth records them.
NETWORKS = (2, 3)
# The clock that the router aims at: above that of any chain, or a fifth above the expected one.
CHAIN_AIM, AIM = 600, 180
# The placer and the router: those of make synth, and those that give small designs most speed.
USUAL, SMALL = (PLACER, ROUTER), ("heap", "router1")
COLUMNS = [
    "adders",
    *(f"alone, grade {grade}, MHz" for grade in GRADES),
    *(f"and saturation, grade {grade}, MHz" for grade in GRADES),
    "clocks of the network",
    *(f"network, grade {grade}, MHz" for grade in GRADES),
]
NOTE = (
    "The clocks are those of an ECP5 (LFE5U-85F), which Yosys and nextpnr found with seed "
    f"{SEED}. 'Alone' has so many adders in a row between registers that nothing else uses. The "
    f"adders are as wide as the widest result of {SCENE}; the placer is heap and the router is "
    f"router1. The network is {SCENE} with so many adders between registers, placed as make synth "
    "places it; paths from its pins to its first registers are not counted. The figures were "
    "recorded by python -m tactus.report.measure.adder_chains."
)


def chain(name: str, count: int, width: int, result: int) -> str:
    """Verilog of ``count`` adders of ``width`` bits between registers.

    The operands come from a shift register. A result with fewer bits is saturated. The code keeps
    Yosys from joining two adders into one of three operands.
    """
    operands = range(count + 1)
    sums = [f"a0 + a{n}" if n == 1 else f"s{n - 1} + a{n}" for n in operands[1:]]
    last, top = f"s{count}", result - 1
    clipped = f"{last} >>> {top} == 0 || {last} >>> {top} == -1 ? {last} : " + (
        f"{last} < 0 ? {1 << top} : {(1 << top) - 1}"
    )
    return "\n".join(
        [
            f"module {name}(input clk, input bit, output sent);",
            *(f"  reg signed [{width - 1}:0] a{n};" for n in operands),
            *(
                f"  (* keep *) wire signed [{width - 1}:0] s{n} = {text};"
                for n, text in enumerate(sums, start=1)
            ),
            f"  reg signed [{top}:0] found;",
            # Yosys removes registers that nothing reads, with the adders before them.
            "  assign sent = ^found;",
            "  always @(posedge clk) begin",
            "    a0 <= {a0, bit};",
            *(f"    a{n} <= {{a{n}, a{n - 1}[{width - 1}]}};" for n in operands[1:]),
            f"    found <= {last if result == width else clipped};",
            "  end",
            "endmodule",
            "",
        ]
    )


def chains(width: int, results: Sequence[int]) -> str:
    """Verilog with a chain for every length and width of the result, each with its own clock."""
    names = {(n, result): f"chain_{n}_{result}" for n in ADDERS for result in results}
    ports = [*(f"input clk_{name}" for name in names.values()), "input bit"]
    ports.append(f"output [{len(names) - 1}:0] sent")
    return "".join(
        [
            *(chain(name, n, width, result) for (n, result), name in names.items()),
            f"module chains({', '.join(ports)});\n",
            *(
                f"  {name} u_{name}(.clk(clk_{name}), .bit(bit), .sent(sent[{i}]));\n"
                for i, name in enumerate(names.values())
            ),
            "endmodule\n",
        ]
    )


def reached(
    verilog: Path, top: str, aim: int, method: tuple[str, str]
) -> dict[int, dict[str, float]]:
    """For each grade, the frequency in MHz of each clock, by the name of its port."""

    def work(folder: Path) -> dict[str, dict[str, float]]:
        (folder / "netlist.json").write_text(json.dumps(mapped(folder, top)), encoding="utf-8")
        return {str(grade): _placed(folder, grade, aim, method) for grade in GRADES}

    answer = stored(
        work,
        verilog,
        TOOLS,
        top=top,
        device=DEVICE[:-1],
        grades=GRADES,
        aim=aim,
        method=method,
        seed=SEED,
    )
    return {int(grade): clocks for grade, clocks in answer.items()}


def _placed(folder: Path, grade: int, aim: int, method: tuple[str, str]) -> dict[str, float]:
    report = place(folder, aim, *method, device=[*DEVICE[:-1], str(grade)])
    # nextpnr calls the clock of a port $glbnet$<port>$TRELLIS_IO_IN.
    return {name.split("$")[2]: clock["achieved"] for name, clock in report["fmax"].items()}


def alone(width: int, result: int) -> list[list[float]]:
    """For each number of adders the clock in each grade, without and with saturation."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = chains(width, (width, result))
        (folder / "chains.v").write_text(text, encoding="utf-8")
        found = reached(folder, "chains", CHAIN_AIM, SMALL)
    return [
        [found[grade][f"clk_chain_{n}_{bits}"] for bits in (width, result) for grade in GRADES]
        for n in ADDERS
    ]


def with_adders(scene: Scene, count: int) -> Scene:
    """The scene with ``count`` adders between registers."""
    return replace(scene, design_options={"adders_per_clock": count})


def network(scene: Scene) -> list[float]:
    """The clock that the network of a scene reaches in each grade."""
    with tempfile.TemporaryDirectory() as name:
        verilog = Path(name) / "verilog"
        export(scene, "verilog", verilog)
        found = reached(verilog, scene.twin().entity, AIM, USUAL)
    return [clock for grade in GRADES for clock in found[grade].values()]


def measured() -> list[list[Cell]]:
    """The rows of the table."""
    scene = load_scene(SCENE)
    design = scene.twin()
    assert isinstance(design, AdderGraph)
    outputs = design.layers[-1]
    chained = alone(max(outputs.result_widths), outputs.out_fmt.width)
    rows: list[list[Cell]] = []
    for n, clocks in zip(ADDERS, chained, strict=True):
        pipelined = with_adders(scene, n)
        found = _tenths(network(pipelined)) if n in NETWORKS else [None] * len(GRADES)
        rows.append([n, *_tenths(clocks), pipelined.twin().output_clocks[-1], *found])
    return rows


def _tenths(clocks: Sequence[float]) -> list[float]:
    return [round(clock, 1) for clock in clocks]


def adder_chains(_seed: int) -> Table:
    """The recorded table."""
    return Table("adder_chains", *read_csv(RECORD), NOTE)


def main() -> None:
    print_or_record(
        "python -m tactus.report.measure.adder_chains",
        __doc__,
        RECORD,
        lambda: Table("adder_chains", COLUMNS, measured(), NOTE),
    )


if __name__ == "__main__":
    run_repeatable("tactus.report.measure.adder_chains", main)
