"""Tests that the recorded inputs of inner blocks are those with which the design computes."""

import numpy as np
import pytest

from golden.activation.gradient import Gradient
from golden.common.block import around, walk
from golden.input_error import InputError
from golden.instruments.block_inputs import seen
from golden.instruments.readout import Readout
from golden.layers.input_controller import InputController
from golden.layers.input_integral import InputIntegral
from golden.layers.output_integral import OutputIntegral
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.visualisation.load_profile import LoadProfile
from tactus.scene import Scene, load_scene


def part_of(design: Network, kind: type) -> list:
    return [part for part in walk(design) if isinstance(part, kind)]


def frames_of(scene: Scene) -> Codes:
    return scene.vectors().codes


def test_the_layers_of_a_network(small_scene: Scene) -> None:
    design, frames = small_scene.twin(), frames_of(small_scene)
    (first,), (last,) = part_of(design, InputIntegral), part_of(design, OutputIntegral)
    (samples,), (activations,) = seen(design, first, frames), seen(design, last, frames)
    assert (samples == frames).all()
    assert (last.process(activations) == design.process(frames)).all()


def test_a_later_network_of_a_cascade_sees_earlier_outputs(small_cascade: Scene) -> None:
    design, frames = small_cascade.twin(), frames_of(small_cascade)
    outputs = design.process(frames)
    for number, layer in enumerate(part_of(design, InputIntegral)):
        (samples,) = seen(design, layer, frames)
        expected = np.concatenate([frames, outputs[:, :number]], axis=1)
        assert (samples == expected).all()


def test_parts_of_the_activations_of_the_thesis() -> None:
    """The inputs of all neurons with a part follow in order, and only for recorded frames."""
    scene = load_scene("digit-thesis")
    design, frames = scene.twin(), frames_of(scene)
    (sign,) = {gradient.sign_retriever for gradient in part_of(design, Gradient)}
    holders = [block for block in around(design, sign) if isinstance(block, Gradient)]
    results = [gradient.process(*seen(design, gradient, frames)) for gradient in holders]
    assert (sign.process(*seen(design, sign, frames)) == np.concatenate(results)).all()
    for gradient in holders:
        mag, coeff, intercept = seen(design, gradient.grad_eqn, frames)
        (addr,) = seen(design, gradient.g_memory, frames)
        assert (coeff == gradient.g_memory.process(addr)).all()
        assert (intercept == gradient.i_memory.process(addr)).all()
        assert len(mag) % len(frames) == 0


def test_parts_of_the_profile_of_the_thesis() -> None:
    """What enters each part leads from the outputs of the networks to the points of the profile."""
    scene = load_scene("thesis")
    design, frames = scene.twin(), frames_of(scene)
    (readout,), (profile,) = part_of(design, Readout), part_of(design, LoadProfile)
    outputs = design.process(frames)[:, list(readout.results)]
    positions, heights = profile.process(outputs)
    load, centre, width, shape = (np.repeat(column, len(positions)) for column in outputs.T)

    assert seen(design, profile.ramp, frames) == ()
    distance, clipped = seen(design, profile.divider, frames)
    assert (distance == np.abs(np.tile(positions, len(frames)) - centre)).all()
    assert (clipped == np.maximum(width, 0)).all()
    t, power = seen(design, profile.power_fold, frames)
    assert (t == profile.divider.process(distance, clipped)).all()
    assert (power == np.where(shape > profile.shape_threshold, 2, 6)).all()
    (addr,) = seen(design, profile.exp_memory, frames)
    word, offset = seen(design, profile.exp_interpolator, frames)
    bits = profile.exp_interpolator.offset_width
    assert ((addr << bits) + offset == profile.power_fold.process(t, power)).all()
    assert (word == profile.exp_memory.process(addr)).all()
    value = profile.exp_interpolator.process(word, offset)
    shift = profile.exp_interpolator.word_width
    assert ((load * value + (1 << (shift - 1))) >> shift == heights.ravel()).all()


def test_a_block_whose_inputs_are_no_numbers_is_refused(small_scene: Scene) -> None:
    design = small_scene.twin()
    (controller,) = part_of(design, InputController)
    with pytest.raises(InputError, match=r"input_controller.*does not compute it on its own"):
        seen(design, controller, frames_of(small_scene))
    # The recording leaves nothing behind.
    (layer,) = part_of(design, InputIntegral)
    assert type(layer).process.__qualname__ == "InputIntegral.process"
