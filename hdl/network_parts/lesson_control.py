"""Decides when an engine that learns computes a frame, keeps a placement, or takes a step."""

from myhdl import always_comb, always_seq, block

from golden.networks.learning_engine import LearningEngine
from hdl.common.signals import flag


@block
def lesson_control(
    clk,
    rst,
    *,
    stops,
    waits,
    ready,
    learn,
    opening,
    studying,
    goes,
    finish,
    keep_run,
    putting,
    bad,
    bank,
    stepped,
    shown,
    written,
    equation,
    learn_error,
    design: LearningEngine,
):
    """Begins equations in the clocks that are free, and says to which placement they belong.

    stops: A sample or a known output comes in: an equation that runs is stopped, and begins anew
        later.
    waits: No equation begins.
    ready: Neither a frame nor a placement is computed or kept.
    learn: Equations may begin.
    opening, studying: An equation runs: the clock before its first step, and all others.
    goes: The clock before ``opening``.
    finish: The last result of the part that runs is stored.
    keep_run: That part keeps a placement.
    putting: Not so if this is high: theta has come in, and is the one that is read from then on.
    bad: A word of the new theta was saturated, so the step is not taken.
    bank: Where the theta is that is read.
    stepped: A step has been taken since reset.
    shown, written, unsigned: The placement of the equation, and the one that is written next.
    equation, unsigned: Which output the equation is of.
    learn_error: High for one clock after a step that is not taken.
    """
    final = design.outputs - 1
    passed, kept, put, none, full = (flag() for _ in range(5))
    most = (1 << design.program.places.number_width) - 1

    @always_comb
    def judge():
        passed.next = finish and studying
        kept.next = finish and keep_run and not putting
        put.next = finish and keep_run and putting
        none.next = shown == written

    @always_comb
    def decide():
        goes.next = learn and ready and not (none or opening or studying or waits)

    @always_seq(clk.posedge, reset=rst)
    def open_equation():
        opening.next = goes
        if stops or passed:
            studying.next = False
        elif opening:
            studying.next = True

    @always_seq(clk.posedge, reset=rst)
    def exchange():
        learn_error.next = passed and bad
        if put or (passed and not bad):
            bank.next = not bank
            stepped.next = True

    # A placement that is being written is not shown.
    @always_seq(clk.posedge, reset=rst)
    def follow():
        if kept:
            shown.next = written
            written.next = written + 1
            equation.next = 0
            full.next = full or written == most
        elif passed and equation == final:
            shown.next = shown + 1
            equation.next = 0
        elif passed:
            equation.next = equation + 1
        elif none and full:
            shown.next = shown + 1
        elif none:
            shown.next = 0

    return judge, decide, open_equation, exchange, follow
