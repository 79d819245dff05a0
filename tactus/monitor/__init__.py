"""Shows and records what a board sends, and sends it an image to run."""
