"""Signals by format, and groups of signals that become ports."""

from collections.abc import Callable

from myhdl import ResetSignal, Signal, intbv

from golden.numbers.fixed import Fix


def flag():
    """A single bit, cleared by reset."""
    return Signal(bool(0))


def reset():
    """The synchronous reset, active high."""
    return ResetSignal(0, active=1, isasync=False)


def signed(width: int):
    """A signed signal of ``width`` bits."""
    return Signal(intbv(0, min=-(1 << (width - 1)), max=1 << (width - 1)))


def unsigned(width: int):
    """An unsigned signal of ``width`` bits."""
    return Signal(intbv(0, min=0, max=1 << width))


def fixed(fmt: Fix):
    """A signed signal that carries codes of ``fmt``."""
    return signed(fmt.width)


class Words:
    """Several signals as one port: ``name`` becomes the ports ``name_0``, ``name_1``, ...

    MyHDL refuses lists of signals as ports of a top block and flattens objects by attribute; the
    attributes here are the numbers.
    """

    def __init__(self, count: int, make: Callable):
        self.__dict__.update({str(i): make() for i in range(count)})

    def __len__(self):
        return len(self.__dict__)

    def __getitem__(self, index: int):
        return self.__dict__[str(range(len(self))[index])]


class Group:
    """Several signals as one port: ``name`` becomes ``name_x`` for each keyword x, if any."""

    def __init__(self, **signals):
        self.__dict__.update(signals)


class Stream(Group):
    """The signals of a stream, which travel together: ``valid``, and what is valid with it.

    The parameter ``out`` of a block becomes the ports ``out_valid``, ``out_data``, ... in the place
    that the twin gives them. The parameter ``in_`` becomes ``in_valid``, ``in_data``, ...; it has
    an underscore because ``in`` is a word of Python. A block has the ports that its twin publishes,
    and does not use the other signals of a stream.
    """
