"""The fields of a program's word. A field is a pair: its lowest bit and its number of bits."""

from typing import TypeVar

from golden.engine.formats import WIDTH
from golden.numbers.fixed import Codes

Bits = TypeVar("Bits", int, Codes)


def put(words: list[int], place: int, field: tuple[int, int], value: int) -> None:
    """Write a field of one of the words, where the field must hold 0 before."""
    low, bits = field
    words[place] |= (int(value) & ((1 << bits) - 1)) << low


def get(word: int, field: tuple[int, int]) -> int:
    """The bits of a field."""
    low, bits = field
    return (word >> low) & ((1 << bits) - 1)


def signed_code(bits: Bits) -> Bits:
    """Read bits of a word's width as a signed code; from an array, each element."""
    return bits - ((bits >> (WIDTH - 1)) << WIDTH)
