"""Images of random networks, for the benches of engines that load their program."""

from collections.abc import Iterable
from contextlib import suppress

from golden.engine.image import Image
from golden.input_error import InputError
from golden.networks.engine import Engine
from golden.trained.dense import DenseNetwork, Quantiser
from golden.trained.function import Function
from tb.common.cases import random_mlp, random_network


def images_with_room(hardware: Engine, networks: Iterable[DenseNetwork]) -> list[Image]:
    """The images of those networks for which an engine has room.

    A user's engine may have room for its own network alone. That image is the only one then.
    """
    found: list[Image] = []
    for network in networks:
        with suppress(InputError):
            found.append(hardware.image_for([network]))
    assert hardware.loaded is not None
    return found or [hardware.loaded]


def networks_of_other_depth(quantiser: Quantiser | None) -> list[DenseNetwork]:
    """Networks with one to four hidden layers, which fit hardware with ReLU.

    ``quantiser`` is the one that stands behind the layers of the hardware's own network, if any.
    The first network has no ReLU and no quantiser.
    """
    kinds = ("linear", "relu") if quantiser else ("relu", "tanh", "leaky_relu", "sigmoid")
    found: list[DenseNetwork] = [random_mlp((4, 2, 1), 1.0, seed=1)]
    for depth in (4, 1, 2):
        hidden = tuple(kinds[n % len(kinds)] for n in range(depth))
        shape = (2 + depth, *(2 + n % 2 for n in range(depth)), 2)
        found.append(random_network(shape, hidden, 1.5, seed=depth, quantiser=quantiser))
    return found


def networks_of_other_functions() -> list[DenseNetwork]:
    """Networks whose tables take one block, three, or fewer than three, and one of tanh."""
    soft, wave = Function("soft", "x / (1 + abs(x))"), Function("wave", "x * (3 - abs(x)) / 8")
    bent = Function("bent", "x * x / 64 - x / 4")
    # The last node of a hidden layer has no effect.
    kinds = ("tanh", "table:wave", "table:bent,wave,wave", "table:soft,bent,bent", "table:bent")
    return [
        random_network((3, 3, 2), (kind,), 2.0, seed, functions=(soft, wave, bent))
        for seed, kind in enumerate(kinds)
    ]
