"""Files and folders are replaced as a whole, with the permissions that the umask allows."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from golden.input_error import InputError
from tactus.core import store
from tactus.core.files import check_writable, replace_file, replace_files, replace_folder, same_file


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
        raise InputError("half")


def test_a_failure_leaves_what_was(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("old", encoding="utf-8")
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "c.csv").write_text("old", encoding="utf-8")
    for replace, target, file in ((replace_file, "a.csv", ""), (replace_folder, "b", "c.csv")):
        with pytest.raises(InputError, match="half"):
            half(replace, tmp_path / target, file)
        assert (tmp_path / target / file).read_text(encoding="utf-8") == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "b"]


def test_several_files_are_replaced_or_none(tmp_path: Path) -> None:
    """This holds even if the fault only shows when the last file is renamed."""
    paths = [tmp_path / "new.csv", tmp_path / "old.csv", tmp_path / "last.csv"]
    paths[1].write_text("old", encoding="utf-8")

    def replace(fault: Callable[[], object]) -> None:
        with replace_files(paths) as temporaries:
            for temporary in temporaries:
                temporary.write_text("new", encoding="utf-8")
            fault()

    with pytest.raises(InputError, match=r"last.csv: cannot be written: Is a directory"):
        replace(paths[2].mkdir)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["last.csv", "old.csv"]
    assert paths[1].read_text(encoding="utf-8") == "old"
    paths[2].rmdir()
    replace(lambda: None)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["last.csv", "new.csv", "old.csv"]
    assert {path.read_text(encoding="utf-8") for path in paths} == {"new"}


def test_what_can_be_written_is_found_out_without_writing(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("old", encoding="utf-8")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "to-pipe").symlink_to("pipe")
    for name in ("pipe", "to-pipe"):
        with pytest.raises(InputError, match="cannot be written: got no regular file"):
            check_writable([tmp_path / name])
        with pytest.raises(InputError, match="got no reg"), replace_file(tmp_path / name):
            pass
    assert (tmp_path / "to-pipe").is_fifo()
    (tmp_path / "to-pipe").unlink()
    (tmp_path / "pipe").unlink()
    check_writable([tmp_path / "a.csv", tmp_path / "b" / "c" / "d.csv"])
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]
    for name in ("a.csv/b.csv", ".", "x" * 5000, "b/\0"):
        with pytest.raises(InputError, match="cannot be written: "):
            check_writable([tmp_path / name])
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]


def test_one_file_by_two_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a").touch()
    (tmp_path / "link").symlink_to("a")
    (tmp_path / "later").symlink_to("not-yet")
    (tmp_path / "hard").hardlink_to(tmp_path / "a")
    for one, other in (("a", "b/../a"), ("a", "link"), ("not-yet", "later"), ("a", "hard")):
        assert same_file(tmp_path / one, tmp_path / other)
    for one, other in (("a", "b"), ("a", "A"), ("link", "later")):
        assert not same_file(tmp_path / one, tmp_path / other)
    # On a file system that folds capitals:
    samefile = Path.samefile
    monkeypatch.setattr(
        Path, "samefile", lambda p, q: str(p).lower() == str(q).lower() or samefile(p, q)
    )
    assert same_file(tmp_path / "new.npz", tmp_path / "NEW.npz")


def test_what_a_killed_command_left_is_removed_once_it_is_old(tmp_path: Path) -> None:
    old, new, other = (tmp_path / f".vhdl.{word}" for word in ("0" * 16, "1" * 16, "mine"))
    for folder in (old, new, other):
        folder.mkdir()
        (folder / "half.vhd").touch()
    for folder in (old, other):
        os.utime(folder, (0, 0))
    with replace_folder(tmp_path / "vhdl"):
        pass
    assert {path.name for path in tmp_path.iterdir()} == {"vhdl", new.name, other.name}


def test_an_answer_that_is_damaged_is_missing(tmp_path: Path) -> None:
    asked = store.key("kind", part="one")
    for _ in range(2):
        assert store.read(asked, tmp_path) is None
        assert store.write(asked, [1], tmp_path) == [1]
        assert store.read(asked, tmp_path) == [1]
        file = store.place(asked, tmp_path)
        file.write_bytes(file.read_bytes()[:20])
