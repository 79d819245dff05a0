"""image_loader: a stream of bytes becomes the words of the program memory."""

from myhdl import Signal, always, always_comb, always_seq, block, instances, intbv, modbv

from golden.engine.formats import WORD_WIDTH
from golden.engine.image import BEFORE_LAST, LAST_ADDR, WORD_BYTES
from golden.engine.image_loader import ImageLoader
from hdl.common import ops
from hdl.common.check_byte import check_byte
from hdl.common.signals import Stream, flag, unsigned


@block
def image_loader(
    clk,
    rst,
    load: Stream,
    *,
    busy,
    halt,
    write,
    write_addr,
    word,
    before_last,
    image_error,
    spec: ImageLoader,
):
    """Writes the words of an image, checks it, and stops the engine until a good one is there.

    Words come from the last to the first, so the address tells when all of them have come. Then
    the bytes of the check follow, and with the last of them everything must be right at once: the
    check, the number of bytes, and ``load_last``. Behind a header that names more words than the
    memory has, every byte is one too many. Reset forgets the image.
    """
    final_place = WORD_BYTES - 1
    held_width = 8 * final_place - (8 * WORD_BYTES - WORD_WIDTH)
    addr_low, samples_low = LAST_ADDR[0], BEFORE_LAST[0]
    addr_top = addr_low + spec.program_addr_width
    samples_top = samples_low + spec.operand_addr_width
    count_top = addr_low + LAST_ADDR[1]
    words = spec.words
    start = spec.check_start
    # The highest bits of a word's first byte are not used.
    held = unsigned(held_width)
    gathered = unsigned(WORD_WIDTH)
    place = unsigned(final_place.bit_length())
    addr = Signal(modbv(0, min=0, max=1 << spec.program_addr_width))
    samples = unsigned(spec.operand_addr_width)
    check, following = Signal(intbv(start, min=0, max=1 << 16)), unsigned(16)
    # All bits of the header's count: by its low bits alone a count that is too large could look
    # small enough.
    named = unsigned(LAST_ADDR[1])
    accept, full, fits, good, whole, failed = (flag() for _ in range(6))
    # These two flags tell what the next bytes are. With neither, they are the header; with headed
    # alone, words; with both, the check. With ended alone they are bytes that no good image has:
    # they follow a header that does not fit, or a check that did not end the image.
    headed, ended = flag(), flag()

    @always_comb
    def take():
        accept.next = load.valid and not busy

    gather = ops.join(held, load.data, gathered)
    look = ops.equal(place, final_place, full)
    measure = ops.bits(gathered, count_top, addr_low, named)
    compare = ops.less(named, words, fits)

    # The image is good if its last two bytes equal the check as it was before them.
    @always_comb
    def judge():
        good.next = headed and ended and place == 1 and check[8:] == 0 and check[16:8] == load.data

    add_byte = check_byte(check, load.data, following)

    @always_seq(clk.posedge, reset=rst)
    def step():
        if accept:
            if load.last:
                place.next = 0
                headed.next = False
                ended.next = False
            elif not full:
                place.next = place + 1
            else:
                place.next = 0
                if ended:
                    headed.next = False
                elif not headed:
                    headed.next = fits
                    ended.next = not fits
                elif addr == 0:
                    ended.next = True

    @always_seq(clk.posedge, reset=rst)
    def follow_check():
        if accept:
            if load.last:
                check.next = start
            else:
                check.next = following

    @always_seq(clk.posedge, reset=rst)
    def tell():
        if accept:
            whole.next = load.last and good
            if load.last:
                failed.next = not good

    @always(clk.posedge)
    def hold():
        if accept:
            held.next = gathered[held_width:]

    @always_seq(clk.posedge, reset=rst)
    def count():
        if accept and full:
            if headed:
                addr.next = addr - 1
            else:
                addr.next = gathered[addr_top:addr_low]
                samples.next = gathered[samples_top:samples_low]

    @always_comb
    def show():
        load.ready.next = not busy
        halt.next = accept or not whole
        write.next = accept and full and headed and not ended
        write_addr.next = addr
        word.next = gathered
        before_last.next = samples
        image_error.next = failed

    return instances()
