"""image_receiver against its twin.

Sweeps: images of 1 to 600 random bytes, and of tens of thousands; packets of another version or
kind, of kinds that differ in one bit, of length 0, and packets cut at each of their places; bytes
that begin no packet, among them many SYNC bytes.
Drives: bytes at random clocks and back to back; an engine that takes no byte until as many have
come as the block can keep; a line that becomes idle; resets.
Checks: ``load_valid``, the byte and ``load_last`` in every clock; that every image which was sent
completely arrives, byte by byte.
Does not prove: what happens if more bytes come than the block can keep while the engine takes none.
"""

import cocotb
import numpy as np

from golden.link.packets import FRAME, IMAGE, MOST_IMAGE, SYNC, VERSION, image_packet, kind_byte
from tb.common.bench import RESET_CLOCKS, Bench
from tb.common.case_library import UART
from tb.common.stimulus import random_resets

CASES = {"uart": UART}
LONG = 0xA9D6
WATCH = ["load_valid", "load_data", "load_last"]


def timeline(bench, packets):
    """The columns of bytes. A packet is its data, their spacing, and the idle clocks after it.

    With a spacing of 0 the first bytes come back to back, while the engine takes none.
    """
    twin, rng = bench.twin, bench.rng
    valid, data, ready = [], [], []

    def wait(clocks, takes=None):
        valid.extend([0] * clocks)
        data.extend(rng.integers(0, 256, clocks).tolist())
        ready.extend(rng.integers(0, 2, clocks).tolist() if takes is None else [takes] * clocks)

    for sent, spacing, idle in packets:
        for place, byte in enumerate(sent):
            # The first bytes of an image come after the four bytes of its head.
            holds = spacing == 0 and place < 4 + twin.depth
            valid.append(1)
            data.append(byte)
            ready.append(0 if holds else 1)
            if not holds:
                wait(int(rng.integers(0, spacing + 1)), takes=1)
            if spacing == 0 and place == 4 + twin.depth - 1:
                wait(5, takes=0)
                wait(2 * twin.depth, takes=1)
        wait(3, takes=1)
        wait(idle)
    columns = {"in_valid": valid, "in_data": data, "load_ready": ready}
    return {name: np.array(column, dtype=np.int64) for name, column in columns.items()}


async def check(bench, drive):
    """Compare every clock, and return the bytes that left and which of them were last."""
    recording = await bench.play(drive, WATCH)
    rows = np.arange(RESET_CLOCKS, recording.clocks)
    names = ("in_valid", "in_data", "load_ready", "rst")
    seen = {name: recording.unsigned(name, rows) for name in names}
    expected = bench.twin.process(*seen.values())
    offered = rows[expected.load_valid]
    bench.compare("clocks of load_valid", recording.rows("load_valid"), offered)
    for port in ("load_data", "load_last"):
        got = recording.unsigned(port, offered)
        bench.compare(port, got, getattr(expected, port)[expected.load_valid], clock=offered)
    places, kept = bench.twin.states
    over = np.flatnonzero(idle_ends(seen["in_valid"], seen["rst"], bench.twin.idle_clocks))
    bench.visit(places, expected.place[over])
    bench.visit(kept, expected.stored)
    taken = np.intersect1d(offered, rows[seen["load_ready"] == 1])
    return recording.unsigned("load_data", taken), recording.unsigned("load_last", taken)


def idle_ends(valid, clears, clocks):
    """The clocks in which the line has been idle for just ``clocks`` clocks."""
    found, idle = np.zeros(len(valid), dtype=bool), 0
    for t, (comes, cleared) in enumerate(zip(valid, clears, strict=True)):
        found[t] = not (comes or cleared) and idle == clocks - 1
        idle = 0 if comes or cleared or found[t] else idle + 1
    return found


def whole_packet(rng, most):
    return image_packet(rng.integers(0, 256, int(rng.integers(1, most))).astype(np.uint8).tobytes())


@cocotb.test()
async def images_among_others(dut):
    """Play images, and between them other bytes. After a cut image comes a last byte 0."""
    bench = Bench(dut)
    twin, rng = bench.twin, bench.rng
    idle = twin.idle_clocks + 10
    packets, due = [], []

    def send(data, spacing, image=None, behind=0):
        packets.append((data, spacing, behind))
        if image is not None:
            due.append(image)

    noise = rng.choice([SYNC, kind_byte(FRAME), 0, 7], 60)
    send(noise.astype(np.uint8).tobytes(), 3)
    for other in (kind_byte(FRAME), kind_byte(IMAGE, VERSION + 1), kind_byte(3)):
        send(bytes([SYNC, other, 0, 3, 1, 2, 3]), 2)
    for bit in range(8):
        send(bytes([SYNC, kind_byte(IMAGE) ^ 1 << bit, 0, 3, 1, 2, 3]), 2)
    # After a length of 0, a packet begins with another SYNC.
    send(bytes([SYNC, kind_byte(IMAGE), 0, 0, kind_byte(IMAGE), 0, 3, 1, 2, 3]), 2)
    for size in (1, 2, 3, 255, 256, 257, 600):
        image = rng.integers(0, 256, size).astype(np.uint8).tobytes()
        # A head after a further SYNC is a valid head.
        send(bytes([SYNC]) * (size % 2) + image_packet(image), 3 * (size < 5), image)
    for cut in (1, 2, 3, 4, 5, 30):
        packet = image_packet(rng.integers(1, 256, 60).astype(np.uint8).tobytes())[:cut]
        send(packet, 4, packet[4:] + b"\0" if cut > 3 else None, behind=idle)
        image = rng.integers(0, 256, 2 * twin.depth).astype(np.uint8).tobytes()
        send(image_packet(image), 0 if cut % 2 else 5, image, behind=idle if cut == 30 else 0)
    # Images wait in the queue, so that the last byte gets to each of its places.
    for size in range(1, twin.depth + 1):
        image = rng.integers(0, 256, size).astype(np.uint8).tobytes()
        send(image_packet(image), 0, image, behind=8 * twin.depth)
    # Each bit of the length is 1 in one of these lengths and 0 in the other.
    for size in (LONG, MOST_IMAGE ^ LONG):
        image = rng.integers(0, 256, size).astype(np.uint8).tobytes()
        send(image_packet(image), 0, image)
    data, last = await check(bench, timeline(bench, packets))
    bench.compare("bytes of the images", data, np.frombuffer(b"".join(due), np.uint8))
    ends = np.cumsum([len(image) for image in due]) - 1
    bench.compare("their ends", np.flatnonzero(last), ends)
    bench.finish(at_least=1500)


@cocotb.test()
async def resets(dut):
    bench = Bench(dut)
    rng = bench.rng
    packets = [(whole_packet(rng, 60), int(rng.integers(0, 4)), 0) for _ in range(60)]
    drive = timeline(bench, packets)
    drive["rst"] = random_resets(rng, len(drive["in_valid"]), 60)
    await check(bench, drive)
    bench.finish(at_least=300)
