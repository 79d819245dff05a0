"""The check of what is sent, byte by byte."""

from myhdl import always_comb, block

from hdl.common.signals import unsigned


@block
def check_byte(check, data, following):
    """The check behind a byte: CRC-16, polynomial x^16 + x^12 + x^5 + 1, highest bit first."""
    mixed, spread = unsigned(8), unsigned(8)

    @always_comb
    def mix():
        mixed.next = check[16:8] ^ data

    @always_comb
    def fold():
        spread.next[8:4] = mixed[8:4]
        spread.next[4:] = mixed[8:4] ^ mixed[4:]

    # The check moves up by a byte; spread is added three times, moved up by 12, 5 and 0 bits.
    @always_comb
    def follow():
        following.next[16:13] = check[8:5] ^ spread[4:1]
        following.next[12] = check[4] ^ spread[0] ^ spread[7]
        following.next[12:8] = check[4:] ^ spread[7:3]
        following.next[8:5] = spread[8:5] ^ spread[3:]
        following.next[5:] = spread[5:]

    return mix, fold, follow
