"""load_profile: draws the load along the beam, position by position."""

from myhdl import always, always_comb, always_seq, block, instances

from golden.numbers.fixed import Rounding
from golden.visualisation.load_profile import DISTANCE_CLOCKS, RECTANGLE, TRIANGLE, LoadProfile
from hdl.common import ops
from hdl.common.delay import connect, delay
from hdl.common.requantise import requantise
from hdl.common.signals import Stream, fixed, flag, signed, unsigned
from hdl.visualisation.divider import divider
from hdl.visualisation.exp_interpolator import exp_interpolator
from hdl.visualisation.exp_memory import exp_memory
from hdl.visualisation.power_fold import power_fold
from hdl.visualisation.ramp import ramp


@block
def results(clk, enable, in_words, out_words):
    """The four results of a frame, which are all taken in a clock with ``enable``."""
    load, position, width, shape = in_words
    load_held, position_held, width_held, shape_held = out_words

    @always(clk.posedge)
    def keep():
        if enable:
            load_held.next = load
            position_held.next = position
            width_held.next = width
            shape_held.next = shape

    return keep


@block
def distance_from(clk, x, centre, distance):
    """``distance`` is the magnitude of ``x - centre``, two clocks later."""
    sign = len(x)
    difference = signed(len(x) + 1)
    wide, opposite = signed(len(x) + 2), signed(len(x) + 2)

    @always(clk.posedge)
    def subtract():
        difference.next = x - centre

    @always(clk.posedge)
    def keep():
        if difference[sign]:
            distance.next = opposite[sign:]
        else:
            distance.next = difference[sign:]

    return subtract, ops.widen(difference, wide), ops.negate(wide, opposite), keep


@block
def load_profile(clk, rst, in_: Stream, out: Stream, *, spec: LoadProfile):
    """One ramp of points for the results of a frame (equation 3.18, thesis Figure 5.25).

    Three multipliers. One point at a time: the first stands ``spec.latency`` clocks
    after ``in_valid``, each of the others as many after the one before. Results that come during
    a ramp wait until the clock after its last point, and are replaced by others that come
    meanwhile; they never change the ramp that is being drawn. Reset ends the ramp and forgets
    results that wait.
    """
    fmt = spec.fmt
    magnitude_width = fmt.width - 1
    threshold, low_power, high_power = spec.shape_threshold, TRIANGLE, RECTANGLE
    offset_width = spec.exp_interpolator.offset_width
    word_width = spec.exp_interpolator.word_width
    x_width = spec.power_fold.out_width
    next_results = [fixed(fmt) for _ in range(4)]
    held_results = [fixed(fmt) for _ in range(4)]
    load, centre, width, shape = held_results
    waiting, busy, restart, again, ask = flag(), flag(), flag(), flag(), flag()
    x_valid, x_last, x = flag(), flag(), fixed(fmt)
    distance_valid, distance = flag(), unsigned(spec.divider.distance_width)
    positive_width = unsigned(magnitude_width)
    t_valid, t = flag(), unsigned(spec.divider.out_width)
    power = unsigned(spec.power_fold.power_width)
    power_valid, powered = flag(), unsigned(x_width)
    addr, offset = unsigned(x_width - offset_width), unsigned(offset_width)
    word_valid, word = flag(), unsigned(word_width)
    value_valid, value = flag(), unsigned(word_width)
    wide_value = signed(word_width + 1)
    product_valid, product = flag(), signed(fmt.width + word_width)
    height = fixed(fmt)
    point_valid, point_last = flag(), flag()
    measured = Stream(valid=distance_valid, distance=distance, width=positive_width)
    quotient = Stream(valid=t_valid, data=t, power=power)
    raised = Stream(valid=power_valid, data=powered)
    looked_up = Stream(valid=word_valid, word=word, offset=offset)
    exponential = Stream(valid=value_valid, data=value)

    take_results = results(
        clk, in_.valid, [in_.load, in_.position, in_.width, in_.shape], next_results
    )
    hold_results = results(clk, restart, next_results, held_results)

    @always_comb
    def start():
        restart.next = waiting and not busy
        ask.next = again or (waiting and not busy)

    @always_seq(clk.posedge, reset=rst)
    def advance():
        if in_.valid:
            waiting.next = True
        elif restart:
            waiting.next = False
        if restart:
            busy.next = True
        elif point_valid and point_last:
            busy.next = False
        again.next = point_valid and not point_last

    draw = ramp(clk, rst, Stream(valid=x_valid, data=x, last=x_last), in_valid=ask, spec=spec.ramp)
    measure = distance_from(clk, x, centre, distance)
    wait_for_distance = delay(clk, rst, x_valid, distance_valid, clocks=DISTANCE_CLOCKS)

    # For the divider a width of 0 is the narrowest load. A width below 0 counts as 0.
    @always_comb
    def clip():
        if width[magnitude_width]:
            positive_width.next = 0
        else:
            positive_width.next = width[magnitude_width:]

    divide = divider(clk, rst, measured, quotient, spec=spec.divider)

    @always_comb
    def choose():
        if shape > threshold:
            power.next = low_power
        else:
            power.next = high_power

    raise_power = power_fold(clk, rst, quotient, raised, spec=spec.power_fold)

    @always_comb
    def split():
        addr.next = powered[:offset_width]
        offset.next = powered[offset_width:]

    look_up = exp_memory(clk, addr, word, spec=spec.exp_memory)
    wait_for_word = delay(clk, rst, power_valid, word_valid, clocks=spec.exp_memory.latency)
    interpolate = exp_interpolator(clk, rst, looked_up, exponential, spec=spec.exp_interpolator)
    widen_value = connect(value, wide_value)

    @always(clk.posedge)
    def multiply():
        product.next = load * wide_value

    wait_for_product = delay(clk, rst, value_valid, product_valid, clocks=1)
    round_height = requantise(product, height, shift=word_width, rounding=Rounding.ROUND)

    @always_seq(clk.posedge, reset=rst)
    def finish():
        point_valid.next = product_valid
        point_last.next = product_valid and x_last

    @always(clk.posedge)
    def keep():
        if product_valid:
            out.x.next = x
            out.y.next = height

    @always_comb
    def show():
        out.valid.next = point_valid
        out.last.next = point_last

    return instances()
