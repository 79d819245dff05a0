"""A search on a Dask cluster: first finds the scheduler at an address, then uses its workers."""

import asyncio
import logging
import queue
import struct
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from joblib import parallel_config

from golden.input_error import InputError

# Seconds within which a scheduler has to answer.
LIMIT = 5.0
EXTRA = "cluster"
# The errors with which Dask's reader of messages stops, since it takes any bytes for lengths.
NO_MESSAGE = (MemoryError, struct.error, OverflowError, EOFError, UnicodeDecodeError)


@contextmanager
def computed_on(cluster: str | None, limit: float = LIMIT) -> Iterator[None]:
    """Compute candidates on the Dask scheduler at this address; without one, on this machine."""
    if cluster is None:
        yield
        return
    # Dask is imported only when it is needed, because that takes a second and not everybody has it.
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            f"CLUSTER={cluster}: Dask is not installed, expected the extra {EXTRA!r}: pip install "
            f"-e '.[{EXTRA}]' in the folder of tactus"
        ) from None
    print(f"CLUSTER={cluster}: asking for its scheduler, {limit:g} s at most", flush=True)
    reason = why_no_scheduler(cluster, limit)
    if not reason:
        try:
            client = Client(cluster, timeout=limit)
        except Exception as error:  # whatever it says is about the address
            reason = _first_line(error)
    if reason:
        raise InputError(
            f"CLUSTER={cluster}: no scheduler answers: {reason}; expected the address of a Dask "
            "scheduler, such as tcp://192.168.1.10:8786"
        )
    with client, parallel_config("dask"):
        print(f"CLUSTER={cluster}: {len(client.scheduler_info()['workers'])} workers", flush=True)
        yield


def why_no_scheduler(address: str, limit: float) -> str:
    """Why the address is not that of a scheduler; empty where one answers in time.

    A client of Dask asks an address that does not answer again and again, and waits for minutes. So
    the address is asked once before, in a thread of its own, because looking up a name cannot be
    interrupted.
    """
    told: queue.Queue[str] = queue.Queue()
    # Otherwise Dask logs every connection that fails.
    quiet = logging.getLogger("distributed")
    level = quiet.level
    quiet.setLevel(logging.CRITICAL + 1)
    try:
        threading.Thread(
            target=lambda: told.put(_reason(address, limit)), name="ask", daemon=True
        ).start()
        return told.get(timeout=limit)
    except queue.Empty:
        return f"nothing within {limit:g} s"
    finally:
        quiet.setLevel(level)


def _reason(address: str, limit: float) -> str:
    try:
        answer = asyncio.run(asyncio.wait_for(_identity(address, limit), limit))
    except TimeoutError:
        return f"nothing within {limit:g} s"
    except NO_MESSAGE:
        return "what answers there speaks another protocol"
    except Exception as error:  # whatever it says is about the address
        return _first_line(error)
    if isinstance(answer, dict) and "workers" in answer:
        return ""
    kind = answer.get("type") if isinstance(answer, dict) else None
    return f"what answers there is a {kind} of Dask" if kind else "what answers there is no Dask"


async def _identity(address: str, limit: float) -> Any:
    """The description that a server of Dask gives of itself."""
    from distributed.comm import connect
    from distributed.security import Security

    # For tls:// the settings come from Dask's own configuration, as for its client.
    settings = Security().get_connection_args("client")
    comm = await connect(address, timeout=limit, **settings)
    try:
        await comm.write({"op": "identity", "reply": True})
        return await comm.read()
    finally:
        comm.abort()


def _first_line(error: Exception) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0]
