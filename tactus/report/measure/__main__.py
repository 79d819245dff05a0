"""``python -m tactus.report.measure [TABLE ...]``: measures, prints and writes every table.

``build/figures`` holds what the last call measured: one CSV for each table, and figures.json with
all tables, the seed and the versions of everything that took part. The same versions and seed give
the same bytes on one machine; on another machine figures from floating point differ by what
studies/spread found.
"""

import sys
from typing import Any

from golden.input_error import InputError, suggest
from tactus.core.cli import run, stop_if_dry_run, words
from tactus.core.commands import arguments_of
from tactus.core.files import replace_folder, write_json
from tactus.core.fingerprint import ROOT, fingerprint, sources
from tactus.core.machine import versions
from tactus.report.measure.registry import TABLES


def main() -> None:
    arguments = arguments_of("figures", __doc__)
    names = words("TABLE", arguments.table or "") or list(TABLES)
    for name in names:
        if name not in TABLES:
            raise InputError(
                f"TABLE={name}: no such table, expected one of {', '.join(TABLES)}"
                f"{suggest(name, list(TABLES))}"
            )
    folder = arguments.build / "figures"
    stop_if_dry_run(f"measure {', '.join(names)} and write {folder}")
    with replace_folder(folder) as temporary:
        data: dict[str, Any] = {
            "seed": arguments.seed,
            "versions": versions("tactus", "python", "numpy", "scipy"),
            "sources": fingerprint([*sources("golden", "tactus"), ROOT / "scenes" / "data"]),
            "tables": {},
        }
        for name in names:
            table = TABLES[name](arguments.seed)
            table.write_csv(temporary / f"{name}.csv")
            data["tables"][name] = table.as_data()
            print("\n".join(table.lines()), end="\n\n", flush=True)
        write_json(temporary / "figures.json", data)
    print(f"wrote {folder}")


if __name__ == "__main__":
    sys.exit(run(main))
