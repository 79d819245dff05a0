"""``python -m tb.common.simulate ORDER``: one cocotb-test run, in a process of its own."""

from __future__ import annotations

import json
import sys
from xml.etree import ElementTree

from cocotb_test.simulator import run


def main() -> None:
    order = json.loads(sys.argv[1])
    common = {
        "toplevel": order["entity"],
        "module": order["module"],
        "sim_build": order["build"],
        "waves": order["waves"],
    }
    if order["simulator"] == "ghdl":
        results = run(
            vhdl_sources=order["sources"],
            toplevel_lang="vhdl",
            compile_args=["--std=93"],
            # Signals are undefined until reset; numeric_std warns of each at time 0.
            sim_args=["--ieee-asserts=disable-at-0"],
            **common,
        )
    else:
        results = run(verilog_sources=order["sources"], timescale="1ns/1ps", **common)
    tests = list(ElementTree.parse(results).iter("testcase"))
    if not tests:
        raise SystemExit("no test was executed")
    skipped = [t.get("name", "") for t in tests if t.find("skipped") is not None]
    if skipped:
        raise SystemExit(f"skipped tests: {', '.join(skipped)}")


if __name__ == "__main__":
    main()
