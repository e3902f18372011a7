"""That the page says what is known, and only that."""

import re

# Links whose search with collisions ends undecided, and what is said of that side.
OPEN = {"task=bank&velocityX=-3": r"≤ \d\.\d{3} s open, at least \d\.\d{3} s|open at least \d\.\d{3} s"}

# Sets a slider to its lower end.
LOWER = """
const slider = document.getElementById(arguments[0]);
slider.value = slider.min;
slider.dispatchEvent(new Event("input", { bubbles: true }));
"""

# What is drawn of bodies, beside the room that they are in, in pixels.
OUTSIDE = """
const room = document.querySelector("#scene-free .room").getBoundingClientRect();
return [...document.querySelectorAll("#scene-free .handle .start, #scene-free .handle .obstacle, #scene-free .mover *")].map(node => {
  const box = node.getBoundingClientRect();
  return Math.max(room.left - box.left, box.right - room.right, room.top - box.top, box.bottom - room.bottom);
});
"""


def what_is_open_is_said_to_be_open(test):
    """A search that is not decided has a bound, which counts up while it runs; cancelled, it still has it."""
    browser = test.browser
    for link, words in OPEN.items():
        browser.call("POST", "url", {"url": "about:blank"})
        browser.call("POST", "url", {"url": f"{test.address}/#{link}"})
        bold = "document.querySelector('[data-side=tolerant] .steps').textContent"
        browser.wait(f"/so far/.test({bold})", "a bound while it is searched")
        told = browser.run(f"return {bold}")
        assert browser.text("[data-side=free] .steps") == "no plan"
        test.settled()
        said = f"{browser.text('[data-side=tolerant] .seconds')} {browser.text('[data-side=tolerant] .steps')}"
        print(f"{link}: {told}; at last {said}: {browser.text('#verdict')} {browser.text('#reason')}")
        assert re.fullmatch(words, said), said
        assert "open" in browser.text("#verdict") or "or more" in browser.text("#verdict")
        # Cancelled.
        browser.run("document.querySelector('#velocityX').dispatchEvent(new Event('input', { bubbles: true }))")
        browser.wait(f"/so far/.test({bold})", "a bound while it is searched again")
        browser.wait("document.querySelector('#cancel').getClientRects().length", "the button")
        browser.run("document.querySelector('#cancel').click()")
        said = browser.run(f"return {bold}")
        print(f"cancelled: {said}: {browser.text('#verdict')}")
        assert re.fullmatch(r"at least \d\.\d{3} s", said), said
        assert not browser.run("return document.querySelector('.story [data-side=tolerant].stale')")


def hits_obey_their_law(test, links):
    """The impulse of a hit is (1 + e) m v of the numbers beside it: of one mass, or of the reduced one of two."""
    browser, count = test.browser, 0
    for link in links:
        test.open(link)
        task = browser.run("""
            const { KINDS } = await import("./tasks.js"), { readLink } = await import("./link.js");
            const [name, state] = readLink(location.hash);
            return KINDS[name].task(state);
        """)
        masses = [body["mass"] for body in task["bodies"]]
        mass = masses[0] if len(masses) == 1 else masses[0] * masses[1] / sum(masses)
        for speed, impulse in re.findall(r"with (\S+) m/s, (\S+) N s", browser.text("[data-side=tolerant] .hits")):
            law = (1 + task["restitution"]) * mass
            assert abs(law * float(speed) - float(impulse)) <= 0.005 * (law + 1) + 1e-9, (link, speed, impulse)
            count += 1
    assert count >= 4, count
    print(f"{count} hits have the impulse of their speed")


def sliders_begin_with_tasks(test, links):
    """At its lower end, no slider states what cannot be planned."""
    browser, count = test.browser, 0
    for link in links:
        test.open(link)
        keys = browser.run("return [...document.querySelectorAll('#controls .slider input')].map(input => input.id)")
        for key in keys:
            browser.run("location.hash = ''; location.hash = arguments[0]", link)
            test.settled()
            browser.run(LOWER, key)
            browser.wait("document.documentElement.dataset.state !== 'planning' || /refuted/.test(document.querySelector('#progress').textContent)", key)
            state = browser.run("return document.documentElement.dataset.state")
            assert state != "failed", (link, key, browser.text("#verdict"))
            count += 1
    print(f"{count} sliders begin with a task")


def bodies_stay_in_their_room(test):
    browser = test.browser
    for link in ["task=bank&blockX=0&blockY=1", "task=pillar&startX=0&startY=3&pillarX=4&pillarY=0", "task=exchange&cartX=9&cartY=9&startX=0&startY=0"]:
        test.open(link)
        outside = browser.run(OUTSIDE)
        assert len(outside) >= 2 and max(outside) <= 1.5, (link, outside)
    print("nothing leaves its room")


def the_theme_stays(test):
    browser = test.browser
    theme = lambda: browser.run("return document.documentElement.dataset.theme")
    test.open()
    browser.run("document.querySelector('#theme').click()")
    chosen = theme()
    test.open()
    assert theme() == chosen, (theme(), chosen)
    browser.run("localStorage.removeItem('theme')")
    print(f"{chosen} after a reload too")



# Makes of each short search one that was stopped before it found a shorter plan than the careful one.
STOPPED = """
const post = Worker.prototype.postMessage, { set } = Object.getOwnPropertyDescriptor(Worker.prototype, "onmessage");
Worker.prototype.postMessage = function (data) { if (data.isCoarse) this.coarse = data.id; post.call(this, data); };
Object.defineProperty(Worker.prototype, "onmessage", { set(listen) {
  set.call(this, ({ data }) => {
    if (data.answer && data.id === this.coarse) data.answer.tolerant = { ...data.answer.free, found: false };
    listen({ data });
  });
} });
"""

# Keeps in `seen` what the picture with collisions shows, and drags a slider for a second.
DRAG = """
window.seen = [];
const place = document.querySelector("#scene-tolerant"), has = part => Boolean(place.querySelector(part));
new MutationObserver(() => seen.push([has(".plan"), has(".plan circle.hit"), has(".plan.older")])).observe(place, { childList: true });
const slider = document.querySelector("#restitution"), done = arguments[0];
let count = 0;
const timer = setInterval(() => {
  slider.value = 0.7 + 0.01 * (count % 10);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  if (++count < 20) return;
  clearInterval(timer);
  done();
}, 50);
"""


def hits_stay_while_one_drags(test):
    """A short search that decides nothing leaves the last hits, dimmed, and shows no careful plan in their place."""
    browser = test.browser
    script = browser.devtools("Page.addScriptToEvaluateOnNewDocument", source=STOPPED)["identifier"]
    test.open("task=exchange")
    browser.run_async(DRAG)
    test.settled()
    seen = browser.run("return window.seen")
    browser.devtools("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
    assert any(is_older for *_, is_older in seen), seen
    assert all(has_hits for has_plan, has_hits, _ in seen if has_plan), seen
    assert not browser.run("return document.querySelector('.plan.older')")
    print(f"{sum(is_older for *_, is_older in seen)} of {len(seen)} pictures keep the last hits")
