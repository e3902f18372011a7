"""That answers come, that one can end the wait for them, and that people understand them."""

import re
import time

# The worst that one can ask, and a word of the sentence that must come.
WORST = {
    "task=bank&goalX=0.5&goalY=0.7": "block",
    "task=bank&blockX=1.2&blockY=0.2": "block",
    "start=4&velocity=-10&restitution=0.3&impactLimit=4": "no plan",
    "task=exchange&goalX=3": "",
    "task=exchange&goalX=4": "",
    "task=exchange&goalX=5": "",
    "task=exchange&velocityX=-3": "no plan",
    "task=pillar&startX=0": "plan that bounces",
    "task=bank&maxAcceleration=0": "no plan",
    "maxAcceleration=0&velocity=-5": "no plan",
}
# Names of variables, of statements, and numbers that nobody reads.
UNREADABLE = re.compile(r"`|clear and|beyond \d|\bv[xy]\b|\ba[xy]\b|\d\.\d{4}|\bwall \d|_|stopped")

# Requests to workers are swallowed while `silent` is set.
SILENCE = """
const post = Worker.prototype.postMessage;
Worker.prototype.postMessage = function (data) { if (!(window.silent && data.what)) post.call(this, data); };
"""

# Keeps in `seen` what is said while a plan is being found, in order.
WATCH = """
window.seen = [];
addEventListener("DOMContentLoaded", () => {
  for (const name of ["#progress", "[data-side=free] .seconds", "[data-side=tolerant] .seconds"]) {
    const node = document.querySelector(name);
    if (node) new MutationObserver(() => window.seen.push(`${name}: ${node.textContent}`)).observe(node, { childList: true, characterData: true, subtree: true });
  }
});
"""


def sentences(browser):
    return " ".join(browser.text(f"#{name}") for name in ("verdict", "reason")).strip()


def worst_links_are_answered(test):
    test.open()  # so that the planner is compiled
    bad = []
    for link, word in WORST.items():
        begun = time.monotonic()
        test.browser.run_async("""
            addEventListener("hashchange", () => setTimeout(arguments[1]), { once: true });
            location.hash = arguments[0];
        """, link)
        test.settled()
        seconds, said = time.monotonic() - begun, sentences(test.browser)
        print(f"{link}: {seconds:.2f} s: {said}")
        if word not in said or not said.endswith(".") or UNREADABLE.search(said):
            bad.append(f"{link}: {said}")
    assert not bad, "\n".join(bad)


def move(browser, key, value):
    browser.run("""
        const slider = document.getElementById(arguments[0]);
        slider.value = arguments[1];
        slider.dispatchEvent(new Event("input", { bubbles: true }));
    """, key, value)


def waits_can_be_ended(test):
    browser = test.browser
    script = browser.devtools("Page.addScriptToEvaluateOnNewDocument", source=SILENCE)["identifier"]
    test.open()
    plan = test.steps("tolerant")
    # A planner that does not answer: what is shown is dimmed, and a way out is offered after 2 s.
    browser.run("window.silent = true")
    move(browser, "goal", 0.5)
    begun = time.monotonic()
    browser.wait("document.querySelector('.stale .seconds')", "that numbers are dimmed", 0.5)
    browser.wait("document.querySelector('#progress').textContent", "progress", 2)
    assert browser.run("return document.querySelector('.story [data-side=tolerant]').getAttribute('aria-busy')") == "true"
    browser.wait("document.querySelector('#cancel').getClientRects().length", "the button", 4)
    seconds = time.monotonic() - begun
    assert seconds > 1.5, seconds
    browser.run("document.querySelector('#cancel').click()")
    assert browser.text("#verdict").startswith("Cancelled"), browser.text("#verdict")
    assert browser.run("return Boolean(document.querySelector('.stale .seconds')) && document.querySelector('#cancel').hidden")
    # Another one takes over, also from one that does not answer.
    move(browser, "goal", 0.6)
    browser.run("window.silent = false")
    move(browser, "goal", 0.3)
    test.settled()
    assert test.steps("tolerant") == plan, test.steps("tolerant")
    assert not browser.run("return document.querySelector('[data-answer].stale')")
    browser.devtools("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
    print(f"a wait can be ended after {seconds:.1f} s")


def progress_is_told(test):
    browser = test.browser
    script = browser.devtools("Page.addScriptToEvaluateOnNewDocument", source=WATCH)["identifier"]
    for link in ["", "task=bank"]:
        test.open(link)
        seen = browser.run("return window.seen")
        free, bold = (next(k for k, words in enumerate(seen) if words.startswith(f"[data-side={side}]") and words.endswith(" s"))
                      for side in ("free", "tolerant"))
        assert free < bold, seen
        assert any(words.endswith(" MB") for words in seen), seen
        told = [words for words in seen if "refuted to" in words]
        assert told, seen
        print(f"{link or 'wall'}: {len(told)} times, at last {told[-1]}")
    browser.devtools("Page.removeScriptToEvaluateOnNewDocument", identifier=script)


def one_step_less_is_shown(test, links):
    browser = test.browser
    for link in links:
        test.open(link)
        test.explained()
        assert browser.run("return document.querySelector('#less').getClientRects().length"), link
        print(f"{link or 'wall'}: {browser.text('#less-title')}")
        pictures = set()
        for part in (0, 0.3, 0.6, 1):
            browser.run("""
                const slider = document.querySelector("#less-time");
                slider.value = Math.round(arguments[0] * slider.max);
                slider.dispatchEvent(new Event("input"));
            """, part)
            areas = browser.run("return document.querySelector('#less-picture .now').innerHTML")
            assert "reached" in areas or "to-go" in areas, (link, part)
            assert "NaN" not in areas and "Infinity" not in areas
            pictures.add(areas)
        assert len(pictures) == 4, link
