"""A checksum (CRC-16) that takes one byte at a time."""

from myhdl import always_comb, block

from hdl.common.signals import unsigned


@block
def check_byte(check, data, following):
    """``following`` is the checksum ``check`` after one more byte, ``data``.

    The checksum is a CRC-16 with the polynomial x^16 + x^12 + x^5 + 1. It takes the highest bit of
    a byte first.
    """
    mixed, spread = unsigned(8), unsigned(8)

    @always_comb
    def mix():
        mixed.next = check[16:8] ^ data

    @always_comb
    def fold():
        spread.next[8:4] = mixed[8:4]
        spread.next[4:] = mixed[8:4] ^ mixed[4:]

    # The checksum moves up by a byte. Then spread is added three times without carry: moved up by
    # 12 bits, by 5 bits, and not moved.
    @always_comb
    def follow():
        following.next[16:13] = check[8:5] ^ spread[4:1]
        following.next[12] = check[4] ^ spread[0] ^ spread[7]
        following.next[12:8] = check[4:] ^ spread[7:3]
        following.next[8:5] = spread[8:5] ^ spread[3:]
        following.next[5:] = spread[5:]

    return mix, fold, follow
