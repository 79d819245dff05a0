"""The latencies that the tables read are those that the hardware publishes."""

from __future__ import annotations

from golden.scene import load_scene
from hdl import latencies as published
from hdl.common.lookup import latency
from tb.report.measure.latency import FILE, latencies


def test_the_file_is_what_the_hardware_publishes() -> None:
    assert FILE.read_text() == published.text(), "run: python -m hdl.latencies"


def test_the_file_is_read_by_name_and_precision() -> None:
    assert latencies("scene")["digit", "exact"] == latency(load_scene("digit").twin())
    assert latencies("activation")["pade, rho = 4, iterations = 24", "thesis"] == 31
    assert latencies("activation").keys().isdisjoint(latencies("scene"))


def test_the_command_writes_the_file(monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(published, "FILE", tmp_path / "latencies.csv")
    published.main()
    assert (tmp_path / "latencies.csv").read_text() == FILE.read_text()
