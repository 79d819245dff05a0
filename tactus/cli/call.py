"""``python -m tactus.cli.call MODULE WORDS``: runs the function ``main`` of a command's module.

MyHDL orders sensitivity lists by hash, so this starts itself again where the hash seed is not
fixed: the output of a command is the same bytes every time.
"""

import os
import sys
from importlib import import_module

from tactus.core.cli import HASH_SEED, run


def main() -> int | None:
    module = sys.argv.pop(1)
    code: int | None = import_module(module).main()
    return code


if __name__ == "__main__":
    if os.environ | HASH_SEED != os.environ:
        os.environ.update(HASH_SEED)
        os.execv(sys.executable, [sys.executable, "-m", "tactus.cli.call", *sys.argv[1:]])
    sys.exit(run(main))
