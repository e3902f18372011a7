"""The table of a chip, beside a search."""

import base64
import gzip

import axe
from driver import Browser
from questions import CONTRAST, OVERLAPS
from served import PAGE, Served

LARGEST = 16_000  # bytes of the compressed look-up and its table
LEFT = "\ue012"  # a key of WebDriver


def opened(test):
    """The page with the table in sight."""
    test.open()
    test.browser.run("document.querySelector('#chip').open = true")
    test.browser.wait("(document.querySelector('#chip').scrollIntoView(), document.querySelector('#chip').dataset.answer)", "the table")


def answers_beside_a_search(test, pictures):
    size = len(gzip.compress((PAGE / "pkg/table/table.wasm").read_bytes(), 9))
    print(f"table: {size} bytes compressed")
    assert size < LARGEST
    opened(test)
    text, browser = test.browser.text, test.browser
    before = [text("#chip-input"), text("#chip-words"), text("#chip-optimum")]
    print("; ".join(before), "-", text("#chip-size"))
    assert before[0].endswith("m/s²") and "Proved: it loses at most" in before[1], before
    assert float(before[2]) > 0 and "least cost" in text("#chip-searched"), before
    browser.wait("/takes .* here/.test(document.querySelector('#chip-time').textContent)", "the time of a look-up")
    print(text("#chip-time"))
    # By keyboard: another state, which no search has solved.
    browser.type("#chip-position", LEFT * 20)
    after = [text("#chip-input"), text("#chip-words"), text("#chip-optimum")]
    assert after[1] != before[1] and after[2] == "–" and "Not searched" in text("#chip-searched"), after
    # All states that a search has solved: bounds hold, and there is none without a plan.
    for k in range(browser.run("return document.querySelectorAll('#chip-solved button').length")):
        browser.run("document.querySelectorAll('#chip-solved button')[arguments[0]].click()", k)
        best, words = text("#chip-optimum"), text("#chip-words")
        print(f"{text('#chip-input')}; {best}; {words}")
        if best == "no plan":
            assert text("#chip-input") in ("no plan", "open"), words
        elif words.startswith("Its plan costs"):
            # What is shown is rounded.
            least = float(words.split()[-1].rstrip("."))
            assert least - 0.001 <= float(best) <= float(words.split()[3].rstrip(".")) + 0.001, words
    # By pointer: the upper right corner, which has no plan.
    place = browser.run("""
        const frame = document.querySelector("#chip-picture svg").getBoundingClientRect();
        return [frame.x + 0.95 * frame.width, frame.y + 0.05 * frame.height].map(Math.round);
    """)
    browser.drag([place[0] - 40, place[1] + 40], place)
    assert text("#chip-input") == "no plan" and text("#chip-time") == "", text("#chip-words")
    for width in (1280, 320):
        browser.devtools("Emulation.setDeviceMetricsOverride", width=width, height=1000, deviceScaleFactor=1, mobile=width < 400)
        for theme in ("light", "dark"):
            browser.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
            opened(test)
            wide = browser.run("return [document.documentElement.scrollWidth, innerWidth]")
            assert wide[0] <= wide[1], wide
            for question in (CONTRAST, OVERLAPS):
                found = browser.run(question)
                assert not found, f"{width}, {theme}: {found}"
            script = axe.source()
            found = axe.violations(browser, script) if script else []
            assert not found, f"{width}, {theme}: {found}"
            if pictures:
                whole = browser.devtools("Page.captureScreenshot", captureBeyondViewport=True)
                (pictures / f"chip_{width}_{theme}.png").write_bytes(base64.b64decode(whole["data"]))
    browser.devtools("Emulation.clearDeviceMetricsOverride")


def says_what_is_missing(browser):
    """Sentences of the table where it cannot be loaded, or arrives compressed."""
    for fault, word in {"missing": "404 for pkg/table/", "html": "is not WebAssembly", "gzip": "Its plan costs"}.items():
        with Served(fault) as address:
            browser.call("POST", "url", {"url": f"{address}/"})
            browser.wait("(document.querySelector('#chip').scrollIntoView(), "
                         f"document.querySelector('#chip-words').textContent.includes({word!r}))", fault)
            print(f"{fault}: {browser.text('#chip-words')}")
    # Browsers tell their console about this.
    browser.call("POST", "se/log", {"type": "browser"})


def main():
    """This part alone."""
    import pathlib
    import sys

    from browser import Test
    browser = Browser()
    try:
        with Served() as address:
            test = Test(browser, address)
            answers_beside_a_search(test, pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else None)
            test.is_quiet()
        says_what_is_missing(browser)
    finally:
        browser.close()


if __name__ == "__main__":
    main()
