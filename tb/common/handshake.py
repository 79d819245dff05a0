"""Plays both ends of an AXI4-Stream block: it offers elements, takes results and records."""

import numpy as np

from tb.common.bench import Bench, Offer, Recording

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
    offered = Offer("s_axis_t", {"data": data, "last": last}, lambda clock, _: offer[clock])
    watch = ["m_axis_tvalid", "m_axis_tdata", "m_axis_tlast", *told, "frame_error"]
    return await bench.play({"rst": resets, "m_axis_tready": take}, watch, offered)


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
