"""Shows the points of a profile slowly, one after the other."""

from myhdl import always_seq, block

from hdl.common.signals import Stream, unsigned


@block
def next_point(clk, rst, profile: Stream, *, shown, number, x, y, points: int):
    """``number``, ``x`` and ``y`` show one point of the newest profile.

    After a clock with ``shown`` they wait for the next point and change to it when it comes. Until
    then every new profile brings new values of the same point.
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
