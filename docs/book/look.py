#!/usr/bin/env python3
"""Opens the built site in headless Chromium and looks at it as visitors do.

    docs/site && docs/book/look.py [--all] [--pictures FOLDER] [PAGE ...]

On every page of the book, narrow and dark, and on some of them or those that are named also wide and light (with --all,
all of them in all ways): nothing is wider than the window at 320 pixels, axe finds nothing to complain of, all files come from the
site, formulas are typeset, code is not cut without a sign of it, and a search finds what is there. Needs chromium and chromedriver; installs Selenium into the target folder.
"""

import argparse
import base64
import functools
import http.server
import os
import pathlib
import shutil
import subprocess
import sys
import threading
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target").absolute()
SITE, TOOLS = TARGET / "site", TARGET / "tools/site"
SELENIUM = "4.51.0"

# Wide and narrow, and what a visitor prefers.
VIEWS = [(320, "dark"), (1280, "light")]
OTHERS = [(1280, "dark"), (320, "light")]
# What is looked at in all views; other pages only in the first, where most can go wrong.
SAMPLE = {"index.html", "tutorial.html", "hybrid_system.html", "formulation.html", "gallery.html", "examples/paper.html"}
WORDS = {"hysteresis": "hybrid_system.html", "big-M": "modelling.html", "quadrotor": "gallery.html"}


def selenium():
    """The driver's library, installed where it is not."""
    python = TOOLS / "python/bin/python"
    if pathlib.Path(sys.executable) == python:
        return
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", TOOLS / "python"], check=True)
    subprocess.run([python, "-m", "pip", "install", "--quiet", f"selenium=={SELENIUM}"], check=True)
    os.execv(python, [python, __file__, *sys.argv[1:]])

# Words that lead to items of the reference.
ALIASES = {"MPC": "RecedingHorizon", "IIS": "infeasibility", "big-M": "BigM", "warm start": "MipStart",
           "piecewise linear": "PiecewiseAffine", "callback": "with_progress", "time limit": "with_time_limit",
           "complementarity": "LinearComplementarity", "receding horizon": "RecedingHorizon"}


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def serve():
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=SITE))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}"


def browser():
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu"):
        options.add_argument(argument)
    return webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))


def view(driver, width, scheme):
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    prefers = [{"name": "prefers-color-scheme", "value": scheme}]
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": prefers})


def faults(driver, address, page, width):
    """What is wrong with a page as it is shown."""
    found = []
    wide = driver.execute_script(
        "const wide = Math.max(document.documentElement.scrollWidth, document.querySelector('main').scrollWidth);"
        "return wide > innerWidth ? wide : 0")
    if wide:
        found.append(f"{wide} pixels wide")
    cut = driver.execute_script(
        "return [...document.querySelectorAll('pre > code')].filter(code => code.scrollWidth > code.clientWidth + 2"
        " && !code.parentElement.classList.contains('cut')).map(code => code.textContent.trim().slice(0, 40))")
    found += [f"cuts the code {code!r}" for code in cut]
    elsewhere = driver.execute_script(
        "return performance.getEntriesByType('resource').map(r => r.name).filter(name => !/^(data|blob):/.test(name)"
        " && !name.startsWith(arguments[0]))", address)
    found += [f"loads {name}" for name in elsewhere]
    if driver.execute_script("return document.querySelector('code.language-math, .katex-error') !== null"):
        found.append("has a formula that is not typeset")
    broken = driver.execute_script(
        "return [...document.images].filter(i => i.complete && !i.naturalWidth).map(i => i.src)")
    found += [f"does not show {name}" for name in broken]
    # What is in the frame is looked at by the test of the playground.
    violations = driver.execute_async_script(
        "const done = arguments[0]; axe.run({exclude: [['iframe']]}).then(r => done(r.violations.map(v =>"
        " v.id + ': ' + v.help + ' at ' + v.nodes.slice(0, 3).map(n => n.target + ' ' + (n.any[0] || {message: ''}).message).join('; '))))")
    return found + violations


def search(driver, address):
    """Words of the text, typed in, lead to the pages that have them."""
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import WebDriverWait

    found = []
    for word, page in WORDS.items():
        driver.get(f"{address}/index.html")
        driver.find_element(By.TAG_NAME, "body").send_keys("/")
        driver.find_element(By.ID, "mdbook-searchbar").send_keys(word)
        results = lambda d: [a.get_attribute("href") for a in d.find_elements(By.CSS_SELECTOR, "#mdbook-searchresults a")]
        try:
            WebDriverWait(driver, 10).until(lambda d: any(f"/{page}" in link for link in results(d)))
        except Exception:
            found.append(f"a search for {word} does not find {page}: {results(driver)[:3]}")
    for word, item in ALIASES.items():
        driver.get(f"{address}/api/carom/index.html?search={urllib.parse.quote(word)}")
        try:
            has = lambda d: item in d.find_element(By.CSS_SELECTOR, "#results").text.replace("\u200b", "")
            WebDriverWait(driver, 10, ignored_exceptions=[Exception]).until(has)
        except Exception:
            found.append(f"the reference does not find {item} for {word}")
    return found


def main():
    selenium()
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("pages", nargs="*")
    parser.add_argument("--pictures", type=pathlib.Path, help="a folder for pictures of all pages")
    parser.add_argument("--all", action="store_true", help="all views of all pages")
    given = parser.parse_args()
    pages = given.pages or sorted(
        str(path.relative_to(SITE)) for folder in (SITE, SITE / "examples") for path in folder.glob("*.html")
        if path.name not in ("toc.html", "404.html"))
    axe = (TOOLS / "node_modules/axe-core/axe.min.js").read_text()
    address, driver, bad, looked = serve(), browser(), [], 0
    try:
        for width, scheme in VIEWS + OTHERS * given.all:
            view(driver, width, scheme)
            for page in pages:
                if page not in SAMPLE and (width, scheme) != VIEWS[0] and not given.all and not given.pages:
                    continue
                driver.get(f"{address}/{page}")
                driver.execute_script(axe)
                bad += [f"{page}, {width} pixels, {scheme}: {fault}" for fault in faults(driver, address, page, width)]
                looked += 1
                if given.pictures:
                    picture(driver, given.pictures / f"{page.replace('/', '-')}-{width}-{scheme}.png")
        bad += search(driver, address)
    finally:
        driver.quit()
    print(f"{looked} looks at {len(pages)} pages, {len(bad)} faults")
    if bad:
        sys.exit("\n".join(bad))


def picture(driver, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    height = min(12000, driver.execute_script("return document.documentElement.scrollHeight"))
    clip = {"x": 0, "y": 0, "width": driver.execute_script("return innerWidth"), "height": height, "scale": 1}
    shot = driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True, "clip": clip})
    path.write_bytes(base64.b64decode(shot["data"]))


if __name__ == "__main__":
    main()
