"""What a board sends, shown and recorded, and what it is sent: an image to run.

``make monitor``, ``make record`` and ``make load``. A board is a serial port, or simulated.
"""
