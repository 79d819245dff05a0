"""A simulated board: the exported hardware in GHDL, with a converter, behind a port to open."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import tty
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from golden.instruments.uart_instrument import UartInstrument
from tactus.core.fingerprint import ROOT
from tactus.export.exporter import compile_order
from tactus.monitor.board import Drift, nearest_row, samples_of
from tactus.monitor.inside_simulator import CONFIGURATION
from tactus.scene import Scene
from tactus.verify.benches.runner import export
from tactus.verify.benches.simulate import Ghdl, analyse
from tactus.verify.benches.tools import check_simulator, language

# GHDL is ten times as fast as Icarus here, because Icarus goes through a memory word by word in
# every clock.
SIMULATOR = "ghdl"
# This entity around the hardware has the oscillator. If cocotb drove the clock instead, that would
# take half of the time.
TOP = "simulated_board"
VHDL = """\
library ieee;
use ieee.std_logic_1164.all;

entity {top} is
end entity {top};

architecture board of {top} is
    signal clk: std_logic := '0';
    signal rst: std_logic := '1';
    signal miso, rx: std_logic := '1';
    signal cs_n, sclk, mosi, tx: std_logic;
begin
    clk <= not clk after {half} ps;
    rst <= '0' after {reset} ps;
    inside: entity work.{entity} port map (
        clk => clk, rst => rst, miso => miso, cs_n => cs_n, sclk => sclk, mosi => mosi, tx => tx{rx}
    );
end architecture board;
"""
RESET_CLOCKS = 4


class SimulatedBoard:
    """The hardware of a scene in a simulator, which plays the scene's recording.

    The simulation runs as fast as it can, which is slower than the hardware. It waits while nobody
    reads what it sends.

    scene: A scene with a section ``[uart]``.
    hold: How many scans each row of the recording is played for.
    drift: How far its sensors have drifted since the recording.

    port: The path to open as a serial port.
    """

    def __init__(self, scene: Scene, hold: int, drift: Drift | None = None) -> None:
        check_simulator(SIMULATOR)
        self.scene, self.hold, self.drift = scene, hold, drift
        self.port = ""
        self._folder = TemporaryDirectory()

    def __enter__(self) -> SimulatedBoard:
        folder = Path(self._folder.name)
        tongue = language(SIMULATOR)
        export(self.scene, tongue, folder)
        files = folder / self.scene.name / tongue
        twin = self.scene.twin()
        assert isinstance(twin, UartInstrument), "a scene with a section [uart] is that"
        half = round(500_000 / float(twin.converter_reader.clock_mhz))
        top = folder / f"{TOP}.vhd"
        top.write_text(
            VHDL.format(
                top=TOP,
                half=half,
                reset=2 * RESET_CLOCKS * half + half // 2,
                entity=twin.entity,
                rx=", rx => rx" if twin.hears else "",
            )
        )
        sources = (*(files / name for name in compile_order(files)), top)
        analyse(sources, folder)
        environment = {k: v for k, v in os.environ.items() if not k.startswith("COCOTB")}
        simulator = Ghdl(
            TOP,
            folder,
            module="tactus.monitor.inside_simulator",
            sim_build=folder,
            # Before an image is there, memories hold nothing, and GHDL would warn in every clock.
            sim_args=["--ieee-asserts=disable"],
            extra_env=environment | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"},
            log=folder / "log.txt",
        )
        simulator.set_env()
        build, simulate = simulator.build_command()
        built = subprocess.run(build, cwd=folder, capture_output=True, text=True, check=False)
        if built.returncode:
            raise RuntimeError(built.stderr)
        board, computer = os.openpty()
        tty.setraw(board)
        self.port = os.ttyname(computer)
        orders, self._orders = os.pipe()
        configuration = {
            "part": twin.converter_reader.part.name,
            "part_clocks": twin.converter_reader.part.clocks,
            "bit_ps": 2 * half * twin.divisor,
            "hears": twin.hears,
            "samples": samples_of(self.scene, self.drift).tolist(),
            "hold": self.hold,
            "line": board,
            "orders": orders,
        }
        with simulator.log.open("w") as log:
            self._process = subprocess.Popen(
                simulate,
                cwd=folder,
                env=simulator.env | {CONFIGURATION: json.dumps(configuration)},
                pass_fds=(board, orders),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                # GHDL starts a process of its own, so the group is ended. Ctrl-C must reach the
                # command alone, which then ends the simulation.
                start_new_session=True,
            )
        os.close(orders)
        os.close(board)
        # This end is kept open, so that the line is not cut before somebody opens it.
        self._computer = computer
        return self

    def __exit__(self, *error: object) -> None:
        ended = self._process.poll() is not None
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        os.close(self._orders)
        os.close(self._computer)
        log = (Path(self._folder.name) / "log.txt").read_text(errors="replace")
        self._folder.cleanup()
        if ended:
            raise RuntimeError(f"the simulation ended by itself:\n{log}")

    def place(self, targets: Mapping[str, str | float]) -> None:
        """Stay at the recorded row whose outputs are nearest to these."""
        os.write(self._orders, f"{nearest_row(self.scene, targets)}\n".encode())
