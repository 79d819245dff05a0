"""Files of one commit of a public git repository."""

import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from studies.peers.installed import run
from tactus.core.files import replace_folder


def cloned(folder: Path, repository: str, commit: str, files: Mapping[str, str]) -> Path:
    """A folder with some files of a commit, which are downloaded if they are not there.

    repository: Its URL.
    files: The path in the repository of each file, by its path in the folder.
    """
    place = folder / commit
    if not all((place / name).is_file() for name in files):
        with tempfile.TemporaryDirectory() as clone, replace_folder(place) as new:
            git = ["git", "-C", clone]
            run(["git", "init", "--quiet", clone])
            # First without the files, many of which are large: git fetches those that are named.
            run([*git, "remote", "add", "origin", repository])
            run([*git, "fetch", "--quiet", "--depth=1", "--filter=blob:none", "origin", commit])
            run([*git, "checkout", "--quiet", "FETCH_HEAD", "--", *files.values()])
            for name, path in files.items():
                (new / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(Path(clone) / path, new / name)
    return place
