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
RIGHT, UP, SHIFT = "\ue014", "\ue013", "\ue008"  # keys of WebDriver
SLOWEST = 350  # ms from slider to picture, median

# Inputs at the edge: what the link says, and a word of the sentence that must come.
EDGES = {
    "goal=-0.5": "inside `wall`",
    "start=-1": "inside `wall`",
    "restitution=1": "wall",
    "timeStep=0.5": "wall",
    "impactLimit=0": "does not pay",
    "maxAcceleration=0": "no plan",
    "maxAcceleration=0&velocity=-5": "no plan",
    "velocity=-16": "outside its largest speed",
    "maxSpeed=0.5&timeStep=0.02": "wall",
    "start=0.3": "wall",
    "start=4&velocity=-10&impactLimit=4": "no plan",
    "start=4&velocity=-10&restitution=0.3": "Only a plan that hits",
    "goal=0&start=0&restitution=0.5": "wall",
    "restitution=abc&nonsense=1": "Hitting the wall saves",
    "task=nonsense": "Hitting the wall saves",
    "task=bank&blockX=1.2&blockY=0.2": "`puck` starts inside `block`; move one of them.",
    "task=bank&goalX=0.5&goalY=0.7": "`puck` ends inside `block`; move one of them.",
    "task=bank&restitution=0": "Bouncing saves",
    "task=bank&restitution=1": "Bouncing saves",
    "task=bank&timeStep=0.5": "Bouncing saves",
    "task=bank&maxAcceleration=0": "no plan",
    "task=bank&velocityX=3&maxSpeed=1": "outside its largest speed",
    "task=bank&velocityX=0&velocityY=0&goalX=1.2&goalY=0.2": "does not pay",
    "task=pillar&startX=0": "`robot` starts inside `left wall`; move one of them.",
    "task=pillar&impulseLimit=0": "does not pay",
    "task=pillar&velocityX=-0.5&velocityY=0&startX=0.6&restitution=0.3": "Only a plan that bounces",
    "task=exchange&cartX=0.5": "`carrier` starts inside `cart`; move one of them.",
    "task=exchange&velocityX=-3": "no plan",
}

# The shortest plans of the scenes, as the examples `bank_shot`, `free_flyer` and `momentum` find them,
# and the number of hits.
SCENES = {
    "bank": ("42 steps", "28 steps", 2),
    "pillar": ("25 steps", "21 steps", 2),
    "exchange": ("14 steps", "6 steps", 1),
}

# Every text whose contrast is below 4.5, and every line and area of the charts below 3: WCAG 2, AA.
# Colours are blended with what is behind them, with the opacity of all that they are part of.
CONTRAST = """
const rgb = text => { const c = text.match(/[\\d.]+/g).map(Number); return c.length < 4 ? [...c, 1] : c; };
const light = ([r, g, b]) => { const f = c => (c /= 255) <= .03928 ? c / 12.92 : ((c + .055) / 1.055) ** 2.4;
  return .2126 * f(r) + .7152 * f(g) + .0722 * f(b); };
const over = (c, back) => [0, 1, 2].map(k => c[3] * c[k] + (1 - c[3]) * back[k]);
const behind = node => {
  if (!node) return [255, 255, 255];
  return over(rgb(getComputedStyle(node).backgroundColor), behind(node.parentElement));
};
const opacity = node => node ? Number(getComputedStyle(node).opacity) * opacity(node.parentElement) : 1;
const seen = node => node.getClientRects().length && getComputedStyle(node).visibility === "visible";
const bad = [], check = (node, colour, back, least, what) => {
  const c = rgb(colour);
  if (!c[3]) return;
  c[3] *= opacity(node);
  const [a, b] = [light(over(c, back)), light(back)];
  const ratio = (Math.max(a, b) + .05) / (Math.min(a, b) + .05);
  if (ratio < least) bad.push(`${node.tagName} ${node.className.baseVal ?? node.className} ${ratio.toFixed(2)}: ${what}`);
};
for (const node of document.querySelectorAll("body *")) {
  const own = [...node.childNodes].some(c => c.nodeType === 3 && c.textContent.trim());
  if (!own || !seen(node) || ["SCRIPT", "STYLE"].includes(node.tagName)) continue;
  const style = getComputedStyle(node), drawn = node.closest("svg");
  const room = drawn?.querySelector(".room"), back = room ? rgb(getComputedStyle(room).fill) : behind(node);
  check(node, drawn ? style.fill : style.color, back, 4.5, node.textContent.trim().slice(0, 40));
}
for (const node of document.querySelectorAll("svg .curve, svg .goal:not(text), svg .impulse, svg .hit, svg .start"))
  if (seen(node)) check(node, getComputedStyle(node).stroke, behind(node), 3, "line");
for (const node of document.querySelectorAll("svg .wall, svg .obstacle, svg .body:not(.body-1), svg .dot"))
  if (seen(node) && node.getAttribute("opacity") === null) check(node, getComputedStyle(node).fill, behind(node), 3, "area");
return bad;
"""

# Texts on top of each other, and controls that are less than 24 pixels high: WCAG 2.2, AA.
OVERLAPS = """
const boxes = [...document.querySelectorAll("main *, header *, nav *")]
  .filter(node => !node.closest("svg") && node.getClientRects().length && getComputedStyle(node).visibility === "visible"
    && [...node.childNodes].some(c => c.nodeType === 3 && c.textContent.trim()))
  .map(node => [node, node.getBoundingClientRect()]);
const bad = [];
for (const [k, [a, r]] of boxes.entries()) for (const [b, q] of boxes.slice(k + 1)) {
  if (a.contains(b) || b.contains(a)) continue;
  if (Math.min(r.right, q.right) - Math.max(r.left, q.left) > 1 && Math.min(r.bottom, q.bottom) - Math.max(r.top, q.top) > 1)
    bad.push(`${a.textContent.trim().slice(0, 30)} and ${b.textContent.trim().slice(0, 30)}`);
}
for (const node of document.querySelectorAll("button, input, nav a"))
  if (node.getClientRects().length && node.getBoundingClientRect().height < 24) bad.push(`${node.id || node.textContent} is too low`);
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

    def explained(self):
        self.browser.wait("document.documentElement.dataset.explained === document.documentElement.dataset.drawn", "the reason")

    def steps(self, side):
        return self.browser.text(f"[data-side={side}] .steps")

    def numbers_are_those_of_the_paper(self):
        self.open()
        assert (self.steps("free"), self.steps("tolerant")) == ("510 steps", "457 steps"), self.steps("tolerant")
        assert self.browser.text("[data-side=tolerant] .seconds") == "2.285 s"
        proof = self.browser.text("[data-side=tolerant] .proof")
        assert proof.startswith("456 steps are impossible"), proof
        # The slider, by keyboard: e = 0.025.
        self.browser.type("#restitution", RIGHT * 5)
        self.settled()
        assert self.steps("tolerant") == "449 steps", self.steps("tolerant")
        assert "13.59 %" in self.browser.text("#verdict"), self.browser.text("#verdict")
        self.browser.wait("document.querySelector('[data-side=tolerant] .why').textContent", "the reason")
        print(self.browser.text("[data-side=tolerant] .why"))
        # The link holds the state.
        assert self.browser.run("return location.hash") == "#restitution=0.025"
        self.open("restitution=0.025")
        assert self.steps("tolerant") == "449 steps"

    def scenes_are_those_of_the_examples(self):
        for name, (free, tolerant, hits) in SCENES.items():
            self.open(f"task={name}")
            assert (self.steps("free"), self.steps("tolerant")) == (free, tolerant), (name, self.steps("tolerant"))
            found = self.browser.text("[data-side=tolerant] .hits")
            print(f"{name}: {free}, {tolerant}. {found}")
            assert found.count("Hit:") == hits, found
            assert self.browser.run("return document.querySelectorAll('#scene-tolerant circle.hit').length") == hits

    def scenes_can_be_changed(self):
        self.open("task=bank")
        # By keyboard: the goal a step to the right, and the block five up.
        self.browser.type("#scene-free [data-handle=goal]", RIGHT)
        self.browser.type("#scene-free [data-handle=block]", UP, held=SHIFT)
        self.settled()
        assert self.browser.run("return location.hash") == "#task=bank&goalX=0.45&blockY=0.95"
        assert self.browser.run("return document.activeElement.dataset.handle") == "block"
        # By pointer: the block onto the puck, in the second picture.
        places = self.browser.run("""
            return ["block", "start"].map(name => {
              const frame = document.querySelector(`#scene-tolerant [data-handle=${name}] .grip`).getBoundingClientRect();
              return [frame.x + frame.width / 2, frame.y + frame.height / 2].map(Math.round);
            });
        """)
        self.browser.drag(*places)
        self.settled()
        assert "`puck` starts inside `block`" in self.browser.text("#verdict"), self.browser.text("#verdict")
        # The link holds all of it, and another kind is one click away.
        link = self.browser.run("return location.hash.slice(1)")
        assert "blockX=1.2" in link and "blockY=0.2" in link, link
        self.browser.run("document.querySelector('#kinds a').click()")
        self.browser.wait("document.documentElement.dataset.kind === 'wall'", "the wall")
        self.settled()
        assert self.steps("free") == "510 steps"

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
            assert verdict.endswith(".") and self.browser.run("return document.querySelector('.stage svg').clientHeight") > 50
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
            self.explained()
        median = statistics.median(times)
        print(f"slider to picture: median {median:.0f} ms, from {min(times):.0f} to {max(times):.0f} ms")
        return median

    def is_quiet(self):
        errors = [line for line in self.browser.call("POST", "se/log", {"type": "browser"}) if line["level"] == "SEVERE"]
        assert not errors, errors
        asked = self.browser.run("return performance.getEntriesByType('resource').map(entry => entry.name)")
        assert all(name.startswith(self.address) for name in asked), asked

    def is_readable(self, pictures):
        links = ["restitution=0.5", "start=4&velocity=-10&impactLimit=4", *(f"task={name}" for name in SCENES)]
        checked = 0
        for name, width, height, mobile in [("desktop", 1280, 1000, False), ("phone", 390, 844, True)]:
            self.browser.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)
            for theme in ["light", "dark"]:
                self.browser.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
                for link in links:
                    self.open(link)
                    self.explained()
                    self.browser.run("""
                        const slider = document.querySelector("#time");
                        slider.value = 0.65 * slider.max;
                        slider.dispatchEvent(new Event("input"));
                    """)
                    time.sleep(0.4)  # until plans have faded in
                    what = f"{name}, {theme}, {link}"
                    wide = self.browser.run("return [document.documentElement.scrollWidth, innerWidth]")
                    assert wide[0] <= wide[1], f"{what}: {wide[0]} pixels in {wide[1]}"
                    for question in [CONTRAST, OVERLAPS]:
                        found = self.browser.run(question)
                        assert not found, f"{what}: {found}"
                    checked += 1
                    if pictures:
                        whole = self.browser.devtools("Page.captureScreenshot", captureBeyondViewport=True)
                        kind = link.split("=")[1].split("&")[0] if link.startswith("task=") else ["wall", "none"][links.index(link)]
                        (pictures / f"{kind}_{name}_{theme}.png").write_bytes(base64.b64decode(whole["data"]))
        self.browser.devtools("Emulation.clearDeviceMetricsOverride")
        print(f"{checked} pages: contrast of texts at least 4.5 and of lines and areas at least 3, nothing overlaps")


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
        test.scenes_are_those_of_the_examples()
        test.scenes_can_be_changed()
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
