"""The designs that are compared for a scene, and what each of them would cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import le

import numpy as np

from golden.activation.schemes import SCHEMES
from golden.input_error import InputError
from golden.networks.arrangement import arrange, process_real
from golden.networks.design import Settings
from golden.networks.designs import DESIGNS
from golden.networks.engine import Engine
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL, Precision
from golden.trained.dense import DenseNetwork, tanh
from tactus.sizing.features import block_rams, features_of, multipliers
from tactus.sizing.model import Size, path_of, routed_size, routed_spread, size_of, spread


@dataclass(frozen=True)
class Candidate:
    """A design with the options that make it another one.

    design: A name of ``DESIGNS``.
    options: Keys of a scene's section ``[hardware]``.
    """

    design: str
    options: Mapping[str, object] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return ", ".join([self.design, *(f"{key} {self.options[key]}" for key in self.options)])


# Options that a scene's own design does not keep: what the candidates of an engine differ
# in, and what belongs to one that is loaded.
LEFT_OUT = (
    *("lanes", "pipeline"),
    *("reload", "program_words", "operand_words", "table_blocks"),
)


def adders(count: int) -> Candidate:
    # One run of the search takes a moment; more of them save some per cent of the adders.
    return Candidate("adder_graph", {"adders_per_clock": count, "search_runs": 1})


def tables(count: int, **bits: int) -> Candidate:
    """Small tables of learned functions, with at most so many adders between two registers.

    ``bits`` are further keys of the design: the bits of samples, of hidden sums, of outputs.
    """
    return Candidate("table_graph", {"adders_per_clock": count, **bits})


def lanes(count: int) -> Candidate:
    return Candidate("engine", {"lanes": count})


SHORT = lanes(1)
DEEP = Candidate("engine", {"lanes": 1, "pipeline": "deep"})
HYBRID, PARALLEL = Candidate("hybrid"), Candidate("parallel")
# A design more is a line here.
CANDIDATES = (
    SHORT,
    DEEP,
    *map(lanes, (2, 4, 8, 16)),
    HYBRID,
    PARALLEL,
    adders(5),
    adders(2),
    adders(1),
    tables(5),
    tables(2),
    tables(1),
)


@dataclass(frozen=True)
class SizingTask:
    """What is to be built.

    settings: Those of the scene; the activation is "" if the scene leaves it to the design, and
        ``options`` are those of its own design.
    design: The scene's own design, whose options ``settings`` has; "auto" for none.
    serial: What the scene has around its networks that needs outputs one after the other, such as
        "a section [front_end]".
    decides: Whether the scene asks for the number of the largest output.
    frames, shape (frames, inputs): Codes of the recorded frames.
    """

    arrangement: str
    networks: Sequence[DenseNetwork]
    settings: Settings
    design: str
    serial: tuple[str, ...]
    decides: bool
    frames: Codes


@dataclass(frozen=True)
class Sized:
    """A design and what it costs.

    options: All options of the design, those that the scene sets included.
    size: Estimated LUTs and flip-flops of a Virtex-II.
    worst, mean: The largest and the mean magnitude of the difference from the network in floating
        point, over all outputs of the recorded frames, in units of 2**-13.
    """

    candidate: Candidate
    options: Mapping[str, object]
    network: Network
    size: Size
    multipliers: int
    worst: float
    mean: float

    @property
    def clocks(self) -> int:
        """Clocks from the last sample to the last output."""
        return self.network.clocks_after_samples

    @property
    def interval(self) -> int:
        """Clocks from frame to frame."""
        return self.network.interval

    @property
    def coarse(self) -> bool:
        return DESIGNS[self.candidate.design].learned_functions

    @property
    def kind(self) -> str:
        """The name under which recorded networks of the same design stand."""
        return kind_of(self.candidate.design, self.options)

    def cells(self, family: str) -> Cells:
        """What it takes of a family."""
        size, most = self.size, spread(self.kind)
        if family == "ecp5":
            size = routed_size(self.kind, path_of(self.kind, self.options), size)
            most = routed_spread(self.kind)
        rams = block_rams(self.network, family)
        return Cells(size.luts, size.flip_flops, self.multipliers, rams, most, size.clock_mhz)


@dataclass(frozen=True)
class Cells:
    """What a design takes of a family.

    spread: The largest error of an estimate of LUTs in per cent; None if it is unknown.
    clock_mhz: The clock that is expected; None if it is unknown.
    """

    luts: float
    flip_flops: float
    multipliers: int
    block_rams: int
    spread: float | None
    clock_mhz: float | None


@dataclass(frozen=True)
class Refused:
    candidate: Candidate
    reason: str


def kind_of(design: str, options: Mapping[str, object]) -> str:
    """A design, and whether it adds three operands."""
    return f"{design} ternary" if options.get("adder_operands") == 3 else design


def build(task: SizingTask, candidate: Candidate) -> Network:
    design = DESIGNS[candidate.design]
    if task.arrangement not in design.arrangements:
        raise InputError(
            f"network.arrangement: got {task.arrangement!r}, expected "
            f"{' or '.join(design.arrangements)}"
        )
    around = [*task.serial, *["hardware.argmax"] * (task.decides and not design.decides_itself)]
    if design.stream != "serial" and around:
        raise InputError(f"got {around[0]}, expected none: all outputs come in one clock")
    settings = settings_for(task, candidate)
    return arrange(task.arrangement, task.networks, design, settings)


def settings_for(task: SizingTask, candidate: Candidate) -> Settings:
    """The settings of a task for a design: its own activation if it has one, and its options."""
    design, settings = DESIGNS[candidate.design], task.settings
    own = settings.options if candidate.design == task.design else {}
    usual, options = settings.activation, settings.activation_options
    if not usual or (usual not in known(candidate.design, settings.precision)):
        usual, options = known(candidate.design, settings.precision)[0], {}
    if not design.activation_choices:
        options = {}
    kept = {key: value for key, value in own.items() if key not in LEFT_OUT}
    chosen = {**kept, **candidate.options}
    return replace(settings, activation=usual, activation_options=options, options=chosen)


def known(design: str, precision: Precision) -> list[str]:
    """The activations that a design has in a precision, its usual one first."""
    made = DESIGNS[design]
    names = list(made.known_activations) or [precision.activation, *SCHEMES]
    return [
        name
        for name in dict.fromkeys(names)
        if precision in SCHEMES[name].precisions
        and (made.known_activations or not SCHEMES[name].half_codes)
    ] or names


def all_sized(task: SizingTask) -> list[Sized | Refused]:
    """What ``sized`` gives for each candidate, without those that are built as an earlier one."""
    found: dict[str, Sized | Refused] = {}
    for one in (sized(task, candidate) for candidate in CANDIDATES):
        found.setdefault(one.candidate.name, one)
    return list(found.values())


def sized(task: SizingTask, candidate: Candidate) -> Sized | Refused:
    """A design of a task with its costs, or why it cannot be built or counted."""
    try:
        network = build(task, candidate)
        if isinstance(network, Engine):
            # Fewer lanes may be built than a candidate asks for.
            options = {**candidate.options, "lanes": network.lanes}
            candidate = replace(candidate, options=options)
        return Sized(
            candidate,
            settings_for(task, candidate).options,
            network,
            size_of(features_of(network)),
            multipliers(network),
            *errors(task, network),
        )
    except InputError as error:
        return Refused(candidate, str(error))


def errors(task: SizingTask, network: Network) -> tuple[float, float]:
    """The largest and the mean difference from floating point, in units of 2**-13."""
    if not len(task.frames):
        return 0.0, 0.0
    real = process_real(task.arrangement, task.networks, SIGNAL.to_real(task.frames), tanh)
    reached = np.clip(real, SIGNAL.to_real(SIGNAL.low), SIGNAL.to_real(SIGNAL.high))
    apart = np.abs(SIGNAL.to_real(network.process(task.frames)) - reached) * (1 << SIGNAL.frac)
    return float(apart.max()), float(apart.mean())


def front(rows: Sequence[Sized], family: str) -> list[bool]:
    """Whether no other design is as good in every column and better in one."""
    costs = []
    for row in rows:
        found = row.cells(family)
        sizes = round(found.luts), round(found.flip_flops), found.multipliers, found.block_rams
        speed = -(found.clock_mhz or 0), row.clocks, row.interval
        costs.append((*sizes, *speed, row.worst, row.mean))
    return [not any(other != own and all(map(le, other, own)) for other in costs) for own in costs]
