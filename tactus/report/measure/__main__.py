"""``python -m tactus.report.measure [TABLE ...]``: measures, prints and writes every table.

``build/figures`` holds what the last call measured: one CSV for each table, and figures.json with
all tables, the seed and the versions of everything that took part. With ``--record`` the tables
that ``tactus.report.measure.table_records`` names are also recorded for the report. The same
versions and seed give the same bytes on one machine; on another machine, figures from floating
point differ by what ``tactus.report.measure.spread`` measures. Run times differ from call to call,
so tables that hold some stand in full in times.json, with the machine, and without them in the
other files.
"""

import argparse
import sys
from pathlib import Path
from typing import Any

from golden.input_error import InputError, suggest
from tactus.core.cli import MOST_SEED, run, stop_if_dry_run, whole
from tactus.core.files import replace_folder, write_json
from tactus.core.fingerprint import ROOT, fingerprint, sources
from tactus.core.folders import BUILD
from tactus.core.machine import facts, versions
from tactus.report.measure import table_records
from tactus.report.measure.registry import ASKED, TABLES


def main() -> None:
    parser = argparse.ArgumentParser(prog="make figures", description=__doc__)
    parser.add_argument("tables", nargs="*", metavar="TABLE")
    parser.add_argument("--seed", type=whole("SEED", 0, MOST_SEED), default=1)
    parser.add_argument("--build", type=Path, default=BUILD)
    parser.add_argument("--record", action="store_true")
    arguments = parser.parse_args()
    names = arguments.tables or list(TABLES)
    known = TABLES | ASKED
    for name in names:
        if name not in known:
            raise InputError(
                f"TABLE={name}: no such table, expected one of {', '.join(known)}"
                f"{suggest(name, list(known))}"
            )
    if arguments.record:
        refuse_others(names, arguments.seed)
    folder = arguments.build / "figures"
    stop_if_dry_run(f"measure {', '.join(names)} and write {folder}")
    with replace_folder(folder) as temporary:
        data = {
            "seed": arguments.seed,
            "versions": versions("tactus", "python", "numpy", "scipy"),
            "sources": fingerprint([*sources("golden", "tactus"), ROOT / "scenes" / "data"]),
            "tables": {},
        }
        times: dict[str, Any] = {}
        for name in names:
            table = known[name](arguments.seed)
            if table.timed:
                times[name] = table.as_data()
            again = table.without_times()
            again.write_csv(temporary / f"{name}.csv")
            data["tables"][name] = again.as_data()
            print("\n".join(table.lines()), end="\n\n", flush=True)
            if arguments.record:
                print(f"recorded in {table_records.write(table)}")
        write_json(temporary / "figures.json", data)
        if times:
            write_json(temporary / "times.json", {"machine": facts(), "tables": times})
    print(f"wrote {folder}")


def refuse_others(names: list[str], seed: int) -> None:
    """Refuse to record tables that every report measures, or tables of another seed."""
    kept = (*table_records.RECORDED, *table_records.FOR_PAGES)
    others = [name for name in names if name not in kept]
    if others:
        raise InputError(
            f"TABLE={others[0]}: is measured for every report, expected one of "
            f"{', '.join(kept)} with RECORD=1"
        )
    if seed != table_records.SEED:
        raise InputError(f"SEED={seed}: expected {table_records.SEED} with RECORD=1")


if __name__ == "__main__":
    sys.exit(run(main))
