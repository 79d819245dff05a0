"""The boards for which a scene can be built. Each has its own file."""

from golden.boards.board import Board, Pin, board_names, load_board

__all__ = ["Board", "Pin", "board_names", "load_board"]
