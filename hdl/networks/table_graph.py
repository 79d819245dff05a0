"""Table graph: a network of learned functions as small tables and sums, a frame every clock."""

from myhdl import always, always_comb, block, concat

from golden.networks.small_tables import SmallTable
from golden.networks.table_graph import TableGraph
from golden.numbers.precision import SIGNAL
from hdl.common import ops
from hdl.common.delay import connect, delay
from hdl.common.rom import rom
from hdl.common.signals import Stream, Words, fixed, flag, unsigned
from hdl.layers.argmax_tree import argmax_tree
from hdl.layers.constant_matrix import constant_matrix
from hdl.networks.adder_graph import never


@block
def address_of(word, address, *, table: SmallTable, start: int):
    """The bits of a word that address a table; ``start`` is the lowest bit that tables read."""
    part = table.part
    count = len(word)
    above, high, low = count - part.top, start + part.high, start + part.low

    if part.high == part.low:
        return ops.bits(word, count, above, address)
    if not part.top:
        return ops.bits(word, high, low, address)

    @always_comb
    def look():
        address.next = concat(word[count:above], word[high:low])

    return look


@block
def small_table(clk, word, found, *, table: SmallTable, start: int):
    """What a table holds for a word, one clock later."""
    address, code = unsigned(table.part.width), unsigned(table.width)
    codes = [value & (1 << table.width) - 1 for value in table.words]

    @always(clk.posedge)
    def keep():
        found.next = code.signed()

    return (
        address_of(word, address, table=table, start=start),
        rom(address, code, words=codes),
        keep,
    )


@block
def table_graph(
    clk, rst, in_: Stream, out: Stream, *, frame_error, winner: Stream, spec: TableGraph
):
    """A frame of samples in one clock, all outputs in another, from tables and adders.

    Latency: ``spec.latency`` clocks, a frame every clock. Reset clears the valid flags.
    """
    words, later = (
        Words(matrix.inputs, lambda fmt=matrix.in_fmt: fixed(fmt))
        for matrix in (spec.hidden, spec.output)
    )
    sums = Words(len(spec.hidden.weights), lambda: fixed(spec.hidden.out_fmt))
    # An output port cannot be read.
    y = Words(spec.outputs if spec.argmax else 0, lambda: fixed(SIGNAL))
    y_valid = flag()
    unread = len(in_.data[0]) - spec.sample_bits
    for k in range(spec.inputs):
        # MyHDL refuses a port that nothing reads.
        in_.data[k].read = True
    return (
        [
            small_table(clk, in_.data[table.source], words[n], table=table, start=unread)
            for n, table in enumerate(spec.first)
        ],
        constant_matrix(clk, words, sums, spec=spec.hidden),
        [
            small_table(clk, sums[table.source], later[n], table=table, start=0)
            for n, table in enumerate(spec.second)
        ],
        constant_matrix(clk, later, y if spec.argmax else out.data, spec=spec.output),
        delay(clk, rst, in_.valid, y_valid if spec.argmax else out.valid, clocks=spec.latency),
        never(clk, frame_error),
        [
            [connect(y[i], out.data[i]) for i in range(len(y))],
            connect(y_valid, out.valid),
            argmax_tree(clk, y, winner, spec=spec.argmax),
            delay(clk, rst, y_valid, winner.valid, clocks=spec.argmax.latency),
        ]
        if spec.argmax
        else [],
    )
