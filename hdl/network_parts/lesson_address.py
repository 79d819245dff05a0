"""From an address of a program that learns to the address of a word in the operand memory."""

from myhdl import always_comb, block, concat

from golden.learning.places import Places
from hdl.common.signals import flag, unsigned


@block
def lesson_address(address, bank, number, mapped, *, places: Places):
    """The bank of theta, or the number of a placement, in the place that the program leaves.

    address: unsigned ``places.addr_width`` bits.
    number: unsigned ``places.number_width`` bits.
    mapped: unsigned ``places.addr_width`` bits.
    """
    width, low, bank_bit = places.addr_width, places.placement_width, places.bank_bit
    top, of_theta, behind = width - 1, width - 2, places.bank_bit + 1
    kept, rest = flag(), unsigned(low)

    @always_comb
    def cut():
        kept.next = address[top]
        rest.next = address[low:]

    @always_comb
    def choose():
        if kept:
            mapped.next = concat(kept, number, rest)
        elif address[of_theta]:
            mapped.next = concat(address[width:behind], bank, address[bank_bit:])
        else:
            mapped.next = address

    return cut, choose
