"""packet_sender against its twin: random codes, winners, points, theta and flags, often and seldom.

The line takes bytes at once, slowly or not at all; resets come in each byte of a packet. A computer
reads the bytes as packets, so many that their number wraps around.
"""

import cocotb
import numpy as np

from golden.link.packets import FRAME_HEADER, SYNC, check_of
from golden.numbers.precision import SIGNAL
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import LEARN_UART, UARTS, WINNER_UART

CASES = UARTS | {"winner-line": WINNER_UART, "learn-uart": LEARN_UART}
# Its packets carry the largest output too.
ALSO = ("winner-line",)


def frames_of(rng, length, right, chance):
    """A stream of frames: valid, data and last, an element in ``chance`` of the clocks.

    Between elements ``last`` is now high and now low, which must not matter.
    """
    valid = (rng.random(length) < chance).astype(np.int64)
    data = rng.integers(SIGNAL.low, SIGNAL.high + 1, length)
    data = np.where(rng.random(length) < 1 / 8, rng.choice([SIGNAL.low, SIGNAL.high], length), data)
    last, place, size = np.zeros(length, dtype=np.int64), 0, right
    for t in np.flatnonzero(valid):
        last[t] = place == size - 1
        place = 0 if last[t] else place + 1
        if last[t]:
            size = right if rng.random() < 3 / 4 else int(rng.integers(1, 2 * right + 2))
    return valid, data, np.where(valid, last, rng.integers(0, 2, length))


def winners_of(bench, length, chance):
    """Columns of the largest output, whose indices and margins are those of any frame."""
    argmax, rng = bench.twin.argmax, bench.rng
    most = argmax.margin_fmt.last
    margin = rng.integers(0, most + 1, length)
    margin = np.where(rng.random(length) < 1 / 8, rng.choice([0, most], length), margin)
    return {
        "winner_valid": (rng.random(length) < chance / bench.twin.outputs).astype(np.int64),
        "winner_index": rng.integers(0, bench.twin.outputs, length),
        "winner_margin": margin,
    }


def elements_of(bench, drive, chance):
    """Columns of theta: its elements behind each frame of outputs, of which some are cut."""
    length, rng = len(drive["result_valid"]), bench.rng
    valid = (rng.random(length) < max(chance, 0.05)).astype(np.int64)
    ends, place = drive["result_valid"] & drive["result_last"], bench.twin.elements
    for t in range(length):
        valid[t] &= place < bench.twin.elements
        place = 0 if ends[t] else place + valid[t]
    return {"theta_valid": valid, "theta_data": rng.integers(SIGNAL.low, SIGNAL.high + 1, length)}


def drive_for(bench, length, chance, ready):
    """The columns of every input."""
    twin, rng = bench.twin, bench.rng
    drive = {}
    for name, size in (("sample", twin.inputs), ("result", twin.outputs)):
        drive |= dict(
            zip(
                (f"{name}_valid", f"{name}_data", f"{name}_last"),
                frames_of(rng, length, size, chance),
                strict=True,
            )
        )
    if twin.points:
        valid, x, last = frames_of(rng, length, twin.points, chance)
        place = np.cumsum(valid) - valid
        last = (place % twin.points == twin.points - 1) & (valid == 1)
        drive |= {"profile_valid": valid, "profile_x": x, "profile_last": last.astype(np.int64)}
        drive["profile_y"] = rng.permutation(x)
    if twin.decides:
        drive |= winners_of(bench, length, chance)
    if twin.learns:
        drive |= elements_of(bench, drive, chance)
    flags = ["converter_error", *(["frame_error", "image_error", "line_error"] * twin.reload)]
    flags += ["line_error", "lesson_error", "learn_error", "learning"] * twin.learns
    # Frames are rare enough that packets without a new frame follow a refused frame.
    flagged = max(chance, 0.02) / 8
    for name in flags:
        drive[name] = (rng.random(length) < flagged).astype(np.int64)
    drive["out_ready"] = (rng.random(length) < ready).astype(np.int64)
    return drive


async def check(bench, drive):
    """Compare every clock, and return the bytes that were taken and what the twin says."""
    recording = await bench.play(drive, ["out_valid", "out_data"])
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    signed = [port.name for port in bench.twin.ports if port.signed]
    seen = {
        name: (recording.signed if name in signed else recording.unsigned)(name, rows)
        for name in [*drive, "rst"]
    }
    expected = bench.twin.process(seen, seen["rst"])
    offered = rows[expected.out_valid]
    bench.compare("clocks of out_valid", recording.rows("out_valid"), offered)
    got = recording.unsigned("out_data", offered)
    bench.compare("out_data", got, expected.out_data[expected.out_valid], clock=offered)
    return recording, rows, seen, expected


def read(bench, recording, rows, seen, expected):
    """Check that a computer reads the bytes as the expected packets."""
    layout = bench.twin.layout
    taken = np.intersect1d(recording.rows("out_valid"), rows[seen["out_ready"] == 1])
    data = bytes(recording.unsigned("out_data", taken).tolist())
    size, frames = layout.packet_bytes, []
    for start in range(0, len(data) - size + 1, size):
        packet = data[start : start + size]
        assert (packet[0], packet[2]) == (SYNC, layout.payload_bytes), f"no packet at {start}"
        assert check_of(packet[1:]) == 0, f"a wrong check at {start}"
        frames.append(layout.from_payload(packet[3], packet[FRAME_HEADER:-2]))
    assert frames == expected.frames[: len(frames)], "got other frames than were sent"
    assert [frame.number for frame in frames] == [n % 256 for n in range(len(frames))]
    bench.compared += len(frames)
    if bench.twin.points:
        bench.visit("point", np.array([frame.point[0] for frame in frames]))
    if bench.twin.learns:
        bench.visit("element of theta", np.array([frame.theta[0] for frame in frames]))
    if bench.twin.decides:
        bench.visit("index", np.array([frame.winner[0] for frame in frames]))
    return frames


@cocotb.test()
async def packets(dut):
    """Play frames that come often and seldom, on a fast line and on a slow one."""
    bench = Bench(dut)
    size = bench.twin.layout.packet_bytes
    for packets_due, chance, ready in ((260, 0.5, 1.0), (10, 0.3, 0.1), (12, 0.002, 1.0)):
        between = bench.twin.patience if chance < 0.01 else 10
        length = int(packets_due * (size / ready + between))
        frames = read(bench, *await check(bench, drive_for(bench, length, chance, ready)))
        assert len(frames) >= packets_due / 2, f"got {len(frames)} packets"
    bench.finish(at_least=10_000)


def ahead(bench, drive, at):
    """The clocks in which packets begin after a reset."""
    some = slice(at, at + 4 * bench.twin.layout.packet_bytes)
    return bench.twin.process(
        {n: c[some] for n, c in drive.items()}, 0 * drive["out_ready"][some]
    ).begins


@cocotb.test()
async def resets(dut):
    """Play resets, one in each byte of a packet, in random order."""
    bench = Bench(dut)
    state, rng = bench.twin.states[0], bench.rng
    drive = drive_for(bench, 12 * len(state.values) * (len(state.values) + 8), 0.5, 1.0)
    # A reset moves the packets after it, so the resets are placed one after the other.
    column = np.zeros(len(drive["out_ready"]), dtype=np.int64)
    at = 0
    for byte in [*rng.permutation(len(state.values)), *rng.permutation(len(state.values))]:
        begins = ahead(bench, drive, at)
        at += begins[min(1, len(begins) - 1)] + 1 + int(byte)
        column[at] = 1
        at += 1
    drive = {name: values[: at + 50] for name, values in (drive | {"rst": column}).items()}
    _, _, seen, expected = await check(bench, drive)
    cut = np.flatnonzero(seen["rst"])
    since = np.searchsorted(expected.begins, cut) - 1
    into = cut - np.array(expected.begins)[since] - 1
    bench.visit(state, into)
    bench.finish(at_least=500)


@cocotb.test()
async def resets_of_a_quiet_line(dut):
    """A reset behind some frames, and one while the line waits; then nothing but a free line.

    The packet that comes without a new frame shows that the wait and all samples began anew.
    """
    bench = Bench(dut)
    patience, size = bench.twin.patience, bench.twin.layout.packet_bytes
    drive = drive_for(bench, 16 * (patience + 2 * size), 0.5, 1.0)
    column = np.zeros(len(drive["out_ready"]), dtype=np.int64)
    at, packets_due = 0, 0
    for _ in range(4):
        at += 2 * size
        for wait in (int(bench.rng.integers(1, patience)), patience + 2 * size):
            column[at] = 1
            for values in drive.values():
                values[at + 1 : at + 1 + wait] = 0
            drive["out_ready"][at + 1 : at + 1 + wait] = 1
            at += 1 + wait
        packets_due += 1
    drive = {name: values[:at] for name, values in (drive | {"rst": column}).items()}
    *_, expected = await check(bench, drive)
    assert len(expected.begins) >= packets_due, f"got {len(expected.begins)} packets"
    bench.finish(at_least=packets_due * size)
