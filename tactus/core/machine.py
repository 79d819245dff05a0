"""The machine on which a figure was measured: processor, instruction set and versions.

The last bit of a floating-point result depends on the instructions that numpy and OpenBLAS choose
when they are loaded, so a result from elsewhere can be understood only with these facts.
"""

import os
import platform
from importlib.metadata import version
from pathlib import Path

import numpy as np
import threadpoolctl


def processor_minutes() -> float:
    """What this process and all those that it started and waited for have used so far."""
    return sum(os.times()[:4]) / 60


def processor_line(minutes: float, processors: int = 2) -> str:
    """The line that tells the processor time, and what it means on an idle machine.

    Answers that were in the store took no time, so only a run with an empty store tells all of it.
    """
    return (
        f"processor time {minutes:.1f} minutes, without the answers that the store had; at least "
        f"{minutes / processors:.1f} minutes on {processors} processors that do nothing else"
    )


CPUINFO = Path("/proc/cpuinfo")

# Variables with which an x86-64 processor computes like another one. On other processors they
# change nothing.
SETTINGS: dict[str, dict[str, str]] = {
    "numpy-avx2": {"NPY_DISABLE_CPU_FEATURES": "X86_V4"},
    "numpy-sse": {"NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4"},
    "openblas-prescott": {"OPENBLAS_CORETYPE": "Prescott"},
    "openblas-haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "openblas-skylakex": {"OPENBLAS_CORETYPE": "SkylakeX"},
    "glibc-sse": {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F"},
    "one-thread": {"OPENBLAS_NUM_THREADS": "1"},
    "two-threads": {"OPENBLAS_NUM_THREADS": "2"},
}


def processor() -> str:
    """Name of the processor if the system states it, architecture, and number of cores."""
    text = CPUINFO.read_text(encoding="utf-8", errors="replace") if CPUINFO.is_file() else ""
    fields = dict(line.split(":", 1) for line in text.splitlines() if ":" in line)
    found = {key.strip(): value.strip() for key, value in fields.items()}
    name = found.get("model name") or platform.processor()
    cores = os.cpu_count() or 1
    facts = [name, platform.machine(), f"{cores} core{'s' if cores > 1 else ''}"]
    return ", ".join(fact for fact in facts if fact)


def numpy_targets() -> list[str]:
    """The instruction sets with which numpy runs its loops over float64."""
    loops = np.lib.introspect.opt_func_info(signature="float64").values()
    current = {kind["current"] for function in loops for kind in function.values()}
    return sorted(name.removeprefix("baseline(").rstrip(")") for name in current)


def blas_cores() -> list[str]:
    """Core and number of threads of each linear algebra library: numpy's and scipy's."""
    # This loads the library that scipy brings. Commands that state no machine do without it.
    import scipy.linalg  # noqa: F401

    found = {
        f"{library['internal_api']} {library.get('architecture', 'of unknown core')}, threads: "
        f"{library['num_threads']}"
        for library in threadpoolctl.threadpool_info()
        if library["user_api"] == "blas"
    }
    return sorted(found) or ["unknown linear algebra"]


def versions(*packages: str) -> dict[str, str]:
    """Versions of packages by name; ``python`` is the interpreter."""
    return {
        name: platform.python_version() if name == "python" else version(name) for name in packages
    }


def facts(**programs: str) -> dict[str, str]:
    """All facts by name; ``programs`` are versions of programs that are no Python packages."""
    named = versions("tactus", "python", "numpy", "scipy", "myhdl", "cocotb") | programs
    return {
        "processor": processor(),
        "instructions": "; ".join([f"numpy {' '.join(numpy_targets())}", *blas_cores()]),
        "system": platform.platform(),
        "versions": ", ".join(f"{name} {number}" for name, number in named.items()),
    }


def closing(seconds: float, **programs: str) -> list[str]:
    """The last lines of a command: ``facts``, and the time that the command took."""
    found = facts(**programs) | {"took": f"{seconds:.0f} s"}
    return [f"{name:13} {text}" for name, text in found.items()]
