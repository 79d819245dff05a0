"""Boards that a scene can be built for: a file each."""

from golden.boards.board import Board, Pin, board_names, load_board

__all__ = ["Board", "Pin", "board_names", "load_board"]
