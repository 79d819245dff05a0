"""A Verilog-2001 test bench that needs nothing but a simulator.

It plays the same frames as the VHDL one (``test_bench``), in the same clocks, and makes the same
checks. Samples and expected outputs are files that ``$readmemh`` reads from the folder in which the
simulator runs, so one compiled test bench serves any number of recordings.
"""

from string import Template

import numpy as np

from golden.common.port import Port
from golden.instruments.uart_instrument import UartInstrument
from golden.networks.axis_network import TUSER_HALF
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from tactus.export.handover.ports import verilog_type
from tactus.export.handover.styles import STYLES, connected, load_numbers, settle_clocks
from tactus.export.handover.verilog_styles import VERILOG_STYLES

# The files that the test bench reads, by what they hold.
SAMPLES, RESULTS, WINNERS = "samples.hex", "results.hex", "winners.hex"
IMAGE, FRAMES_FILE = "image.hex", "frames.hex"
# The last line that the test bench prints.
PASSED, FAILED = "PASSED", "FAILED"

_TEXT = Template("""\
`timescale 1ns/10ps

// Plays the frames in $samples into $top of scene $scene, $first and again
// $second, and compares every output with $results.
// The last line is $passed or $failed. Inputs change and outputs are read at the falling edge.

module ${top}_tb;

    parameter most = $most;

    localparam inputs = $inputs;
    localparam outputs = $outputs;
    // The first frames, of which no outputs come.
    localparam past = $past;
    // Clocks from the last element of a frame until all outputs have left, slowly, and some more.
    localparam settle = $settle;

$signals

    reg [31:0] frames [0:0];
    reg signed [31:0] samples [0:most*inputs-1];
    reg signed [31:0] results [0:most*outputs-1];
$memories
    // Frames that are sent, and of which outputs are due; that came out, that match, that were
    // refused.
    integer count, due, received, matched, refused;
    integer frame, element, pause, idled, number, waiting;
    reg complete, gaps;
$variables
    $top dut (
$map
    );

    always #5 clk = !clk;

    // One clock: looks at what stands on the outputs.
    task tick;
        begin
            @(negedge clk);
$refused$check
        end
    endtask

    task idle(input integer clocks);
        for (idled = 0; idled < clocks; idled = idled + 1) tick;
    endtask

    task send_frame;
        begin
$send
        end
    endtask

    task send_all;
        begin
            rst = 1;
$quiet            idle(2);
            rst = 0;
$load            for (frame = 0; frame < count; frame = frame + 1) send_frame;
            idle(settle);
            complete = complete && matched == due && received == due && refused == 0;
        end
    endtask

    initial begin
        $$readmemh("$frames_file", frames);
        count = frames[0];
        due = count - past;
        $$readmemh("$samples", samples, 0, count * inputs - 1);
        $$readmemh("$results", results, 0, due * outputs - 1);
$read        clk = 0;
$start
        complete = due > 0;
        received = 0;
        matched = 0;
        refused = 0;
$begin        gaps = 0;
        send_all;
        $$display("%0d of %0d frames match, $first", matched, due);
$judged        received = 0;
        matched = 0;
        gaps = 1;
        send_all;
        $$display("%0d of %0d frames match, $second", matched, due);
$judged        if (complete === 1'b1) $$display("$passed");
        else $$display("$failed");
        $$finish;
    end

endmodule
""")

# Hardware that never takes a byte must not hang the test bench.
_LOAD = Template("""\
            for (number = 0; number < $bytes; number = number + 1) begin
                load_data = image[number];
                load_last = number == $bytes - 1;
                load_valid = 1;
                waiting = 0;
                while (waiting < settle && load_ready !== 1'b1) begin
                    tick;
                    waiting = waiting + 1;
                end
                tick;
                load_valid = 0;
                load_last = 0;
                load_data = ~load_data;
            end
""")

# The line carries the packet of the image.
_LOAD_LINE = Template("""\
            for (number = 0; number < $bytes; number = number + 1) begin
                for (level = 0; level <= $last; level = level + 1) begin
                    rx = level == 0 ? 1'b0 : level == $last ? 1'b1 : image[number] >> (level - 1);
                    idle($divisor);
                end
            end
            idle($rest);
""")

# The winner of a frame comes behind its last output, and before that of the next frame.
_DECIDED = Template("""
            if ($valid) begin
                if (decided < due) begin
                    if ($index === winners[2 * decided] && $margin === winners[2 * decided + 1])
                        right = right + 1;
                    else $$display("the winner of frame %0d differs", decided);
                end
                decided = decided + 1;
            end""")
_JUDGED = """\
        $display("%0d of %0d winners match", right, due);
        complete = complete && right == due && decided == due;
        decided = 0;
        right = 0;
"""

_REFUSED = """\
            if (frame_error === 1'b1) refused = refused + 1;
"""


def verilog_bench(scene: str, design: Network, ports: list[Port], most: int) -> str:
    """The text of the module ``<top>_tb``.

    scene: A ``plain_name``.
    most: The most frames of a recording.
    """
    style = VERILOG_STYLES[design.stream]
    names = {port.name for port in ports}
    used = connected(ports)
    inputs = [port.name for port in used if port.direction == "in" and port.name != "clk"]
    kind = {"in": "reg", "out": "wire"}
    memories, read = [], []
    if design.image:
        memories.append(f"    reg [7:0] image [0:{len(design.image) - 1}];")
        read.append(f'        $readmemh("{IMAGE}", image);')
    if design.argmax:
        memories += ["    reg signed [31:0] winners [0:2*most-1];", "    integer decided, right;"]
        read.append(f'        $readmemh("{WINNERS}", winners, 0, 2 * due - 1);')
    return _TEXT.substitute(
        scene=scene,
        top=design.entity,
        most=most,
        inputs=design.inputs,
        outputs=design.outputs,
        past=design.past,
        settle=settle_clocks(design),
        signals="\n".join(f"    {kind[p.direction]} {verilog_type(p)}{p.name};" for p in used),
        memories="".join(f"{line}\n" for line in memories),
        variables=style.variables,
        map=",\n".join(f"        .{p.name}({p.name if p in used else ''})" for p in ports),
        refused=_REFUSED if "frame_error" in names else "",
        check=style.check(design) + _decided(design),
        send=style.send(design),
        quiet="            rx = 1;\n" if "rx" in names else "",
        load=_load(design),
        read="".join(f"{line}\n" for line in read),
        start="\n".join(f"        {name} = 0;" for name in inputs),
        begin=style.begin + ("        decided = 0;\n        right = 0;\n" if design.argmax else ""),
        first=STYLES[design.stream].passes[0],
        second=STYLES[design.stream].passes[1],
        judged=_JUDGED if design.argmax else "",
        samples=SAMPLES,
        results=RESULTS,
        frames_file=FRAMES_FILE,
        passed=PASSED,
        failed=FAILED,
    )


def hex_files(
    samples: Codes, results: Codes, image: bytes = b"", winners: Codes | None = None
) -> dict[str, str]:
    """The files that the test bench reads, by name; codes in 32 bits, one line a frame.

    samples, results: shape (frames, inputs), (frames - past, outputs).
    image: The image that is loaded before the first frame; empty where none is.
    winners, shape (frames - past, 2): See ``winners_of``.
    """
    files = {
        FRAMES_FILE: f"{len(samples):08x}\n",
        SAMPLES: _words(samples),
        RESULTS: _words(results),
    }
    if image:
        files[IMAGE] = "".join(f"{byte:02x}\n" for byte in image)
    if winners is not None:
        files[WINNERS] = _words(winners)
    return files


def _words(codes: Codes) -> str:
    words = np.asarray(codes) & 0xFFFFFFFF
    return "".join(" ".join(f"{word:08x}" for word in row) + "\n" for row in words.tolist())


def _decided(design: Network) -> str:
    """The Verilog that checks the winner in each clock; empty where there is none."""
    if not design.argmax:
        return ""
    valid, index, margin = "winner_valid === 1'b1", "winner_index", "winner_margin"
    if design.stream == "axi_stream":
        valid = "taking && m_axis_tvalid === 1'b1 && m_axis_tlast === 1'b1"
        index = f"m_axis_tuser[{TUSER_HALF - 1}:0]"
        margin = f"m_axis_tuser[{2 * TUSER_HALF - 1}:{TUSER_HALF}]"
    elif design.stream in ("converter", "spi"):
        # An instrument goes on after the last frame.
        valid += " && decided < due"
    return _DECIDED.substitute(valid=valid, index=index, margin=margin)


def _load(design: Network) -> str:
    """The Verilog that sends the image; empty where there is none."""
    if not design.image:
        return ""
    if not isinstance(design, UartInstrument):
        return _LOAD.substitute(bytes=len(design.image))
    return _LOAD_LINE.substitute(load_numbers(design), bytes=len(design.image))
