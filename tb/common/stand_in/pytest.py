"""What cocotb looks up in pytest, but does not use where a bench does not use pytest.

cocotb imports pytest for tests that say by pytest how they end, and for assertions that pytest
rewrites: ours are none of these. Every bench starts a process of its own, and a fifth of its start
is the import of pytest.
"""

import sys
from types import ModuleType


class _EndedError(Exception):
    """Never raised."""


class _Outcome:
    """Stands for pytest's ``raises``, ``skip`` and ``xfail``."""

    Exception = _EndedError


raises = skip = xfail = _Outcome

for _place, _name in (("assertion", "install_importhook"), ("config", "Config")):
    _module = ModuleType(f"_pytest.{_place}")
    setattr(_module, _name, None)
    sys.modules[_module.__name__] = _module
