"""Drags sliders as a visitor does, and counts the pictures that are drawn meanwhile."""

RATES = [16, 150]  # ms an event
SECONDS = 2
LEAST = 1  # pictures: the last one. How many are drawn while one drags depends on the machine, and is printed.
STALE = 100  # ms that a number of an older task may stay as it was

# Moves a slider from end to end and back. Answers with the number of pictures, for how long at most
# numbers of an older task were to be read as if they were those of the newest, in ms, and how often its
# value changed.
DRAG = """
const [key, every, seconds, done] = arguments;
const page = document.documentElement, input = document.getElementById(key);
const isOld = node => node.dataset.of !== page.dataset.asked && node.getClientRects().length && node.textContent.trim() && getComputedStyle(node).opacity > .6;
const before = Number(page.dataset.pictures ?? 0), begun = performance.now();
let changes = 0, since = null, longest = 0;
const timer = setInterval(() => {
  const part = (performance.now() - begun) / 1000 / seconds;
  if (part > 1) return;
  const [min, max, step] = [input.min, input.max, input.step].map(Number), wave = 1 - Math.abs(1 - 2 * part);
  const value = min + Math.round((max - min) * wave / step) * step;
  if (Math.abs(value - Number(input.value)) < step / 2) return;
  input.value = value;
  changes += 1;
  input.dispatchEvent(new Event("input", { bubbles: true }));
}, every);
const look = () => {
  const now = performance.now();
  if (![...document.querySelectorAll("[data-answer]")].some(isOld)) since = null;
  else longest = Math.max(longest, now - (since ??= now));
  if (now - begun < 1000 * seconds) return requestAnimationFrame(look);
  clearInterval(timer);
  done([Number(page.dataset.pictures) - before, Math.round(longest), changes]);
};
requestAnimationFrame(look);
"""


def sliders(browser):
    return browser.run("return [...document.querySelectorAll('#sliders input')].map(input => input.id)")


def previews_say_so(test):
    """While one drags, the page says that what it shows is coarse, and no longer when it is not."""
    test.open()
    test.browser.run("""
        window.seen = new Set();
        const node = document.querySelector("#preview");
        new MutationObserver(() => seen.add(node.textContent)).observe(node, { childList: true });
    """)
    test.browser.run_async(DRAG, "velocity", 60, 2 * SECONDS)
    test.settled()
    seen = test.browser.run("return [...window.seen]")
    assert any(words.startswith("Coarse preview: steps of") for words in seen), seen
    assert test.browser.text("#preview") == "", seen
    print(f"while one drags: {max(seen, key=len)}")


def drag_all(test, links, rates=RATES):
    """Every slider of some tasks, at every rate."""
    bad, fewest = [], 1_000
    for link in links:
        test.open(link)
        for key in sliders(test.browser):
            for every in rates:
                test.open(link)
                pictures, stale, changes = test.browser.run_async(DRAG, key, every, SECONDS)
                fewest = min(fewest, pictures)
                what = f"{link or 'wall'}, {key}, {every} ms: {pictures} pictures of {changes} changes, older numbers for {stale} ms"
                print(what, flush=True)
                if pictures < min(LEAST, changes) or stale > STALE:
                    bad.append(what)
    assert not bad, "\n".join(bad)
    print(f"every drag draws, {fewest} pictures at least")
