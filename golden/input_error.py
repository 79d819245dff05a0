"""What tells a user that the input or the machine is at fault, and not this project."""


class InputError(Exception):
    """A fault of what the user gave, or of the user's machine; the message says what to do.

    It names the file and the key, or the variable of the command, what came and what was expected.
    A command prints it as one line and exits with 2. Every other exception is a fault of this
    project, and keeps its traceback.
    """


class MissingFileError(InputError, FileNotFoundError):
    """A file that the user names, or that a command should have written before, is not there."""
