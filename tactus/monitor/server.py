"""Serves the page of a monitor to this machine alone."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from golden.input_error import InputError
from tactus.core.templates import environment

HOST = "127.0.0.1"
NAMES = (HOST, "localhost")
JSON = "application/json"
# Only what the page itself contains may run in it.
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "connect-src 'self'; img-src data:"
)
# A request has a few numbers; what is longer is none.
MOST_BYTES = 10_000


def page_of(title: str) -> str:
    templates = environment("tactus.monitor", "tactus.report.page", escapes=True)
    return templates.get_template("page.html.jinja").render(title=title)


class Server:
    """Serves a page and the state that it shows, from a thread of its own, at a free port.

    Only this machine gets an answer, and only by its own names. A page from elsewhere that is open
    in a browser here gets none, whatever address its name resolves to, and can ask for nothing: a
    request must be JSON, which a browser sends to another host only if that one agrees, and must
    not name another origin.

    state: Gives what the page shows.
    actions: What the page may ask for, by path. Each takes what was sent, and its result is the
        answer. For an InputError the answer has its text as ``error``.

    address: The address of the page.
    """

    def __init__(
        self,
        title: str,
        state: Callable[[], dict[str, Any]],
        actions: Mapping[str, Callable[[Any], object]] | None = None,
    ) -> None:
        page = page_of(title)
        known = actions or {}

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                if not self._own():
                    self.send_error(HTTPStatus.FORBIDDEN)
                elif self.path == "/":
                    self._answer("text/html", page)
                elif self.path == "/state":
                    self._answer(JSON, json.dumps(state()))
                else:
                    self.send_error(HTTPStatus.NOT_FOUND)

            def do_POST(self) -> None:
                origin = self.headers.get("Origin")
                if not self._own() or origin not in (None, f"http://{self.headers['Host']}"):
                    self.send_error(HTTPStatus.FORBIDDEN)
                elif self.path not in known:
                    self.send_error(HTTPStatus.NOT_FOUND)
                elif self.headers.get_content_type() != JSON:
                    self.send_error(HTTPStatus.UNSUPPORTED_MEDIA_TYPE)
                else:
                    try:
                        answer, status = known[self.path](self._sent()), HTTPStatus.OK
                    except InputError as error:
                        answer, status = {"error": str(error)}, HTTPStatus.BAD_REQUEST
                    self._answer(JSON, json.dumps(answer), status)

            def _own(self) -> bool:
                """Whether this machine is asked by its own name."""
                # Any port is accepted, because a forwarded port may be another one.
                return self.headers.get("Host", "").rpartition(":")[0] in NAMES

            def _sent(self) -> Any:
                length = self.headers.get("Content-Length", "")
                if not (length.isdecimal() and int(length) <= MOST_BYTES):
                    raise InputError(
                        f"Content-Length: got {length or 'nothing'}, expected {MOST_BYTES} at most"
                    )
                data, found = self.rfile.read(int(length)), None
                with suppress(ValueError):
                    found = json.loads(data)
                if not isinstance(found, dict):
                    raise InputError(f"got {data[:40]!r}, expected a JSON object")
                return found

            def _answer(self, kind: str, text: str, status: HTTPStatus = HTTPStatus.OK) -> None:
                data = text.encode()
                self.send_response(status)
                self.send_header("Content-Type", f"{kind}; charset=utf-8")
                self.send_header("Content-Length", str(len(data)))
                self.send_header("Content-Security-Policy", POLICY)
                self.send_header("Cache-Control", "no-store")
                # A browser may be gone before its answer comes.
                with suppress(ConnectionError):
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
