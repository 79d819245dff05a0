"""Exports scenes for the tests of a worker, one after the other, in one process.

``python -m tactus.export`` starts Python for each scene, because MyHDL needs a fixed hash seed.
Here one process with that seed makes all exports that the tests of a worker share. It ends with its
input. Each line of the input names a scene, a language and the folder of the builds. The answer to
each is a line too: an empty text, or the traceback of the error.
"""

import json
import subprocess
import sys
import traceback
from contextlib import redirect_stdout
from os import environ
from pathlib import Path

from tactus.core.cli import HASH_SEED
from tactus.core.fingerprint import ROOT
from tactus.export.__main__ import BOTH, export_scene
from tactus.export.hierarchy import LANGUAGES
from tactus.scene import Scene, load_scene


class Exporter:
    """The process, from the side of the tests. It starts with the first export."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None

    def export(self, scene: Scene, tongue: str, build: Path) -> None:
        """Export a scene as VHDL, Verilog or both."""
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, __file__],
                cwd=ROOT,
                env=environ | HASH_SEED | {"PYTHONPATH": str(ROOT)},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                # Its facts and warnings are no output of the test that happens to run.
                stderr=subprocess.DEVNULL,
                text=True,
            )
        orders, answers = self._process.stdin, self._process.stdout
        assert orders
        assert answers
        order = [str(scene.path.resolve()), tongue, str(build.resolve())]
        print(json.dumps(order), file=orders, flush=True)
        if error := json.loads(answers.readline()):
            raise RuntimeError(error)


def serve() -> None:
    """Export what the lines of standard input name."""
    for line in sys.stdin:
        path, tongue, build = json.loads(line)
        error = ""
        try:
            with redirect_stdout(sys.stderr):
                scene = load_scene(path)
                for language in sorted(LANGUAGES) if tongue == BOTH else [tongue]:
                    export_scene(scene, language, Path(build) / scene.name / language)
        except Exception:
            error = traceback.format_exc()
        print(json.dumps(error), flush=True)


if __name__ == "__main__":
    serve()
