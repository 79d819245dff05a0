"""A first-in first-out memory (FIFO)."""

from myhdl import Signal, always, always_comb, always_seq, block, instances, intbv

from hdl.common.signals import Stream, flag, unsigned


@block
def turn(clk, rst, step, addr, *, stop: int):
    """``addr`` counts the clocks of ``step`` from 0 to ``stop`` and then begins at 0 again."""

    @always_seq(clk.posedge, reset=rst)
    def count():
        if step:
            if addr == stop:
                addr.next = 0
            else:
                addr.next = addr + 1

    return count


@block
def fifo(clk, rst, in_: Stream, out: Stream, *, fetch, depth: int):
    """Words leave in the order in which they came; each stays until it is taken.

    in_: A word comes with ``in_.valid``; the memory must have room for it.
    out: A word leaves in a clock in which both flags are high, and stays until then.
    fetch: In this clock a word leaves the memory for ``out.data``.
    depth: How many words the memory holds, at least 1. The register ``out.data`` holds one more.

    The latency is 2 clocks, and one word can pass per clock. ``out.valid`` and ``out.data`` are
    registers. The memory is read at a clock edge, and never at the edge that writes the same word.
    Reset empties it.
    """
    memory = [Signal(intbv(0, min=in_.data.min, max=in_.data.max)) for _ in range(depth)]
    write_addr, read_addr = (unsigned(max(1, (depth - 1).bit_length())) for _ in range(2))
    stored = unsigned(depth.bit_length())
    full, take = flag(), flag()
    last_addr = depth - 1

    @always_comb
    def decide():
        take.next = stored != 0 and (out.ready or not full)

    @always(clk.posedge)
    def write():
        if in_.valid:
            memory[write_addr].next = in_.data

    @always(clk.posedge)
    def read():
        if take:
            out.data.next = memory[read_addr]

    @always_seq(clk.posedge, reset=rst)
    def count():
        if in_.valid and not take:
            stored.next = stored + 1
        elif take and not in_.valid:
            stored.next = stored - 1
        full.next = take or (full and not out.ready)

    @always_comb
    def show():
        out.valid.next = full
        fetch.next = take

    count_writes = turn(clk, rst, in_.valid, write_addr, stop=last_addr)
    count_reads = turn(clk, rst, take, read_addr, stop=last_addr)

    return instances()
