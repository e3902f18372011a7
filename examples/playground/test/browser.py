#!/usr/bin/env python3
"""Opens the built page in headless Chromium and uses it as a visitor does.

    examples/playground/build && examples/playground/test/browser.py [--pictures FOLDER]

Needs chromium and chromedriver; speaks WebDriver itself, so it needs no package.
"""

import argparse
import base64
import functools
import gzip
import http.server
import json
import pathlib
import shutil
import socket
import statistics
import subprocess
import tempfile
import threading
import time
import urllib.error
import urllib.request

PAGE = pathlib.Path(__file__).resolve().parent.parent / "www"
LARGEST = 1_500_000  # bytes of the compressed wasm file
SLOWEST = 350  # ms from slider to picture, median

# Inputs at the edge: what the link says, and a word of the sentence that must come.
EDGES = {
    "goal=-0.5": "inside the wall",
    "start=-1": "inside the wall",
    "restitution=1": "wall",
    "timeStep=0.5": "wall",
    "impactLimit=0": "does not pay",
    "maxAcceleration=0": "no plan",
    "maxAcceleration=0&velocity=-5": "no plan",
    "velocity=-16": "above the largest speed",
    "maxSpeed=0.5&timeStep=0.02": "wall",
    "start=0.3": "wall",
    "start=4&velocity=-10&impactLimit=4": "no plan",
    "start=4&velocity=-10&restitution=0.3": "Only a plan that hits",
    "goal=0&start=0&restitution=0.5": "wall",
    "restitution=abc&nonsense=1": "Hitting the wall saves",
}

CONTRAST = """
const rgb = text => text.match(/[\\d.]+/g).map(Number);
const light = ([r, g, b]) => { const f = c => (c /= 255) <= .03928 ? c / 12.92 : ((c + .055) / 1.055) ** 2.4;
  return .2126 * f(r) + .7152 * f(g) + .0722 * f(b); };
const behind = node => { for (; node; node = node.parentElement) {
  const c = rgb(getComputedStyle(node).backgroundColor); if (c.length < 4 || c[3] > 0) return c; } return [255, 255, 255]; };
const bad = [];
for (const node of document.querySelectorAll("body *")) {
  const own = [...node.childNodes].some(c => c.nodeType === 3 && c.textContent.trim());
  if (!own || !node.getClientRects().length || ["SCRIPT", "STYLE"].includes(node.tagName)) continue;
  const style = getComputedStyle(node);
  const [a, b] = [light(rgb(node.closest("svg") ? style.fill : style.color)), light(behind(node))];
  const ratio = (Math.max(a, b) + .05) / (Math.min(a, b) + .05);
  if (ratio < 4.5) bad.push(`${node.tagName} ${node.className.baseVal ?? node.className} ${ratio.toFixed(2)}: ${node.textContent.slice(0, 40)}`);
}
return bad;
"""


def free_port():
    with socket.socket() as place:
        place.bind(("127.0.0.1", 0))
        return place.getsockname()[1]


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


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

    def devtools(self, command, **parameters):
        return self.call("POST", "goog/cdp/execute", {"cmd": command, "params": parameters})

    def press(self, selector, keys):
        found = self.call("POST", "element", {"using": "css selector", "value": selector})
        element = next(iter(found.values()))
        self.call("POST", f"element/{element}/value", {"text": keys})

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


class Test:
    def __init__(self, browser, address):
        self.browser, self.address = browser, address

    def open(self, link=""):
        self.browser.call("POST", "url", {"url": "about:blank"})
        self.browser.call("POST", "url", {"url": f"{self.address}/#{link}"})
        self.settled()

    def settled(self):
        self.browser.wait("document.documentElement.dataset.drawn === "
                          "(document.documentElement.dataset.asked ?? '0')", "an answer")

    def steps(self, side):
        return self.browser.text(f"[data-side={side}] .steps")

    def numbers_are_those_of_the_paper(self):
        self.open()
        assert (self.steps("free"), self.steps("tolerant")) == ("510 steps", "457 steps"), self.steps("tolerant")
        assert self.browser.text("[data-side=tolerant] .seconds") == "2.285 s"
        proof = self.browser.text("[data-side=tolerant] .proof")
        assert proof.startswith("456 steps are impossible"), proof
        # The slider, by keyboard: e = 0.025.
        self.browser.press("#restitution", "\ue014" * 5)
        self.settled()
        assert self.steps("tolerant") == "449 steps", self.steps("tolerant")
        assert "13.59 %" in self.browser.text("#verdict"), self.browser.text("#verdict")
        self.browser.wait("document.querySelector('[data-side=tolerant] .why').textContent", "the reason")
        print(self.browser.text("[data-side=tolerant] .why"))
        # The link holds the state.
        assert self.browser.run("return location.hash") == "#restitution=0.025"
        self.open("restitution=0.025")
        assert self.steps("tolerant") == "449 steps"

    def only_the_last_task_counts(self):
        self.open()
        self.browser.run("""
            const slider = document.querySelector("#goal");
            for (let k = 0; k <= 20; k++) { slider.value = 0.5 + 0.1 * k; slider.dispatchEvent(new Event("input")); }
        """)
        self.settled()
        last = self.browser.text("[data-side=free] .seconds")
        self.open(self.browser.run("return location.hash.slice(1)"))
        assert self.browser.text("[data-side=free] .seconds") == last != "2.550 s"

    def every_edge_has_its_sentence(self):
        for link, word in EDGES.items():
            self.open(link)
            verdict = self.browser.text("#verdict")
            print(f"{link}: {verdict}")
            assert word in verdict, f"no {word!r}"
        self.open("start=4&velocity=-10&impactLimit=4")
        self.browser.wait("document.querySelector('[data-side=tolerant] .why').textContent", "the explanation")
        why = self.browser.text("[data-side=tolerant] .why")
        print(why)
        assert "the limit on the impact speed (4)" in why

    def is_fast(self):
        self.open("timeStep=0.005")
        times = []
        for k in range(20):
            self.browser.run("""
                const slider = document.querySelector("#goal");
                slider.value = 0.2 + 0.05 * arguments[0];
                slider.dispatchEvent(new Event("input"));
            """, k)
            self.settled()
            times.append(float(self.browser.run("return document.documentElement.dataset.latency")))
            self.browser.wait("document.documentElement.dataset.explained === document.documentElement.dataset.drawn", "the reason")
        median = statistics.median(times)
        print(f"slider to picture: median {median:.0f} ms, from {min(times):.0f} to {max(times):.0f} ms")
        return median

    def is_quiet(self):
        errors = [line for line in self.browser.call("POST", "se/log", {"type": "browser"}) if line["level"] == "SEVERE"]
        assert not errors, errors
        asked = self.browser.run("return performance.getEntriesByType('resource').map(entry => entry.name)")
        assert all(name.startswith(self.address) for name in asked), asked

    def is_readable(self, pictures):
        for name, width, height, mobile in [("desktop", 1280, 1000, False), ("phone", 390, 844, True)]:
            self.browser.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)
            for theme in ["light", "dark"]:
                self.browser.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
                self.open("restitution=0.5")
                self.browser.wait("document.querySelector('[data-side=tolerant] .why').textContent", "the reason")
                self.browser.run("""
                    const slider = document.querySelector("#time");
                    slider.value = 1.7;
                    slider.dispatchEvent(new Event("input"));
                """)
                wide = self.browser.run("return [document.documentElement.scrollWidth, innerWidth]")
                assert wide[0] <= wide[1], f"{name}: {wide[0]} pixels in {wide[1]}"
                faint = self.browser.run(CONTRAST)
                assert not faint, f"{name}, {theme}: {faint}"
                if pictures:
                    whole = self.browser.devtools("Page.captureScreenshot", captureBeyondViewport=True)
                    (pictures / f"{name}_{theme}.png").write_bytes(base64.b64decode(whole["data"]))
        self.browser.devtools("Emulation.clearDeviceMetricsOverride")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--pictures", type=pathlib.Path, help="a folder for screenshots")
    parser.add_argument("--slowest", type=float, default=SLOWEST, help="ms from slider to picture, median")
    arguments = parser.parse_args()
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)

    size = len(gzip.compress((PAGE / "pkg/carom_playground_bg.wasm").read_bytes(), 9))
    print(f"wasm: {size} bytes compressed")
    assert size < LARGEST

    handler = functools.partial(Quiet, directory=str(PAGE))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    browser = Browser()
    try:
        test = Test(browser, f"http://127.0.0.1:{server.server_port}")
        test.numbers_are_those_of_the_paper()
        test.only_the_last_task_counts()
        test.every_edge_has_its_sentence()
        test.is_readable(arguments.pictures)
        median = test.is_fast()
        test.is_quiet()
        assert median < arguments.slowest, f"a median of {median} ms"
    finally:
        browser.close()
        server.shutdown()
    print("the page works")


if __name__ == "__main__":
    main()
