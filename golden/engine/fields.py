"""Fields of a program's word: lowest bit, and bits."""

from __future__ import annotations

from typing import TypeVar

from golden.engine.formats import WIDTH
from golden.fixed import Codes

Bits = TypeVar("Bits", int, Codes)


def put(words: list[int], place: int, field: tuple[int, int], value: int) -> None:
    """Write a field of one of the words, which holds 0 there."""
    low, bits = field
    words[place] |= (int(value) & ((1 << bits) - 1)) << low


def get(word: int, field: tuple[int, int]) -> int:
    """The bits of a field."""
    low, bits = field
    return (word >> low) & ((1 << bits) - 1)


def signed_code(bits: Bits) -> Bits:
    """The code of a word's width that bits stand for; of an array, each."""
    return bits - ((bits >> (WIDTH - 1)) << WIDTH)
