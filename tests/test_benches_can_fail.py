"""A fault in the exported hardware turns its bench red: one or more per block."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import FRONT_END, VISUALISATION, random_mlp, write_scene

from golden.activation.schemes import SCHEMES
from golden.scene import load_scene
from tb.common import runner
from tb.common.runner import Job, Outcome, plan, run_job, run_jobs

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

# Block, what to look for in its Verilog, what to put there.
FAULTS = [
    ("abs_unit", r"opposite\[\(?(13|17|14 - 1|18 - 1)\)?\]", "0"),
    ("abs_unit", r"out_negative <= in_data\[.*\]", "out_negative <= 0"),
    ("comparator_bank", r"in_mag > (\d+)", r"in_mag >= \1"),
    ("comparator_bank", r"out_mag <= in_mag", "out_mag <= in_mag + 1"),
    ("g_memory", r"(\d+): word = (\d+)", r"\1: word = \2 ^ 1"),
    ("i_memory", r"default: word = (\d+)", r"default: word = \1 - 1"),
    ("grad_eqn", r"product \+ aligned", "product - aligned"),
    ("grad_eqn", r"total \+ (\d+)", "total + 0"),
    ("sign_retriever", r"if \(in_negative\)", "if (!in_negative)"),
    ("sign_retriever", r"out_valid <= in_valid", "out_valid <= 1"),
    ("gradient", r"negative_late <= \w+", "negative_late <= negative"),
    ("precise", r"(0): word = (\S+);", r"\1: word = \2 ^ 1;"),
    ("precise", r"default: word = (\S+);", r"default: word = \1 ^ 4096;"),
    ("precise", r"gated_row0_row <= 0", "gated_row0_row <= top"),
    ("precise", r"row_adder1_rest \+ gated_row2_row", "row_adder1_rest"),
    ("precise", r"low \^ (\d+)", "low"),
    ("precise", r"wide_gradient - wide_high", "wide_gradient"),
    ("precise", r"wide_distance - (\d+)", "wide_distance"),
    ("precise", r"negative_late <= \w+", "negative_late <= negative"),
    ("gradient_parallel", r"addr == 0", "addr <= 1"),
    ("gradient_parallel", r"(coeff\S*) = (\d{2,})", r"\1 = \2 ^ 1"),
    ("gradient_parallel", r"negative_late <= \w+", "negative_late <= negative"),
    ("pade", r"remaining <= \(3 - 1\)", "remaining <= 1"),
    ("pade", r"regression0_following > \d+", "regression0_following > 900000"),
    ("pade", r"regression0_kept - \d+", "regression0_kept"),
    ("pade", r"~regression0_whole", "-regression0_whole"),
    ("pade", r"beyond_late == 1", "beyond_late == 2"),
    ("pade", r"(if \(start\) begin\s+negative_held <= )negative_start", r"\1negative"),
    ("polynomial", r"products \+ aligned", "products - aligned"),
    ("polynomial", r"kept < 0", "kept < -9000"),
    ("polynomial", r"segment_late == (\d+)", r"segment_late == \1 + 1"),
    ("polynomial", r"negative_late <= \w+", "negative_late <= negative"),
    ("lut", r"word = (\d+)", r"word = \1 ^ 1"),
    ("lut", r"beyond == 1", "beyond == 2"),
    ("lut", r"negative_late <= \w+", "negative_late <= negative"),
    ("input_controller", r"frame_error <= broken", "frame_error <= 0"),
    ("input_controller", r"dropping <= \(!in_last\)", "dropping <= 0"),
    ("input_controller", r"if \(rst == 1\) begin", "if (0) begin"),
    ("input_node", r"if \(capture\)", "if (1)"),
    ("input_node", r"result = 131071|result = 8191", "result = 0"),
    ("input_node", r"acc \+ (\d+)", "acc + 0"),
    ("input_integral", r"out_q_0\b(?=\))", "out_q_1"),
    ("output_controller", r"\((\d+) - 1\)", r"(\1)"),
    ("output_integral", r"left \+ right|(\w+_term) \+ (\w+_term)", r"\1 - \2"),
    ("output_integral", r"out_last <= [a-z]\w+", "out_last <= 0"),
    ("hybrid", r"\.capture\(capture\)", ".capture(accumulate)"),
    ("hybrid", r"\.in_r_1\(r_1\)", ".in_r_1(r_0)"),
    ("neuron", r"(\w+_term) \+ (\w+_term)", r"\1 - \2"),
    ("neuron", r"word <= (\S+);", "word <= 0;"),
    ("neuron", r"wide \* (\d+)", r"wide * (\1 + 64)"),
    ("neuron", r"scale0_wide \* (\d+)", r"scale0_wide * (\1 + 1)"),
    ("parallel", r"\.in_data_1\(in_data_1\)", ".in_data_1(in_data_0)"),
    ("parallel", r"\.in_data_1\(r_1\)", ".in_data_1(r_0)"),
    ("parallel", r"out_valid <= delay\w+", "out_valid <= q_valid"),
    ("parallel", r"\.in_last\(last\)", ".in_last(q_valid)"),
    ("stream_multiplexer", r"out_data <= held", "out_data <= result"),
    ("stream_multiplexer", r"\(count == (\d+)\)", r"(count == \1 + 1)"),
    ("output_collector", r"remaining == 1", "remaining == 2"),
    ("output_collector", r"<= in_data_1", "<= in_data_0"),
    ("cascade", r"\.in_data\(data_0\)", ".in_data(in_data)"),
    ("cascade", r"\.result\(stage1_result\)", ".result(stage0_result)"),
    ("cascade", r"\.in_data_0\(gathered_0\)", ".in_data_0(gathered_1)"),
    ("multiple", r"\.in_data_1\(aligned_1\)", ".in_data_1(aligned_0)"),
    ("multiple", r"aligned_2 <= result_2", "aligned_2 <= aligned_0"),
    ("axis_network", r"credit0_used == (\d+)", r"credit0_used == \1 + 1"),
    ("axis_network", r"fifo0_write_addr == (\d+)", r"fifo0_write_addr == \1 - 1"),
    ("axis_network", r"(m_axis_tready \|\|) \(!fifo0_full\)", r"\1 1"),
    ("axis_network", r"gate0_empty == 1", "gate0_empty == 2"),
    ("axis_network", r"s_axis_tlast != gate0_final", "s_axis_tlast"),
    ("axis_network", r"gate0_dropping <= \(!s_axis_tlast\)", "gate0_dropping <= 0"),
    ("axis_network", r"closing <= left", "closing <= 0"),
    ("axis_network", r"if \(rst == 1\) begin", "if (0) begin"),
    ("ramp", r"following = \((acc \+ \d+)\)", r"following = (\1 + 2048)"),
    ("ramp", r"out_last <= \(acc == (\S+)\)", "out_last <= 0"),
    ("ramp", r"if \(rst == 1\) begin", "if (0) begin"),
    ("divider", r"head >= divisor", "head > divisor"),
    ("divider", r"in_width == 0", "in_width == 1"),
    ("divider", r"&& \(!load\)", ""),
    ("divider", r"remainder <= trial", "remainder <= shifted"),
    ("power_fold", r"(wide_product \+) (\d+)", r"\1 0"),
    ("power_fold", r"requantise\d_kept > (\d+)", "0"),
    ("power_fold", r"\(uses != 0\)", "1"),
    ("exp_memory", r"(0): word <= (\d+)", r"\1: word <= \2 ^ 1"),
    ("exp_interpolator", r"in_offset \^ (\d+)", "in_offset"),
    ("exp_interpolator", r"flipped \+ (\d+)", r"flipped + \1 + 1"),
    ("load_profile", r"shape > (\d+)", r"shape >= \1"),
    ("load_profile", r"positive_width = 0", "positive_width = 1000"),
    ("load_profile", r"if \(restart\) begin(\s+load)", r"if (1) begin\1"),
    ("load_profile", r"(\.in_offset\()offset", r"\g<1>0"),
    ("readout", r"count == 1", "count == 2"),
    ("readout", r"result_valid && result_last", "result_last && 0"),
    ("readout", r"held_1 = word\w*", "held_1 = 0"),
    ("scan_sequencer", r"slot == 1", "slot == 0"),
    ("scan_sequencer", r"clock == (\d+)", r"clock == \1 - 1"),
    ("scan_sequencer", r"if \(rst == 1\) begin", "if (0) begin"),
    ("scan_sequencer", r"(0): selected = 0", r"\1: selected = 1"),
    ("scan_sequencer", r"if \(take\) begin", "if (1) begin"),
    ("instrument", r"\.adc\(adc\)", ".adc(0)"),
    ("instrument", r"\.held_1\(held_1\)", ".held_1(held_0)"),
]


@pytest.fixture(scope="module")
def jobs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Job]:
    """One job per block under Icarus; the single networks' sums reach their rails."""
    folder = tmp_path_factory.mktemp("faults")
    single = [random_mlp((3, 4, 3), 20.0, 2)]
    designs = [("single", activation, single, "hybrid", "exact") for activation in SCHEMES]
    designs.append(("single", "gradient", single, "parallel", "thesis"))
    cascade = [random_mlp((2 + i, 3, 1), 1.0, i) for i in range(3)]
    multiple = [random_mlp((2, 4 - i, 1), 1.0, i) for i in range(3)]
    designs += [("cascade", "gradient", cascade, "hybrid", "exact")]
    designs += [("multiple", "gradient", multiple, "hybrid", "exact")]
    found: dict[str, Job] = {}
    paths = [
        write_scene(
            folder,
            f"faulty-{arrangement}-{design}-{activation}",
            precision,
            mlps,
            arrangement,
            activation,
            design=design,
        )
        for arrangement, activation, mlps, design, precision in designs
    ]
    # Samples and slots: the blocks inside are those of the cascade above.
    paths.append(
        write_scene(folder, "faulty-axis", "exact", cascade, "cascade", interface="axi_stream")
    )
    # A short ramp, because every fault costs all tests of its bench.
    section = f"{VISUALISATION}stop = 0.9\nstep = 0.3\n{FRONT_END}counter_width = 6\n"
    drawn = [random_mlp((2, 3, 4), 1.0, 2)]
    paths.append(write_scene(folder, "faulty-profile", "exact", drawn, sections=section))
    for path in paths:
        for job in plan(load_scene(str(path)), ["icarus"], build=folder):
            found.setdefault(job.block, job)
    return found


def with_fault(job: Job, folder: Path, pattern: str, text: str) -> Job:
    """The job on a copy of its files in which the first match is replaced."""
    changed = replace(job, build=folder)
    shutil.copytree(job.hdl_folder, changed.hdl_folder)
    file = changed.hdl_folder / f"{job.entity}.v"
    source, count = re.subn(pattern, text, file.read_text(), count=1)
    assert count == 1, f"{pattern} is not in {file.name}"
    file.write_text(source)
    return changed


@pytest.fixture(scope="module")
def outcomes(jobs, tmp_path_factory: pytest.TempPathFactory) -> dict[tuple, Outcome]:
    """What became of every fault; the jobs share the cores."""
    faulty = [
        with_fault(jobs[block], tmp_path_factory.mktemp("fault"), pattern, text)
        for block, pattern, text in FAULTS
    ]
    return dict(zip(FAULTS, run_jobs(faulty, lambda _: None), strict=True))


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: f"{fault[0]}-{fault[1]}")
def test_a_fault_turns_the_bench_red(outcomes, fault) -> None:
    outcome = outcomes[fault]
    assert not outcome.passed
    # It ran and found the fault: not the compiler did.
    assert re.search(r" FAIL=[1-9]", outcome.log.read_text())


def test_every_block_has_a_fault(jobs) -> None:
    assert {block for block, _, _ in FAULTS} == set(jobs)


def test_the_same_jobs_pass_without_a_fault(jobs) -> None:
    for outcome in run_jobs(list(jobs.values()), lambda _: None):
        assert outcome.passed, f"{outcome.job.entity}: {outcome.complaint()}"


def test_a_bench_that_compares_nothing_fails(jobs, monkeypatch) -> None:
    """A test filter that matches nothing exits green in cocotb; the runner turns it red."""
    original = runner.subprocess.run

    def with_filter(command, **keywords):
        environment = keywords["env"] | {"COCOTB_TEST_FILTER": "matches_nothing"}
        return original(command, **(keywords | {"env": environment}))

    monkeypatch.setattr(runner.subprocess, "run", with_filter)
    outcome = run_job(jobs["abs_unit"])
    assert not outcome.passed
    assert outcome.compared == 0
