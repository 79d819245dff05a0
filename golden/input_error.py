"""The error for faults of the input or the machine, as opposed to faults of this project."""


class InputError(Exception):
    """A fault of the user's input or machine; the message says what to do.

    It names the file and the key, or the variable of the command, and says what came and what was
    expected. A command prints it as one line and exits with 2. Every other exception is a fault of
    this project, and keeps its traceback.
    """


class MissingFileError(InputError, FileNotFoundError):
    """A file is missing that the user names, or that a command should have written before."""
