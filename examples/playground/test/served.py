"""Serves the page, also as servers do that are set up badly."""

import functools
import gzip
import http.server
import pathlib
import threading

PAGE = pathlib.Path(__file__).resolve().parent.parent / "www"


class Quiet(http.server.SimpleHTTPRequestHandler):
    """`fault` is what is wrong with the compiled planner: missing, gzip, html, cut, or None."""

    fault = None

    def log_message(self, *_):
        pass

    def do_GET(self):
        if not self.fault or not self.path.endswith(".wasm"):
            return super().do_GET()
        whole = (PAGE / self.path.split("?")[0].lstrip("/")).read_bytes()
        if self.fault == "missing":
            return self.send_error(404)
        body = {"gzip": lambda: gzip.compress(whole, 1), "html": lambda: b"<!doctype html>", "cut": lambda: whole[:5000]}[self.fault]()
        self.send_response(200)
        self.send_header("Content-Type", "application/wasm")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)
        return None


class Served:
    """A server on a free port, from `with`."""

    def __init__(self, fault=None):
        handler = functools.partial(type("Handler", (Quiet,), {"fault": fault}), directory=str(PAGE))
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)

    def __enter__(self):
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        return f"http://127.0.0.1:{self.server.server_port}"

    def __exit__(self, *_):
        self.server.shutdown()
