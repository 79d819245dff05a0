"""lesson_receiver against its twin.

Sweeps: lessons with random codes and with both ends, that say to learn or not and have known
outputs, theta or neither; packets with one wrong bit, one for each bit, and for each bit of the
check one that leaves only this bit; packets that are cut behind each of their bytes, and pauses
around the longest one that a packet may have; bytes that begin no packet, among them many SYNC
bytes.
Drives: bytes at random clocks and back to back; frames that end often and seldom, also in the clock
of any byte; a network that takes codes at once, late, and one by one, while the next packet comes;
a line that becomes idle; resets.
Checks: ``learn``, ``lesson_error``, ``target_valid``, the code, ``target_last`` and
``target_theta`` in every clock; that the codes of every lesson arrive where frames end and nothing
disturbs them.
Does not prove: that each wrong packet is found, of which a check of 16 bits lets one in 65536 pass.
"""

from binascii import crc_hqx

import cocotb
import numpy as np

from golden.link.packets import IMAGE, LESSON, SYNC, check_of, kind_byte, lesson_packet
from golden.numbers.precision import SIGNAL
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import LEARN_UART
from tb.common.stimulus import random_resets

CASES = {"learn-uart": LEARN_UART}
OFFERED = ("target_data", "target_last", "target_theta")
WATCH = ["target_valid", *OFFERED, "learn", "lesson_error"]


# What a lesson may give.
GIVEN = ("nothing", "known", "theta")


class Line:
    """The columns of the inputs, which grow by what is sent."""

    def __init__(self, bench):
        self.bench, self.rng = bench, bench.rng
        self.rows = []

    def wait(self, clocks, ends=0.0, ready=1.0):
        for _ in range(clocks):
            self._row(0, int(self.rng.integers(0, 256)), ends, ready)

    def send(self, data, spacing=0, ends=0.0, ready=1.0):
        for byte in data:
            self._row(1, byte, ends, ready)
            self.wait(int(self.rng.integers(0, spacing + 1)), ends, ready)

    def _row(self, valid, data, ends, ready):
        frame_end, taken = self.rng.random() < ends, self.rng.random() < ready
        self.rows.append((valid, data, int(frame_end), int(taken)))

    @property
    def drive(self):
        names = ("in_valid", "in_data", "frame_end", "target_ready")
        return dict(zip(names, np.array(self.rows).T, strict=True))


def lesson(bench, learn=1, what="known"):
    """A packet with random codes or both ends, and those of its codes that leave."""
    twin, rng = bench.twin, bench.rng
    count = {"known": twin.outputs, "theta": twin.elements}.get(what, 0)
    codes = rng.integers(SIGNAL.low, SIGNAL.high + 1, count)
    codes = np.where(rng.random(count) < 1 / 4, rng.choice([SIGNAL.low, SIGNAL.high], count), codes)
    packet = lesson_packet(twin.codes, bool(learn), codes.tolist(), what if count else "known")
    return packet, codes.tolist()


def almost_right(packet, bit):
    """A packet with the check behind which only this bit is not 0."""
    body = packet[1:-2]
    before = check_of(body)
    # The check is linear, so what changes it does not depend on the packet.
    wrong = next(c for c in range(1 << 16) if check_of_two(before, before ^ c) == 1 << bit)
    return packet[:-2] + (before ^ wrong).to_bytes(2, "big")


def check_of_two(check, two):
    """The check after two more bytes."""
    return crc_hqx(two.to_bytes(2, "big"), check)


async def check(bench, drive):
    """Compare every clock, and return the known outputs that were taken."""
    recording = await bench.play(drive, WATCH)
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    names = ("in_valid", "in_data", "frame_end", "target_ready", "rst")
    seen = {name: recording.unsigned(name, rows) for name in names}
    expected = bench.twin.process(*seen.values())
    for name in ("target_valid", "learn", "lesson_error"):
        bench.compare(name, recording.unsigned(name, rows), getattr(expected, name), clock=rows)
    offered = rows[expected.target_valid]
    for name in OFFERED:
        read = recording.signed if name == "target_data" else recording.unsigned
        want = getattr(expected, name)[expected.target_valid]
        bench.compare(name, read(name, offered), want, clock=offered)
    place, left = bench.twin.states
    comes = seen["in_valid"] == 1
    idle = np.convolve(comes, np.ones(bench.twin.idle_clocks), "full")[: len(comes)] == 0
    bench.visit(place, expected.place[idle & (np.roll(expected.place, -1) == 0)])
    bench.visit(place, expected.place[np.roll(idle, -1) & ~idle])
    bench.visit(left, expected.gone[expected.target_valid & comes])
    taken = np.intersect1d(offered, rows[seen["target_ready"] == 1])
    return recording.signed("target_data", taken), expected


@cocotb.test()
async def lessons(dut):
    """Play lessons, each of which meets the end of a frame; all their codes arrive."""
    bench = Bench(dut)
    line, due = Line(bench), []
    for n in range(60):
        packet, codes = lesson(bench, n // 2 % 2, GIVEN[n % 3])
        if n % 7 == 6:
            packet = bytes([SYNC]) * int(bench.rng.integers(1, 4)) + packet
        line.send(packet, spacing=n % 4)
        line.wait(int(bench.rng.integers(0, 6)), ready=0.5)
        line.wait(1, ends=1.0)
        line.wait(4 * bench.twin.codes + 4, ready=(1.0, 0.5)[n % 2])
        line.wait(40)
        due += codes
    got, expected = await check(bench, line.drive)
    bench.compare("codes", got, np.array(due))
    assert not expected.lesson_error.any(), "a right lesson was refused"
    bench.finish(at_least=500)


@cocotb.test()
async def wrong_packets(dut):
    """Play packets with one wrong bit, cut ones, and other bytes, between right ones."""
    bench = Bench(dut)
    line, rng, idle = Line(bench), bench.rng, bench.twin.idle_clocks + 3
    often = {"ends": 0.02, "ready": 0.7}
    noise = rng.choice([SYNC, kind_byte(LESSON), kind_byte(IMAGE), 7, 0], 300)
    line.send(noise.tolist(), 2, **often)
    line.wait(idle)
    packet, _ = lesson(bench)
    for bit in range(8 * len(packet)):
        wrong = bytearray(lesson(bench)[0])
        wrong[bit // 8] ^= 1 << bit % 8
        line.send(wrong, **often)
        line.wait(int(rng.integers(0, 9)), **often)
        if bit % 5 == 0:
            line.wait(idle, **often)
            line.send(lesson(bench)[0], 1, **often)
    for bit in range(16):
        line.send(almost_right(lesson(bench)[0], bit))
        line.wait(30, ends=0.2)
    for cut in (*range(1, len(packet)), *rng.permutation(range(1, len(packet))).tolist()):
        line.wait(idle, **often)
        line.send(lesson(bench)[0][:cut], 2, **often)
        line.wait(idle, **often)
        line.send(lesson(bench)[0], **often)
        line.wait(20, ends=0.2, ready=0.5)
    # A byte comes just before the packet would be dropped, in that clock, and just after it.
    for clocks in (-2, -1, 0, 1):
        for place in range(1, len(packet)):
            sent = lesson(bench)[0]
            line.send(sent[:place])
            line.wait(bench.twin.idle_clocks + clocks)
            line.send(sent[place:])
            line.wait(20, ends=0.2)
            line.wait(idle)
    _, expected = await check(bench, line.drive)
    assert expected.lesson_error.sum() > 50, "too few packets were refused"
    bench.finish(at_least=1000)


@cocotb.test()
async def packets_while_codes_leave(dut):
    """Play packets close together, while frames end in any clock and codes are taken slowly."""
    bench = Bench(dut)
    line, rng = Line(bench), bench.rng
    for n in range(300):
        packet, _ = lesson(bench, int(rng.integers(0, 2)), str(rng.choice(GIVEN)))
        ends, ready = (0.05, 0.3, 1.0)[n % 3], (0.02, 0.3, 1.0)[n // 3 % 3]
        line.send(packet, (0, 0, 3)[n % 3], ends=ends, ready=ready)
        line.wait(int(rng.integers(0, 12)), ends=ends, ready=ready)
    _, expected = await check(bench, line.drive)
    assert expected.lesson_error.sum() > 10, "no packet met codes that leave"
    assert expected.target_last.sum() > 10, "no codes left"
    bench.finish(at_least=1000)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    line, rng = Line(bench), bench.rng
    for _ in range(150):
        packet, _ = lesson(bench, what=str(rng.choice(GIVEN)))
        line.send(packet, int(rng.integers(0, 3)), ends=0.05, ready=0.5)
        line.wait(int(rng.integers(0, 9)), ends=0.2, ready=0.5)
    drive = line.drive
    drive["rst"] = random_resets(rng, len(drive["in_valid"]), 60)
    await check(bench, drive)
    bench.finish(at_least=500)
