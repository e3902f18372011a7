"""What the page says where its planner cannot be loaded, or arrives as it should not."""

from served import PAGE, Served

# What is wrong with the server, and a word of the sentence that must come.
FAULTS = {
    "missing": "the server answers 404 for pkg/first/carom_playground_bg.wasm",
    "html": "is not WebAssembly",
    "cut": "is damaged or incomplete",
}


def need_not_scroll_in_a_frame(browser, address):
    """In a frame, the page tells how high it is, at every width."""
    for width in (1100, 360):
        browser.call("POST", "url", {"url": f"{address}/index.html"})
        browser.run("""
            document.documentElement.innerHTML = `<body><iframe src="index.html" style="width: ${arguments[0]}px; border: 0"></iframe></body>`;
            const frame = document.querySelector("iframe");
            addEventListener("message", ({ data }) => { frame.style.height = `${Math.ceil(data.height) + 2}px`; });
        """, width)
        inside = "document.querySelector('iframe').contentDocument?.documentElement"
        browser.wait(f"{inside}?.dataset.state === 'planned'", "a plan in a frame")
        browser.wait(f"{inside}.scrollHeight <= {inside}.clientHeight && {inside}.clientHeight > 500", "its height")
        wide = browser.run(f"return [{inside}.scrollWidth, {inside}.clientWidth]")
        assert wide[0] <= wide[1], wide
    print("in a frame nothing scrolls")


def says_what_is_missing(browser):
    for fault, word in FAULTS.items():
        with Served(fault) as address:
            browser.call("POST", "url", {"url": f"{address}/"})
            browser.wait("document.documentElement.dataset.state === 'failed'", fault)
            verdict = browser.text("#verdict")
            print(f"{fault}: {verdict}")
            assert word in verdict, f"no {word!r}"
    # A scene needs another planner, and is told apart from the first one.
    with Served("missing") as address:
        browser.call("POST", "url", {"url": f"{address}/#task=bank"})
        browser.wait("document.documentElement.dataset.state === 'failed'", "a sentence")
        assert "404 for pkg/all/" in browser.text("#verdict"), browser.text("#verdict")
    # Compressed without saying so: works, and says so.
    with Served("gzip") as address:
        browser.call("POST", "url", {"url": f"{address}/"})
        browser.wait("document.documentElement.dataset.state === 'planned'", "a plan")
        note = browser.text("#note")
        print(f"gzip: {note}")
        assert "Content-Encoding" in note
    # As a file.
    browser.call("POST", "url", {"url": (PAGE / "index.html").as_uri()})
    browser.wait("document.querySelector('#verdict code')", "a sentence")
    print(f"file: {browser.text('#verdict')}")
    assert "python3 -m http.server" in browser.text("#verdict")
    assert browser.run("return document.querySelector('.controls').getClientRects().length") == 0
    # Browsers tell their console about all of this.
    browser.call("POST", "se/log", {"type": "browser"})
