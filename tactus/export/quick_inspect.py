"""Lets MyHDL look at its callers and their source without reading the same files again and again.

MyHDL 0.11 asks for the call stack with its source lines at every instance, and for the source of a
generator whenever it is instantiated. That takes most of the time of an export.
"""

import inspect
import sys
from functools import cache
from types import SimpleNamespace

from myhdl import _block, _instance, _util

from tactus.export.local_names import Caller, forget


def _once(function):
    """``function``, whose answer for a Python function holds for all closures of the same code."""
    answers = {}

    def remembered(subject):
        code = inspect.unwrap(subject).__code__
        if code not in answers:
            answers[code] = function(subject)
        return answers[code]

    return remembered


def _stack():
    """The callers and the names of their functions, in the same places as in ``inspect.stack``."""
    frames = []
    frame = sys._getframe(1)
    while frame is not None:
        frames.append(frame)
        frame = frame.f_back
    forget(frames)
    return [
        (Caller(frame), frame.f_code.co_filename, frame.f_lineno, frame.f_code.co_name)
        for frame in frames
    ]


def install() -> None:
    """Replace the module ``inspect`` in those parts of MyHDL that call it too often."""
    quick = SimpleNamespace(**vars(inspect))
    quick.stack = _stack
    for name in ("getsource", "getsourcefile", "getsourcelines"):
        setattr(quick, name, _once(getattr(inspect, name)))
    for module in (_block, _instance, _util):
        module.inspect = quick
    _util._dedent = cache(_util._dedent)
