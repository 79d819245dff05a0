"""Where each word of an image goes in lanes that can be reloaded."""

from myhdl import Signal, always_comb, block, concat, modbv

from golden.engine.formats import WIDTH, WORD_WIDTH
from golden.engine.image import Sizes
from hdl.common.signals import flag, unsigned


@block
def lane_image(*, write, write_addr, word, row, put, lane_put, lane_addr, lane_word, sizes: Sizes):
    """A word of an image is written to the program, to all lanes or to two of them.

    write, write_addr, word, bool, unsigned, unsigned 36 bits: A word of the image, as the loader
        gives it.
    row, unsigned ``sizes.program_addr_width`` bits: The address in the program memory.
    put: The word is one of the program.
    lane_put, lane_word: Whether each lane takes a word, and which.
    lane_addr, unsigned: The address in the memory of a lane, whose lower half holds the tables.

    The tables come first, for every lane. Behind them the low bits of the address say where a word
    goes, 0 to the program and from 1 on to two lanes each, and the bits above are the address
    there. The tables have a power of two of words, so these bits need only 1 less in the high ones.
    """
    table, low = sizes.table_words.bit_length() - 1, sizes.columns.bit_length() - 1
    top, bits = len(write_addr), len(row)
    part, joined = unsigned(low), unsigned(top - low)
    behind = Signal(modbv(0, min=0, max=1 << (top - table)))
    looked = flag()

    @always_comb
    def split():
        part.next = write_addr[low:]
        looked.next = write_addr[top:table] == 0
        behind.next = write_addr[top:table] - 1

    @always_comb
    def join():
        joined.next = concat(behind, write_addr[table:low])

    @always_comb
    def place():
        row.next = joined[bits:]
        put.next = write and part == 0 and not looked

    @always_comb
    def choose():
        if looked:
            lane_addr.next = write_addr[bits:]
        else:
            lane_addr.next = concat(True, row)

    shares = [
        lane_share(
            write=write,
            looked=looked,
            part=part,
            word=word,
            put=lane_put[j],
            share=lane_word[j],
            pair=1 + j // 2,
            low=j % 2 * WIDTH,
        )
        for j in range(sizes.lanes)
    ]
    return split, join, place, choose, shares


@block
def lane_share(*, write, looked, part, word, put, share, pair: int, low: int):
    """What one lane takes: tables, and its half of the words with the weights of two lanes."""
    top = low + WIDTH
    assert top <= WORD_WIDTH, "the weights of two lanes share a word"

    @always_comb
    def take():
        put.next = write and (looked or part == pair)
        share.next = word[top:low]

    return take
