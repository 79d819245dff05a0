"""Serves the page of a monitor to this machine alone."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from tb.report.page.page import environment

HOST = "127.0.0.1"
NAMES = (HOST, "localhost")
# Only what the page itself contains may run in it.
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "connect-src 'self'; img-src data:"
)


class Server:
    """Serves a page and the state that it shows, from a thread of its own, at a free port.

    Only this machine gets an answer, and only by its own names. A page from elsewhere that is open
    in a browser here gets none, whatever address its name resolves to.

    Parameters
    ----------
    title : str
    state : callable
        Gives what the page shows.

    Attributes
    ----------
    address : str
        The address of the page.
    """

    def __init__(self, title: str, state: Callable[[], dict[str, Any]]) -> None:
        page = environment("tb.monitor").get_template("page.html.jinja").render(title=title)

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                # Any port is accepted, because a forwarded port may be another one.
                if self.headers.get("Host", "").rpartition(":")[0] not in NAMES:
                    self.send_error(HTTPStatus.FORBIDDEN)
                elif self.path == "/":
                    self._answer("text/html", page)
                elif self.path == "/state":
                    self._answer("application/json", json.dumps(state()))
                else:
                    self.send_error(HTTPStatus.NOT_FOUND)

            def _answer(self, kind: str, text: str) -> None:
                data = text.encode()
                self.send_response(HTTPStatus.OK)
                self.send_header("Content-Type", f"{kind}; charset=utf-8")
                self.send_header("Content-Length", str(len(data)))
                self.send_header("Content-Security-Policy", POLICY)
                self.send_header("Cache-Control", "no-store")
                self.end_headers()
                self.wfile.write(data)

            def log_message(self, *_: object) -> None:
                """Print nothing: the terminal is for what the board sends."""

        self._server = ThreadingHTTPServer((HOST, 0), Handler)
        self._server.daemon_threads = True
        self.address = f"http://{HOST}:{self._server.server_port}/"
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)

    def __enter__(self) -> Server:
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._server.shutdown()
        self._server.server_close()
