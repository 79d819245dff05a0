"""The commands that need no hardware."""
