"""Finds the hardware block that has the same name as a twin."""

import importlib

from golden.common.block import Block


def hardware(spec: Block):
    """The MyHDL block of ``spec``, which has the same area and name in ``hdl`` as in ``golden``."""
    return getattr(importlib.import_module(f"hdl.{spec.area}.{spec.block}"), spec.block)
