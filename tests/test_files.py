"""Files and folders are replaced whole, with the permissions that the umask leaves."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from golden.files import replace_file, replace_folder


@contextmanager
def umask(mask: int) -> Iterator[None]:
    before = os.umask(mask)
    try:
        yield
    finally:
        os.umask(before)


@pytest.mark.parametrize(("mask", "file", "folder"), [(0o022, 0o644, 0o755), (0o077, 0o600, 0o700)])
def test_permissions_are_those_of_the_umask(
    tmp_path: Path, mask: int, file: int, folder: int
) -> None:
    with umask(mask):
        for _ in range(2):  # new, and in place of another
            with replace_file(tmp_path / "a.csv") as path:
                path.write_text("1\n", encoding="utf-8")
            with replace_folder(tmp_path / "b") as path:
                (path / "c.csv").write_text("1\n", encoding="utf-8")
            assert (tmp_path / "a.csv").stat().st_mode & 0o777 == file
            assert (tmp_path / "b").stat().st_mode & 0o777 == folder
            assert (tmp_path / "b" / "c.csv").stat().st_mode & 0o777 == file
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "b"]


def half(replace: Callable, target: Path, file: str) -> None:
    with replace(target) as path:
        (path / file).write_text("new", encoding="utf-8")
        raise ValueError("half")


def test_a_failure_leaves_what_was(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("old", encoding="utf-8")
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "c.csv").write_text("old", encoding="utf-8")
    for replace, target, file in ((replace_file, "a.csv", ""), (replace_folder, "b", "c.csv")):
        with pytest.raises(ValueError, match="half"):
            half(replace, tmp_path / target, file)
        assert (tmp_path / target / file).read_text(encoding="utf-8") == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "b"]
