"""``python -m tb.sign_off.equal [--block BLOCK]``: is a block's VHDL the same as its Verilog?

For every input and every state, for ever: each register, each output and each input of a part gets
the same next value from both, if registers and outputs of parts are equal now (``equal_cut``). The
parts are compared by themselves, down to those that have none. Assumed is that registers that both
languages call alike start with equal values, and that Yosys and GHDL's synthesis read their language
rightly; ``equal_netlist`` says what is known of the second.

Each fault that the block's bench names is put into a copy of the Verilog and must be found to differ.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from os import cpu_count
from pathlib import Path
from typing import Any

from golden.cli import CommandError, run_command
from golden.fingerprint import fingerprint
from hdl.synth.tools import code
from tb.common.collected import BENCHES, FAULTS
from tb.common.runner import Job
from tb.sign_off.equal_netlist import list_lengths, synthesise, to_verilog
from tb.sign_off.equal_proof import DIFFERENT, EQUAL, compare
from tb.sign_off.record import write_record
from tb.sign_off.subject import subject

KIND = "equivalence"
