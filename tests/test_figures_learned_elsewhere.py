"""Tests the table learned_elsewhere, and how it is measured."""

from dataclasses import replace

import numpy as np
import pytest

from golden.scene import load_scene
from golden.training.objective import Rows
from golden.training.task import task_for
from tb.report.measure import table_records
from tb.report.measure.learned_elsewhere import (
    HELD_OUT,
    SEEDS,
    STUDIES,
    chosen,
    found,
    groups,
    parts_of,
    scene_of,
)
from tb.report.measure.learned_functions import Networks, rms
from tb.report.page import learned

SWING, RIG = STUDIES


class Constant:
    """Gives the same output whatever the inputs are."""

    output = 0.25
    parameters, steps = 1, 2

    def process(self, frames: np.ndarray) -> np.ndarray:
        return np.full((len(frames), 1), self.output)


@pytest.fixture(scope="module")
def rows() -> dict[tuple[str, str, str], dict[str, float]]:
    table = table_records.read("learned_elsewhere")
    at = [table.columns.index(name) for name in ("scene", "network", "output")]
    return {
        tuple(str(row[n]) for n in at): dict(zip(table.columns, row, strict=True))
        for row in table.rows
    }


def test_every_network_has_every_output(rows) -> None:
    assert list(rows) == [
        (study.name, kind.name, output)
        for study in STUDIES
        for kinds in groups(study)
        for kind in kinds
        for output in load_scene(study.scene).outputs
    ]
    for row in rows.values():
        errors = [row[f"held out {n + 1} %"] for n in range(SEEDS)]
        assert row["mean %"] == pytest.approx(np.mean(errors))


@pytest.mark.parametrize("study", STUDIES, ids=lambda study: study.name)
def test_the_rows_are_those_of_the_training_of_the_scene(study) -> None:
    scene = load_scene(study.scene)
    parts = parts_of(study, scene_of(study, scene.training.seed))
    task = task_for(scene, scene.vectors(), [])
    every = {"training": study.every, "validation": study.every, "test": 1}
    for name, step in every.items():
        of_scene = getattr(task, name)
        own = parts[HELD_OUT if name == "test" else name]
        count = of_scene.targets.shape[1]
        np.testing.assert_array_equal(own.inputs, of_scene.inputs[::step])
        np.testing.assert_array_equal(own.targets[:, :count], of_scene.targets[::step])
        np.testing.assert_array_equal(own.scale[:, :count], of_scene.scale[::step])
    assert len(parts["known"].inputs) == sum(
        len(parts[name].inputs) for name in ("training", "validation")
    )


@pytest.mark.parametrize("study", STUDIES, ids=lambda study: study.name)
def test_both_kinds_have_the_settings_of_the_scene(study) -> None:
    settings = load_scene(study.scene).training
    (mlps,), *functions = groups(study)
    assert tuple(mlps.candidates) == study.hidden
    for whole, pruned in functions:
        assert whole.candidates == pruned.candidates
        for one in (mlps, whole):
            assert study.candidates % len(one.candidates) == 0
        for candidate in whole.candidates:
            own = candidate.size, candidate.steps, candidate.patience
            assert own == (settings.weight_decay, settings.steps, settings.patience)


def test_the_validation_rows_choose() -> None:
    few = replace(RIG, candidates=5)
    parts = parts_of(few, scene_of(few, 1))
    networks = Networks("cascade")
    training, validation = (networks.rows([], parts[p], [0]) for p in ("training", "validation"))
    for kinds in groups(few)[:2]:
        errors = [
            rms(
                chosen(replace(few, candidates=n), kinds[0], [1, 0], training, validation),
                validation,
            )
            for n in range(1, few.candidates + 1)
        ]
        assert errors == sorted(errors, reverse=True)
        assert errors[-1] < errors[0]


def test_pruned_networks_follow_pruned_networks() -> None:
    few = replace(RIG, candidates=1)
    whole = groups(few)[1][0]
    seen: list[np.ndarray] = []

    def constant(model, training: Rows, validation: Rows) -> Constant:
        seen.append(training.inputs)
        return Constant()

    first, second = found(few, [whole, replace(whole, prune=constant)], 1)
    assert [inputs.shape[1] for inputs in seen] == [5, 6]
    assert (seen[1][:, 5] == Constant.output).all()
    assert (second.parameters, second.steps) == (2, 4)
    assert first.parameters > second.parameters
    assert (first.means[HELD_OUT] != second.means[HELD_OUT]).all()


def test_pages_show_the_ranges_of_a_scene(rows) -> None:
    table = table_records.read("learned_elsewhere")
    for study in STUDIES:
        lines = learned.elsewhere(study.name, table).splitlines()
        outputs = list(load_scene(study.scene).outputs)
        assert lines[0].strip("| ").split(" | ")[-len(outputs) :] == outputs
        first = lines[2].strip("| ").split(" | ")
        row = rows[study.name, first[0], outputs[0]]
        errors = [row[f"held out {n + 1} %"] for n in range(SEEDS)]
        assert first[4] == f"{min(errors):.2f} to {max(errors):.2f} ({row['mean %']:.2f})"
        assert len(lines) == 2 + sum(map(len, groups(study)))


def test_the_rig_is_measured_again(rows) -> None:
    """Another machine ends in other minima, so a figure is near its record by a factor."""
    kinds = groups(RIG)[1]
    for kind, again in zip(kinds, found(RIG, kinds, table_records.SEED), strict=True):
        for output, error in zip(load_scene(RIG.scene).outputs, again.means[HELD_OUT], strict=True):
            recorded = rows[RIG.name, kind.name, output]["held out 1 %"]
            assert recorded / 4 < error < 4 * recorded


def test_what_the_page_concludes_is_in_the_record(rows) -> None:
    """MLPs err less on the swing, and the ranges overlap on the rig; functions take fewer steps."""
    splits = [f"held out {n + 1} %" for n in range(SEEDS)]
    for study in STUDIES:
        mlp, *functions = (kind.name for kinds in groups(study) for kind in kinds)
        for name in functions:
            for output in load_scene(study.scene).outputs:
                own, other = rows[study.name, name, output], rows[study.name, mlp, output]
                assert 0.265 < own["steps"] / other["steps"] < 0.545
                errors, of_mlps = ([row[split] for split in splits] for row in (own, other))
                if study is RIG:
                    assert max(min(errors), min(of_mlps)) < min(max(errors), max(of_mlps))
                    continue
                assert own["mean %"] > other["mean %"]
                assert output != "x" or (np.array(errors) > of_mlps).all()
