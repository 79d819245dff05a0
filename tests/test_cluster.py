"""A training search on a cluster: joblib's own way to name one, and the same record as here."""

from __future__ import annotations

from pathlib import Path

import pytest
from distributed import Client, LocalCluster
from test_training import open_search, searched

from golden.cli import CommandError
from golden.scene import Scene
from golden.training.__main__ import computed_on


def test_a_dask_cluster_gives_the_same_record(small_scene: Scene, tmp_path: Path) -> None:
    """Two worker processes, reached over sockets as those of another machine would be."""
    scene = open_search(small_scene)
    here = searched(scene, tmp_path / "here.jsonl")
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with cluster, Client(cluster) as client:
        with computed_on(client.scheduler.address):
            there = searched(scene, tmp_path / "there.jsonl", workers=-1)
        executed = client.run(lambda dask_worker: dask_worker.state.executed_count)
    assert there == here
    assert (tmp_path / "there.jsonl").read_bytes() == (tmp_path / "here.jsonl").read_bytes()
    assert len(executed) == 2
    assert sum(executed.values()) > 0, "the cluster computed nothing"


def test_a_cluster_that_does_not_answer() -> None:
    message = "CLUSTER=tcp://127.0.0.1:9: no scheduler answers"
    with pytest.raises(CommandError, match=message), computed_on("tcp://127.0.0.1:9"):
        pass
