"""Speaks WebDriver to headless Chromium, so that no package is needed."""

import json
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request


def free_port():
    with socket.socket() as place:
        place.bind(("127.0.0.1", 0))
        return place.getsockname()[1]


class Browser:
    """A session of chromedriver."""

    def __init__(self):
        self.port, self.profile = free_port(), tempfile.mkdtemp()
        self.driver = subprocess.Popen(["chromedriver", f"--port={self.port}"], stdout=subprocess.DEVNULL)
        for _ in range(100):
            try:
                if self.call("GET", "status", session=False)["ready"]:
                    break
            except (urllib.error.URLError, ConnectionError):
                time.sleep(0.1)
        flags = [
            "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
            "--disable-background-networking", "--disable-component-update", "--disable-sync",
            "--hide-scrollbars", "--window-size=1280,1000", f"--user-data-dir={self.profile}",
        ]
        wishes = {"goog:chromeOptions": {"args": flags}, "goog:loggingPrefs": {"browser": "ALL"}}
        body = {"capabilities": {"alwaysMatch": wishes}}
        self.id = self.call("POST", "session", body, session=False)["sessionId"]
        self.call("POST", "timeouts", {"script": 60_000})

    def call(self, method, path, body=None, session=True):
        path = f"session/{self.id}/{path}".rstrip("/") if session else path
        request = urllib.request.Request(
            f"http://127.0.0.1:{self.port}/{path}",
            method=method,
            data=None if method == "GET" else json.dumps(body or {}).encode(),
            headers={"Content-Type": "application/json"},
        )
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(error.read().decode()[:400]) from None

    def run(self, script, *arguments):
        return self.call("POST", "execute/sync", {"script": script, "args": list(arguments)})

    def run_async(self, script, *arguments):
        return self.call("POST", "execute/async", {"script": script, "args": list(arguments)})

    def devtools(self, command, **parameters):
        return self.call("POST", "goog/cdp/execute", {"cmd": command, "params": parameters})

    def type(self, selector, keys, held=""):
        """Presses keys at what has the focus, which a new picture keeps."""
        self.run("document.querySelector(arguments[0]).focus()", selector)
        key = lambda kind, value: {"type": kind, "value": value}
        strokes = [key(kind, value) for value in keys for kind in ("keyDown", "keyUp")]
        actions = [key("keyDown", k) for k in held] + strokes + [key("keyUp", k) for k in held]
        self.call("POST", "actions", {"actions": [{"type": "key", "id": "keys", "actions": actions}]})

    def drag(self, start, end):
        move = lambda place: {"type": "pointerMove", "duration": 50, "x": place[0], "y": place[1]}
        middle = [round((a + b) / 2) for a, b in zip(start, end)]
        actions = [move(start), {"type": "pointerDown", "button": 0}, move(middle), move(end), {"type": "pointerUp", "button": 0}]
        self.call("POST", "actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": actions}]})

    def wait(self, condition, what, seconds=60):
        end = time.monotonic() + seconds
        while not self.run(f"return Boolean({condition})"):
            assert time.monotonic() < end, f"{what} did not come: {self.text('#verdict')}"
            time.sleep(0.02)

    def text(self, selector):
        return self.run("return document.querySelector(arguments[0]).textContent.trim()", selector)

    def close(self):
        try:
            self.call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()
            shutil.rmtree(self.profile, ignore_errors=True)
