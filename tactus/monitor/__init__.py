"""Shows and records what a board sends, and sends it an image to run.

The commands are ``make monitor``, ``make record`` and ``make load``. A board is reached over a
serial port, or it is simulated.
"""
