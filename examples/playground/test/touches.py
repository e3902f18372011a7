"""Drags every handle with a thumb: real touches, which the browser may take for scrolling."""

WIDTH, HEIGHT = 375, 800
MOVES = 15
LEAST = 20  # pixels: a drag that is shorter than this is none that the browser would take for scrolling

# What the page has to say of a handle: where its grip is, and how far it may go, in pixels of the window.
# The tip of an arrow is drawn inside its picture.
LOOK = """
const [place, name] = arguments, picture = document.querySelector(place);
const grip = picture.querySelector(`[data-handle="${name}"] .grip`).getBoundingClientRect();
const frame = (picture.querySelector(".room") ?? picture).getBoundingClientRect();
return { at: [grip.x + grip.width / 2, grip.y + grip.height / 2], frame: [frame.left, frame.top, frame.right, frame.bottom],
  link: location.hash, scrolled: [scrollX, scrollY], heard: window.heard, ended: window.ended };
"""

# Counts what comes of touches, in the page itself.
LISTEN = """
window.heard = window.ended = 0;
addEventListener("pointermove", event => { if (event.pointerType === "touch") heard += 1; }, true);
addEventListener("pointercancel", () => { ended += 1; }, true);
"""

# The handles of the picture that a visitor sees.
HANDLES = """
const place = ["#track", "#scene-free", "#scene-tolerant"].find(place => document.querySelector(`${place} svg`)?.getClientRects().length);
const names = [...document.querySelectorAll(`${place} [data-handle]`)].map(node => node.dataset.handle);
document.querySelector(place).scrollIntoView({ block: "center" });
return [place, names];
"""


def touch(browser, kind, *places):
    points = [{"x": x, "y": y} for x, y in places]
    browser.devtools("Input.dispatchTouchEvent", type=kind, touchPoints=points)


def away(at, low, high):
    """Towards the farther end, and how far a handle can go."""
    return (1, high - at) if high - at > at - low else (-1, at - low)


def drag(browser, place, name, axis, flat):
    """Moves a handle along an axis; a `flat` one moves sideways only. Answers with what is wrong, and how far it came."""
    look = lambda: browser.run(LOOK, place, name)
    begin = look()
    start, bad = begin["at"], []
    sign, room = away(start[axis], begin["frame"][axis], begin["frame"][axis + 2])
    far = min(8 * MOVES, max(LEAST, 0.9 * room))
    touch(browser, "touchStart", start)
    followed, before = 0, start
    for k in range(1, MOVES + 1):
        finger = list(start)
        finger[axis] += sign * far * k / MOVES
        touch(browser, "touchMove", finger)
        browser.run_async("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
        now = look()
        followed += now["heard"] - begin["heard"] >= k
    end = look()
    touch(browser, "touchEnd")
    if end["ended"] > begin["ended"]:
        bad.append("the browser ended the drag")
    if end["scrolled"] != begin["scrolled"]:
        bad.append(f"scrolled from {begin['scrolled']} to {end['scrolled']}")
    if followed < MOVES:
        bad.append(f"followed {followed} of {MOVES} moves")
    moved = end["at"][axis] - start[axis]
    if (axis == 0 or place != "#track" and not flat) and moved * sign < 4:
        bad.append("it stands still")
    return bad, moved, sign * far


def follow_a_thumb(test, links):
    browser = test.browser
    browser.devtools("Emulation.setDeviceMetricsOverride", width=WIDTH, height=HEIGHT, deviceScaleFactor=2, mobile=True)
    browser.devtools("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=1)
    script = browser.devtools("Page.addScriptToEvaluateOnNewDocument", source=LISTEN)["identifier"]
    bad, count = [], 0
    for link in links:
        test.open(link)
        low = browser.run("return document.querySelector('#sliders').getBoundingClientRect().bottom")
        if low > HEIGHT:
            bad.append(f"{link or 'wall'}: the picture, the numbers and the first sliders end at {low:.0f} pixels")
        place, names = browser.run(HANDLES)
        for name in names:
            for axis, way in enumerate(["sideways", "up or down"]):
                # As the link has it again, with no handle on another one.
                browser.run("location.hash = ''; location.hash = arguments[0]", link)
                test.settled()
                browser.run(HANDLES)
                wrong, moved, far = drag(browser, place, name, axis, (link, name) == ("task=exchange", "velocity"))
                what = f"{link or 'wall'}, {name}, {way}: {moved:.0f} of {far:.0f} pixels"
                print(what, "; ".join(wrong), flush=True)
                bad += [f"{what}: {fault}" for fault in wrong]
                count += 1
    browser.devtools("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
    browser.devtools("Emulation.setTouchEmulationEnabled", enabled=False)
    browser.devtools("Emulation.clearDeviceMetricsOverride")
    assert not bad, "\n".join(bad)
    print(f"{count} drags of a thumb are followed, and nothing scrolls")
