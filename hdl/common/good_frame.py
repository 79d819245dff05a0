"""The words of a frame that was found good."""

from myhdl import block

from golden.layers.input_controller import InputController
from golden.precision import SIGNAL
from hdl.common.delay import delay
from hdl.common.signals import fixed, flag, unsigned
from hdl.common.stream import catch
from hdl.layers.input_controller import input_controller


@block
def good_frame(
    clk, rst, valid, data, last, words, good, frame_error, *, controller: InputController
):
    """``words`` are those of a whole frame in the clock of ``good``; a wrong one gives its error.

    The controller tells of a good frame some clocks after its last element. The words are caught
    as much later less one: then they are complete, and the next frame has replaced none of them.
    """
    elements = len(words)
    clocks = controller.latency - 1
    late_valid, late_data, late_last = flag(), fixed(SIGNAL), flag()
    addr = unsigned(controller.addr_width)
    # Left open.
    preset, accumulate, capture = flag(), flag(), flag()

    return (
        input_controller(
            clk,
            rst,
            valid,
            last,
            addr,
            preset,
            accumulate,
            capture,
            good,
            frame_error,
            spec=controller,
        ),
        delay(clk, rst, valid, late_valid, clocks=clocks),
        delay(clk, None, data, late_data, clocks=clocks),
        delay(clk, rst, last, late_last, clocks=clocks),
        catch(clk, rst, late_valid, late_data, late_last, words, first=0, slots=elements),
    )
