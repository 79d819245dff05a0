"""How well few learned functions tell dry beans apart; brings the data that this needs."""

import csv
import hashlib
import urllib.request
from collections.abc import Iterator
from pathlib import Path

from golden.input_error import InputError
from tactus.core.files import replace_file
from tactus.errors import decisions_of, held_out_or_all
from tactus.scene import load_scene

FOLDER = Path(__file__).parent
SCENE, DATA = FOLDER / "beans-tables.toml", FOLDER / "beans.csv"
# A copy of the data set as UCI has it, with a column of numbers in front.
ADDRESS = (
    "https://raw.githubusercontent.com/julieishimwe/Datasets/"
    "62695576a460e0c2e2e0960fd81b5d4ff05a1f78/Dry_Bean_Dataset.csv"
)
ADDRESS_SHA256 = "26266219febc20e471854c8cd7dd4de3f44941dc185883d0a00cb4bdb163deed"
DATA_SHA256 = "382e279c76d7654149fe32a9e4959f81d5c850f53b19449a4e7c3c14bdece26b"
COLUMNS = {
    "MajorAxisLength": "major_axis",
    "MinorAxisLength": "minor_axis",
    "AspectRation": "aspect_ratio",  # spelt so
    "EquivDiameter": "equivalent_diameter",
    "Solidity": "solidity",
    "roundness": "roundness",
}


def bring(address: str = ADDRESS) -> None:
    """Write the scene's data from those at an address, if they are not there."""
    if DATA.is_file():
        return
    data = converted(fetched(address, ADDRESS_SHA256).decode())
    with replace_file(DATA) as temporary:
        temporary.write_bytes(checked(data.encode(), DATA_SHA256, str(DATA)))


def fetched(address: str, digest: str) -> bytes:
    """The data at an address, if they have the digest."""
    try:
        with urllib.request.urlopen(address) as answer:
            return checked(answer.read(), digest, address)
    except OSError as error:
        raise InputError(f"{address}: cannot be read: {error}") from None


def checked(data: bytes, expected: str, name: str) -> bytes:
    """The data, if they have the digest."""
    got = hashlib.sha256(data).hexdigest()
    if got != expected:
        raise InputError(f"{name}: got sha256 {got}, expected {expected}")
    return data


def converted(text: str) -> str:
    """Six measures in four digits, with the sort of bean and its number."""
    rows = list(csv.DictReader(text.splitlines()))
    sorts = list(dict.fromkeys(row["Class"] for row in rows))
    lines = [",".join([*COLUMNS.values(), "bean", "sort"])]
    for row in rows:
        measures = [f"{float(row[name]):.4g}" for name in COLUMNS]
        sort = row["Class"]
        lines.append(",".join([*measures, sort.lower(), str(sorts.index(sort) + 1)]))
    return "\n".join([*lines, ""])


def rows() -> Iterator[dict[str, str | int]]:
    """The decisions on held-out rows."""
    bring()
    scene = load_scene(str(SCENE))
    held_out, _ = held_out_or_all(scene, decisions_of(scene))
    yield {"network": scene.name, "held-out rows": len(held_out.actual), "right": held_out.right}
