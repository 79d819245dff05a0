"""``make load``: send a scene's image over the serial line, and wait until the board runs it."""

import time

from golden.input_error import InputError
from golden.link.packets import image_packet
from tactus.core.cli import stop_if_dry_run
from tactus.core.commands import arguments_of
from tactus.monitor.board import Board, board_of
from tactus.monitor.line import Line, frames_from, open_line
from tactus.scene.image import hardware_of, scene_image

# A report counts after so many packets in a row have repeated it, because the first packets may
# still report the state before the image.
SURE = 3


def check_readings(board: Board) -> None:
    """Refuse a scene whose sensors are not those that the board reads.

    Otherwise its networks would get other sensors, or codes that stand for other readings.
    """
    scene, hardware = board.scene, board.hardware
    if scene.sensors != hardware.sensors:
        raise InputError(
            f"{scene.path}: data.sensors: got {', '.join(scene.sensors)}, expected "
            f"{', '.join(hardware.sensors)}, as {hardware.path} reads them"
        )
    if not (scene.window.plain and hardware.window.plain):
        raise InputError(f"{scene.path}: data.window: got past samples, expected none for an image")
    names = scene.sensors
    for name, got, expected in zip(names, scene.scales(names), hardware.scales(names), strict=True):
        if got != expected:
            raise InputError(
                f"{scene.path}: data.scale.{name}: got offset {got.offset:g}, factor "
                f"{got.factor:g}, expected offset {expected.offset:g}, factor "
                f"{expected.factor:g}, as {hardware.path} reads it"
            )


def load(line: Line, board: Board) -> int:
    """Send the image of a scene, wait until it runs, and return the number of its bytes."""
    check_readings(board)
    data = scene_image(board.scene, hardware_of(board.hardware)).to_bytes()
    line.write(image_packet(data))
    good = refused = 0
    count, last = -1, time.monotonic()
    for frame in frames_from(line, board):
        refused = refused + 1 if "image_error" in frame.flags else 0
        bad = {"image_error", "frame_error"} & set(frame.flags)
        # Packets also come when no new frame was computed.
        good = 0 if bad or frame.count == count else good + 1
        count = frame.count
        last = time.monotonic() if good else last
        if good == SURE:
            break
        if refused == SURE:
            raise InputError(
                f"PORT={line.label}: image_error: the board refused the image: it was cut or "
                f"changed on its way, or the board is not the hardware of {board.hardware.path}"
            )
        if time.monotonic() - last > line.patience:
            raise InputError(
                f"PORT={line.label}: the image was sent, but no new frame came for "
                f"{line.patience:g} s, and packets carry {', '.join(frame.flags) or 'no flag'}: is "
                "RX connected, and does the board read its converter?"
            )
    return len(data)


def main() -> None:
    arguments = arguments_of("load", __doc__)
    board = board_of(arguments.scene, arguments.hardware)
    check_readings(board)
    hardware_of(board.hardware)
    stop_if_dry_run(f"send the image of scene {board.scene.name} to {arguments.port}")
    with open_line(arguments.port, arguments.baud, board) as line:
        count = load(line, board)
        print(f"{line.label}: {board.scene.name} runs, {count} bytes")
