"""A user's own rig: a scene from readings, whether it can work, and outputs for new readings.

``make scene``, ``make check`` and ``make predict``.
"""
