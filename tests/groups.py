"""The groups of tests: what each kind of machine may change, and which tests it runs."""

from dataclasses import dataclass

from golden.input_error import InputError


@dataclass(frozen=True)
class Rest:
    """A set of tests that some machines leave out.

    why: A sentence that says why they may be left out.
    tests: Files, or a file and a function of it.
    """

    why: str
    tests: tuple[str, ...]


@dataclass(frozen=True)
class Group:
    """The tests that a kind of machine runs, which are all that are in none of its rests.

    So a new test runs on every machine until a rest names it.

    changes: Says what these machines may change.
    rests: The tests whose result these machines cannot change.
    """

    name: str
    changes: str
    rests: tuple[Rest, ...] = ()

    def leaves_out(self) -> list[str]:
        """The tests that are left out: files, or a file and a function of it."""
        return [test for rest in self.rests for test in rest.tests]


SIMULATED = Rest(
    "A simulator or Yosys does the work, on exported files; that their code is the recorded one is "
    "seen in test_synth.py, that benches start in test_new_design.py.",
    (
        "test_benches.py",
        "test_equal.py",
        "test_export.py::test_ghdl_accepts_every_file_in_the_listed_order",
        "test_export.py::test_vhdl_synthesises_without_a_latch",
        "test_handover.py::test_a_fault_in_an_entity_fails",
        "test_handover.py::test_every_recorded_frame_matches",
        "test_handover.py::test_the_examples_compile",
        "test_lean.py::test_the_savings_are_those_of_two_builds",
        "test_proofs.py",
        "test_report.py",
        "test_synth.py::test_the_command",
        "test_synth.py::test_the_recorded_cells_are_those_that_yosys_finds",
    ),
)
EXPORTED = Rest(
    "Hardware is made of whole numbers, which test_same_everywhere.py compares under every setting "
    "of golden/machine.py, by an exporter that fixes its own hash seed.",
    (
        "test_export.py",
        "test_local_names.py",
        "test_new_design.py",
        "test_parts.py",
    ),
)
EXPORTED_AGAIN = Rest(
    "More exports are made and read, by what test_export.py and test_new_design.py try too.",
    (
        "test_handover.py",
        "test_lean.py",
        "test_new_block.py",
        "test_synth.py",
    ),
)
COMPUTED = Rest(
    "Numbers are computed from numbers: no letter, date, path or order of names takes part.",
    (
        "test_activation_reference.py",
        "test_beam.py",
        "test_bound.py",
        "test_conditioning.py",
        "test_fixed.py",
        "test_functions.py",
        "test_gradient.py",
        "test_layers.py",
        "test_networks.py",
        "test_pade.py",
        "test_parts.py",
        "test_plate.py",
        "test_polynomial.py",
        "test_precise.py",
        "test_stability.py",
        "test_swing.py",
    ),
)
READ = Rest(
    "Names, links and files are compared; no floating-point result takes part.",
    (
        "test_census.py",
        "test_files.py",
        "test_myhdl_rules.py",
        "test_site.py",
        "test_tidy.py",
    ),
)
STARTED = Rest(
    "They start tests or measurements of other files, with settings of their own.",
    (
        "test_machine.py",
        "test_machines.py",
        "test_same_everywhere.py",
        "test_spread.py",
        "test_tiers.py",
    ),
)

EVERYTHING = Group("everything", "the simulators, or nothing: all of make test")
VERSIONS = Group("versions", "whatever Python or a package does", (SIMULATED,))
FILES = Group(
    "files",
    "what is read, written, printed and started: letters, decimal points, dates, paths, rights",
    (SIMULATED, EXPORTED_AGAIN, COMPUTED, STARTED),
)
ORDER = Group(
    "order",
    "the order in which names come out of a set",
    (SIMULATED, EXPORTED, EXPORTED_AGAIN, COMPUTED, STARTED),
)
NUMBERS = Group(
    "numbers",
    "the last bit of a floating-point result, and what follows from it",
    (SIMULATED, EXPORTED, EXPORTED_AGAIN, READ, STARTED),
)
GROUPS = {group.name: group for group in (EVERYTHING, VERSIONS, FILES, ORDER, NUMBERS)}


def group_of(name: str) -> Group:
    """The group of that name."""
    if name not in GROUPS:
        raise InputError(f"GROUP={name}: no such group, expected {', '.join(GROUPS)}")
    return GROUPS[name]
