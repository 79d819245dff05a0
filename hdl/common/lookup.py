"""From a twin's constants to the hardware block of the same name."""

import importlib

from golden.block import Block


def hardware(spec: Block):
    """The MyHDL block of ``spec``: one name, one address in every room."""
    return getattr(importlib.import_module(f"hdl.{spec.area}.{spec.block}"), spec.block)
