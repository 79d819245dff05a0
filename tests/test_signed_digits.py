"""Tests canonical signed digits: they give the right number, and no form has fewer."""

from itertools import product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from golden.numbers.signed_digits import digit_counts, nearest_with, short_forms, signed_digits


@given(st.integers())
def test_they_stand_for_the_number(number):
    assert sum(sign << place for place, sign in signed_digits(number)) == number


def test_no_other_form_has_fewer():
    """No number that so many digits in ten places can form is written with more digits."""
    fewest = {0: 0}
    for count in range(1, 6):
        for number in list(fewest):
            for place in range(10):
                for sign in (1, -1):
                    fewest.setdefault(number + (sign << place), count)
    checked = [number for number in range(-200, 201) if number in fewest]
    assert len(checked) == 401
    for number in checked:
        assert len(signed_digits(number)) == fewest[number]


def test_short_forms_are_all_forms_of_so_few_digits():
    every = {}
    for signs in product((-1, 0, 1), repeat=9):
        form = tuple((place, sign) for place, sign in enumerate(signs) if sign)
        every.setdefault(sum(sign << place for place, sign in form), set()).add(form)
    for number in range(-40, 41):
        for most in range(len(signed_digits(number)) + 2):
            fitting = {form for form in every[number] if len(form) <= most}
            found = short_forms(number, most)
            assert set(found) == fitting
            assert len(found) == len(fitting)


@given(st.floats(-1000, 1000), st.integers(0, 5))
def test_no_number_of_so_few_digits_is_nearer(value, most):
    """It is compared with all numbers below twice its value."""
    (found,) = nearest_with(np.array([value]), most)[most]
    assert len(signed_digits(int(found))) <= most
    numbers = np.arange(-2048, 2049)
    least = np.abs(numbers[digit_counts(numbers) <= most] - value).min()
    assert abs(found - value) == least
