"""Tests a training search on a cluster, which joblib selects and which gives the same record."""

import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import pytest
from distributed import Client, LocalCluster

from golden.input_error import InputError
from tactus.scene import Scene
from tactus.train.candidate_runs import continued
from tactus.train.descent.cluster import computed_on
from tactus.train.descent.search import Result, candidates, measure
from tactus.train.descent.task import task_for


def searched(scene: Scene, record: Path, workers: int = 1) -> list[Result]:
    """The results of 3 sizes with 2 starts each."""
    members = (replace(scene.members[0], hidden=0),)
    scene = replace(scene, members=members, training=replace(scene.training, hidden=(2, 4)))
    task = task_for(scene, scene.vectors(), [])
    return list(continued(measure, Result, task, candidates(task), record, workers))


def test_a_dask_cluster_gives_the_same_record(small_scene: Scene, tmp_path: Path) -> None:
    """The two worker processes are reached over sockets, as those of another machine would be."""
    here = searched(small_scene, tmp_path / "here.jsonl")
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with cluster, Client(cluster) as client:
        with computed_on(client.scheduler.address):
            there = searched(small_scene, tmp_path / "there.jsonl", workers=-1)
        worker = next(iter(client.scheduler_info()["workers"]))
        message = f"CLUSTER={worker}: no scheduler answers: what answers there is a Worker of Dask"
        with pytest.raises(InputError, match=message), computed_on(worker):
            pass
        executed = client.run(lambda dask_worker: dask_worker.state.executed_count)
    assert there == here
    assert (tmp_path / "there.jsonl").read_bytes() == (tmp_path / "here.jsonl").read_bytes()
    assert len(executed) == 2
    assert sum(executed.values()) > 0, "the cluster computed nothing"


@contextmanager
def listening(answer: Callable[[socket.socket], object]) -> Iterator[str]:
    """The address of a program that listens but is not a scheduler."""
    server = socket.create_server(("127.0.0.1", 0))
    taken: list[socket.socket] = []

    def serve() -> None:
        with suppress(OSError):
            while True:
                taken.append(server.accept()[0])
                answer(taken[-1])

    threading.Thread(target=serve, daemon=True).start()
    try:
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"
    finally:
        for one in (server, *taken):
            one.close()


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (lambda taken: None, "nothing within 1 s"),
        (lambda taken: taken.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n"), "what .* another proto"),
        (lambda taken: taken.sendall(bytes(4000)), "what answers there speaks another protocol"),
        (lambda taken: taken.sendall(bytes(range(256))), "what answers there speaks another"),
        (lambda taken: taken.close(), "(nothing within|Timed out|in <TCP)"),
    ],
    ids=["silent", "http", "zeros", "bytes", "closed"],
)
def test_what_listens_and_is_no_scheduler_is_refused_in_seconds(
    answer: Callable[[socket.socket], object], reason: str, capfd: pytest.CaptureFixture
) -> None:
    """Otherwise it would wait for seven minutes, or try to read a message of 3.07 EiB."""
    with listening(answer) as address:
        message = f"^CLUSTER={address}: no scheduler answers: {reason}.*; expected the address of a"
        with pytest.raises(InputError, match=message) as refused, computed_on(address, 1.0):
            pass
        assert "\n" not in str(refused.value)
    said = capfd.readouterr()
    assert (said.out, said.err) == (
        f"CLUSTER={address}: asking for its scheduler, 1 s at most\n",
        "",
    )
