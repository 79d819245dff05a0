"""lesson_receiver against its twin: lessons among wrong, cut and other packets, and noise.

Bytes come at random clocks and back to back, frames end in any of them, codes are taken at once or
slowly, and resets come. A check of 16 bits lets one wrong packet in 65536 pass.
"""

from binascii import crc_hqx

import cocotb
import numpy as np

from golden.link.lesson_receiver import HEAD_BYTES
from golden.link.packets import (
    CHECK_PRESET,
    IMAGE,
    LESSON,
    SYNC,
    check_of,
    kind_byte,
    lesson_packet,
)
from golden.numbers.precision import SIGNAL
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import LEARN_UART
from tb.common.properties import Property
from tb.common.stimulus import random_resets
from tb.common.watch import check_byte

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


def properties(twin):
    return [only_right_packets(twin), the_check(twin), whole_frames(twin)]


def only_right_packets(twin):
    end, bits = twin.packet_bytes - 1, HEAD_BYTES - 1
    return Property(
        name="only right packets",
        sentence="A packet counts in the clock of its last byte: behind SYNC, the byte of version "
        f"and kind and the length come {end - 2} bytes, none of them while codes leave, and the "
        f"check is right. No pause in it is {twin.idle_clocks} clocks long. Then learn becomes the "
        "lowest bit of its fourth byte, and target_theta the bit of theta. In no other clock does "
        "either change.",
        states=(
            f"right == (in_valid && bytes == {end} && !sending && following == 0)",
            "learn == taught",
            "target_theta == told",
        ),
        watch=f"""
            reg [7:0] bytes = 0;
            reg bit_of = 0, taught = 0, theta_of = 0, told = 0;
            wire silent = idle == {twin.idle_clocks - 1} && !in_valid;
            wire drops = in_valid && ((bytes == 2 && in_data != {twin.payload_bytes})
                || (bytes > 2 && sending) || bytes == {end});
            always @(posedge clk) begin
                if (in_valid) begin
                    if (bytes == {bits}) bit_of <= in_data[0];
                    if (bytes == {bits}) theta_of <= in_data[2];
                    if (bytes == 0) bytes <= in_data == {SYNC};
                    else if (bytes == 1)
                        bytes <= in_data == {kind_byte(LESSON)} ? 2 : in_data == {SYNC};
                    else bytes <= bytes + 1;
                    if (bytes == {end} && !sending && following == 0) taught <= bit_of;
                    if (bytes == {end} && !sending && following == 0) told <= theta_of;
                end
                if (silent || drops || rst) bytes <= 0;
                if (rst) taught <= 0;
                if (rst) told <= 0;
            end
        """,
        helps=(
            f"bytes == place && bytes <= {end}",
            f"bytes <= {bits} || (bit_of == learns && theta_of == puts)",
            f"!armed || bytes <= {bits}",
            f"!sending || bytes <= {bits + 1}",
        ),
        # The check is proved below. Silence may be counted in any way.
        free=("idle", "following"),
        reached=("right",),
        refuted_by=(
            (r"following == 0", "1"),
            (r"in_data == 19", "in_data[3:0] == 3"),
            (r"mode <= learns", "mode <= 1"),
            (r"putting <= puts", "putting <= 1"),
            (r"place == 2", "place == 3"),
        ),
        clocks=twin.packet_bytes + 3,
    )


def the_check(twin):
    return Property(
        name="the check",
        sentence="What must be 0 in the clock of the last byte is the CRC of all bytes behind "
        "SYNC, computed bit by bit.",
        states=("!(in_valid && place > 0) || following == sum",),
        watch=f"""
            reg [15:0] summed = 0, sum;
            always @* begin
                sum = place == 1 ? {CHECK_PRESET} : summed;
                {check_byte("in_data")}
            end
            always @(posedge clk) if (in_valid) summed <= sum;
        """,
        helps=(f"place == 0 || check == (place == 1 ? {CHECK_PRESET} : summed)",),
        free=("idle", "sending"),
        reached=("place == 4",),
        refuted_by=((r"check <= 65535;(?=\s+end\s+else begin\s+check)", "check <= 0;"),),
        clocks=6,
    )


def whole_frames(twin):
    count = f"(target_theta ? {twin.elements} : {twin.outputs})"
    return Property(
        name="whole frames of codes",
        sentence="Codes begin to leave only in the clock after frame_end, and only those of a "
        f"packet that was right before. {twin.outputs} known outputs leave or {twin.elements} "
        "elements of theta, one after the other, the last one with target_last. Each stays until "
        "it is taken, and so does target_theta.",
        states=(
            "target_valid == (left != 0)",
            "!target_valid || target_last == (left == 1)",
            "!stood || (target_valid && target_data == before)",
            "!went || target_theta == kind_before",
            "!armed || packets",
        ),
        watch=f"""
            reg [7:0] left = 0;
            reg stood = 0, packets = 0, went = 0, kind_before = 0;
            reg [13:0] before = 0;
            always @(posedge clk) begin
                if (frame_end && armed) left <= {count};
                else if (target_ready && left != 0) left <= left - 1;
                stood <= !rst && target_valid && !target_ready;
                before <= target_data;
                went <= !rst && target_valid && !target_last;
                kind_before <= target_theta;
                packets <= !rst && (packets || right);
                if (rst) left <= 0;
            end
        """,
        helps=(
            f"left <= {count} && (left == 0 ? count == 0 : count == {count} - left)",
            "!(sending && armed)",
            f"!armed || place <= {HEAD_BYTES - 1}",
            f"!sending || place <= {HEAD_BYTES}",
        ),
        free=("following",),
        reached=("target_valid && target_last",),
        refuted_by=(
            (r"frame_end && armed", "armed"),
            (r"place >= 3", "place >= 9"),
            (r"sending && target_ready", "sending"),
            (r"count == \d+", "count == 0"),
        ),
        clocks=twin.packet_bytes + 8,
    )
