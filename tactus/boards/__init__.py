"""The boards for which a scene can be built, each in its own file, and the bitstreams for them."""

from tactus.boards.board import Board, Pin, board_names, load_board

__all__ = ["Board", "Pin", "board_names", "load_board"]
