"""A user's own rig: makes a scene from readings, checks it, and predicts outputs.

The commands are ``make scene``, ``make check`` and ``make predict``.
"""
