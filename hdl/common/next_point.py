"""A profile, slowly."""

from myhdl import always_seq, block

from hdl.common.signals import Stream, unsigned


@block
def next_point(clk, rst, profile: Stream, *, shown, number, x, y, points: int):
    """Point after point of a profile, each of the newest one.

    ``number``, ``x`` and ``y`` change to the next point, when it comes, after a clock of ``shown``.
    """
    final = points - 1
    width = max(1, final.bit_length())
    place, wanted = unsigned(width), unsigned(width)

    @always_seq(clk.posedge, reset=rst)
    def count():
        if profile.valid:
            if profile.last:
                place.next = 0
            else:
                place.next = place + 1

    @always_seq(clk.posedge, reset=rst)
    def keep():
        if profile.valid and place == wanted:
            number.next = place
            x.next = profile.x
            y.next = profile.y

    @always_seq(clk.posedge, reset=rst)
    def ask():
        if shown:
            if number == final:
                wanted.next = 0
            else:
                wanted.next = number + 1

    return count, keep, ask
