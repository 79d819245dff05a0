"""Measures the candidates of a training on several processors, or on a Dask cluster."""

import asyncio
import json
import logging
import queue
import struct
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed, parallel_config

from golden.input_error import InputError
from tactus.core.files import reading, writing
from tactus.train.search import Result
from tactus.train.task import Task

# The fewest training rows, and at most as many validation rows, on which candidates are compared.
FIRST_ROWS = 1000


def continued(
    measured: Callable[..., Result],
    task: Task,
    candidates: Sequence[tuple[Any, ...]],
    record: Path,
    workers: int,
) -> Iterator[Result]:
    """The results of all candidates, in order, of a search that can be interrupted.

    measured: Trains and measures one candidate of a task.
    candidates: What it gets beside the task.
    record: A line for each result, in the order of the candidates. Those that an earlier search has
        left are not computed again.
    workers: The number of processes; -1 for one on each core.
    """
    known = list(_read(record))
    yield from known
    with writing(record):
        record.parent.mkdir(parents=True, exist_ok=True)
        lines = [json.dumps(asdict(result)) + "\n" for result in known]
        # An earlier search may have been interrupted within a line.
        record.write_text("".join(lines), encoding="utf-8")
    jobs = (delayed(measured)(task, *candidate) for candidate in candidates[len(known) :])
    for result in Parallel(n_jobs=workers, return_as="generator")(jobs):
        with writing(record), record.open("a", encoding="utf-8") as handle:
            handle.write(json.dumps(asdict(result)) + "\n")
        yield result


def parts_of(task: Task) -> Iterator[Task]:
    """The task on random rows, each time on those before and as many more; the last has all.

    After each of them the worse half of the candidates is left out (K. Jamieson and A. Talwalkar,
    "Non-stochastic best arm identification and hyperparameter optimization", AISTATS 2016).
    """
    rng = np.random.default_rng([task.scene.training.seed, task.number])
    frames = {name: getattr(task, name) for name in ("training", "validation")}
    orders = {name: rng.permutation(len(part.inputs)) for name, part in frames.items()}
    rows = FIRST_ROWS
    while rows < len(task.training.inputs):
        yield replace(task, **{n: part.take(orders[n][:rows]) for n, part in frames.items()})
        rows *= 2
    yield task


def _read(record: Path) -> Iterator[Result]:
    if not record.is_file():
        return
    with reading(record, "a record of candidates, which may be deleted"):
        for line in record.read_text(encoding="utf-8").split("\n")[:-1]:
            facts = json.loads(line)
            yield Result(**facts | {key: tuple(facts[key]) for key in ("layers", "point")})


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
