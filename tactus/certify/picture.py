"""Draws the top of a certificate's page as a picture, with a browser."""

import shutil
import subprocess
import tempfile
from pathlib import Path

from golden.input_error import InputError
from tactus.core.files import replace_file

BROWSER = "chromium"
# The window in CSS pixels.
WIDTH, HEIGHT = 1000, 624


def picture_file(name: str) -> Path:
    """The file in which the picture will be."""
    path = Path(name)
    if path.suffix != ".png" or not path.parent.is_dir():
        raise InputError(f"PICTURE={name}: expected a file that ends in .png, in a folder")
    if not shutil.which(BROWSER):
        raise InputError(f"PICTURE={name}: Debian's package {BROWSER} is not installed")
    return path


def draw_page(page: Path, picture: Path) -> None:
    """Write the top of an HTML page as PNG."""
    with tempfile.TemporaryDirectory() as name:
        drawn = Path(name) / "page.png"
        command = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
        # No host name resolves, so that nothing can be loaded from a network.
        command += ["--host-resolver-rules=MAP * ~NOTFOUND", f"--window-size={WIDTH},{HEIGHT}"]
        command += [f"--screenshot={drawn}", page.resolve().as_uri()]
        subprocess.run(command, capture_output=True, check=True)
        with replace_file(picture) as temporary:
            shutil.copy(drawn, temporary)
