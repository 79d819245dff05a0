"""Files and listings that pages describe, compared with what the twins compute."""

import numpy as np
import pytest
from shared import Shared

from golden.common.block import walk
from golden.layers.listing import listing
from golden.networks.adder_graph import AdderGraph
from golden.networks.engine import Engine
from tactus.scene.image import hex_text
from tactus.verify.benches.collected import CASES_OF

pytestmark = pytest.mark.pages


def test_hex_is_padded_to_the_memory_and_bin_is_not(shared: Shared) -> None:
    for name in ("digit-reload", "rails-reload", "deep-reload"):
        (engine,) = (b for b in walk(shared.scene(name).twin()) if isinstance(b, Engine))
        image = engine.loaded
        assert image is not None
        lines, count = hex_text(image).split(), len(image.words)
        assert len(lines) == image.sizes.program_words > count, name
        assert set(lines[count:]) == {"000000000"}
        assert [int(line, 16) for line in lines[:count]] == list(image.words)
        assert len(image.to_bytes()) == 5 + 5 * count + 2


@pytest.fixture(scope="module", params=["digit-fast", *CASES_OF["adder_graph"]])
def adders(request: pytest.FixtureRequest, shared: Shared) -> AdderGraph:
    core = shared.scene(request.param).twin().core
    assert isinstance(core, AdderGraph)
    return core


def test_a_listing_computes_what_the_matrix_does(adders: AdderGraph) -> None:
    rng = np.random.default_rng(1)
    for matrix in adders.layers:
        frames = rng.integers(matrix.in_fmt.low, matrix.in_fmt.high + 1, (50, matrix.inputs))
        names = {f"in_data_{k}": frames[:, k] for k in range(matrix.inputs)}
        for line in listing(matrix)[2:]:
            name, _, what = line.split(maxsplit=2)
            names[name] = eval(what, {"__builtins__": {}}, names)
        results = [names[f"out_data_{i}"] for i in range(len(matrix.weights))]
        # A row without weights is a constant.
        found = np.stack([np.broadcast_to(one, len(frames)) for one in results], axis=-1)
        low, high = matrix.out_fmt.low, matrix.out_fmt.high
        assert np.array_equal(np.clip(found, low, high), matrix.process(frames))
