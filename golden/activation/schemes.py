"""The activations that a scene can name: every module of this package that has a ``SCHEME``."""

import pkgutil
from importlib import import_module
from pathlib import Path

from golden.activation.scheme import Scheme


def _found() -> dict[str, Scheme]:
    names = [module.name for module in pkgutil.iter_modules([str(Path(__file__).parent)])]
    modules = {n: import_module(f"{__package__}.{n}") for n in names if n != "schemes"}
    found = {name: module.SCHEME for name, module in modules.items() if hasattr(module, "SCHEME")}
    return dict(sorted(found.items(), key=lambda item: item[1].half_codes))


# By name, in alphabetical order; those with half codes are last, because few designs take them.
SCHEMES = _found()


def forms() -> dict[str, Scheme]:
    """All schemes, and each scheme once more for every other choice of a text option."""
    found = dict(SCHEMES)
    for name, scheme in SCHEMES.items():
        for option, about in scheme.options.items():
            for choice in about.choices:
                if choice != about.default:
                    found[f"{name} {choice}"] = scheme.configured({option: choice})
    return found
