"""Plays both ends of an AXI4-Stream block: it offers elements, takes results and records."""

import time
from collections.abc import Iterator

import numpy as np

from tb.common.bench import RESET_CLOCKS, Bench, Recording, each_half, reader, writer

PORTS = [f"{side}_axis_{name}" for side in "sm" for name in ("tvalid", "tready", "tdata", "tlast")]

# Where the largest output is told, with the last one of a frame.
TUSER = "m_axis_tuser"


async def exchange(
    bench: Bench,
    data: np.ndarray,
    last: np.ndarray,
    offer: np.ndarray,
    take: np.ndarray,
    resets: np.ndarray,
) -> Recording:
    """Play the elements in their order. Each is offered until it is taken.

    data, last: The elements. An element that is offered during a reset is lost.
    offer, take: Whether a new element is offered, and whether results are taken, in each clock.
    """
    told = [port.name for port in bench.twin.ports if port.name == TUSER]
    ports = ["rst", *PORTS, *told, "frame_error"]
    read, taking = reader(bench.dut, ports), ports.index("s_axis_tready")
    driven = ("clk", "rst", "s_axis_tvalid", "s_axis_tdata", "s_axis_tlast", "m_axis_tready")
    clock, *writes = (writer(bench.dut, name) for name in driven)
    words: list[str] = []
    clear = np.ones(RESET_CLOCKS, dtype=bool)

    def halves() -> Iterator[None]:
        at, offered = 0, False
        for reset, wanted, ready in zip(
            np.concatenate([clear, resets]),
            np.concatenate([~clear, offer]),
            np.concatenate([~clear, take]),
            strict=True,
        ):
            offered = (offered or bool(wanted)) and at < len(data)
            # While nothing is offered, the port shows another element, which must have no effect.
            shown = at if offered else (at + 7) % len(data)
            clock(0)
            values = (reset, offered, data[shown], last[shown], ready)
            for write, value in zip(writes, values, strict=True):
                write(int(value))
            yield
            row = read()
            words.extend(row)
            if offered and (reset or row[taking] == "1"):
                at, offered = at + 1, False
            clock(1)
            yield

    started = time.perf_counter()
    await each_half(halves())
    return bench.watched(Recording(ports, words, time.perf_counter() - started))


def transfers(recording: Recording, side: str) -> np.ndarray:
    """The rows in which an element is transferred on side ``s`` or ``m``."""
    ready = recording.rows(f"{side}_axis_tready")
    return np.intersect1d(recording.rows(f"{side}_axis_tvalid"), ready)


def check_kept(bench: Bench, recording: Recording) -> None:
    """Check that an offered result stays until it is taken or a reset comes."""
    offered = recording.rows("m_axis_tvalid")
    waits = np.setdiff1d(offered, transfers(recording, "m"))
    waits = np.setdiff1d(waits, recording.resets())
    waits = waits[waits + 1 < recording.clocks]
    bench.compare("m_axis_tvalid kept", np.isin(waits + 1, offered), np.ones(len(waits), bool))
    closing = np.isin(waits, recording.rows("m_axis_tlast"))
    if TUSER in recording.columns:
        rows = waits[closing]
        now, then = (recording.unsigned(TUSER, rows + late) for late in (0, 1))
        bench.compare(f"{TUSER} kept", then, now)
    for port in ("m_axis_tdata", "m_axis_tlast"):
        now, then = recording.unsigned(port, waits), recording.unsigned(port, waits + 1)
        bench.compare(f"{port} kept", then, now)
