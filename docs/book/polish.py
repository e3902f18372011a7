"""Finishes HTML that mdBook and rustdoc wrote: formulas, places to scroll by keyboard, links between the
guide and the reference.
"""

import html
import json
import os
import re
import subprocess

FENCES = [
    re.compile(r'<pre><code class="language-math[^"]*">(.*?)</code></pre>', re.DOTALL),
    re.compile(r'<div class="example-wrap"><pre class="language-math"><code>(.*?)</code></pre></div>', re.DOTALL),
]
INLINE = re.compile(r"\$<code[^>]*>([^<]*)</code>\$")


def typeset(pages, site, tools):
    """Typesets the formulas of all pages: fences of `math`, and dollars around code."""
    script = os.path.join(os.path.dirname(__file__), "formulas.js")
    texts = {page: page.read_text() for page in pages}
    formulas = []
    for text in texts.values():
        for pattern in FENCES:
            formulas += [(html.unescape(tex), True) for tex in pattern.findall(text)]
        formulas += [(html.unescape(tex), False) for tex in INLINE.findall(text)]
    formulas = sorted(set(formulas))
    own = subprocess.run(
        ["node", script], input=json.dumps(formulas), capture_output=True, text=True,
        env={**os.environ, "NODE_PATH": str(tools / "node_modules")},
    )
    if own.returncode:
        raise SystemExit(f"a formula cannot be typeset:\n{own.stderr}")
    made = dict(zip(formulas, json.loads(own.stdout)))
    for page, text in texts.items():
        new = text
        for pattern in FENCES:
            new = pattern.sub(
                lambda m: f'<div class="formula" tabindex="0">{made[html.unescape(m[1]), True]}</div>', new)
        new = INLINE.sub(lambda m: made[html.unescape(m[1]), False], new)
        if new != text:
            style = f'{os.path.relpath(site, page.parent)}/katex/katex.min.css'
            page.write_text(new.replace("</head>", f'<link rel="stylesheet" href="{style}"></head>', 1))
    return len(formulas)


def book_page(path, site, nav):
    """A page of mdBook."""
    text = path.read_text()
    up = os.path.relpath(site, path.parent)
    up = "" if up == "." else up + "/"
    # What scrolls can be scrolled by keyboard.
    text = text.replace('<div class="table-wrapper">', '<div class="table-wrapper" tabindex="0" role="group" aria-label="Table">')
    text = re.sub(r"<pre>(\s*<code)", r"<pre>\1 tabindex=\"0\"".replace('\\"', '"'), text)
    # A first column without a title has no header.
    text = text.replace("<th></th>", "<td></td>")
    # Landmarks, and a button that the keyboard reaches.
    text = replaced(text, 'id="mdbook-menu-bar"', 'id="mdbook-menu-bar" role="banner"', path)
    text = replaced(text, 'id="mdbook-search-wrapper"', 'id="mdbook-search-wrapper" role="search"', path)
    text, count = re.subn(r'<label (id="mdbook-sidebar-toggle"[^>]*?) for="[^"]*"(.*?)</label>', r'<button type="button" \1\2</button>', text, flags=re.DOTALL)
    if not count:
        raise SystemExit(f"{path}: mdBook has another button for its table of contents")
    bar = f'<a class="text" href="{up}playground/index.html">Playground</a><a class="text" href="{up}api/carom/index.html">Reference</a>'
    text = replaced(text, '<div class="right-buttons">', f'<div class="right-buttons">{bar}', path)
    # The title of the page is the heading; the bar only names the book, and leads to its first page.
    text = re.sub(r'<h1 class="menu-title">(.*?)</h1>', rf'<a class="menu-title" href="{up}index.html">\1</a>', text)
    skip = '<a class="skip" href="#mdbook-content">Skip to the text</a>'
    text = re.sub(r"(<body[^>]*>)", rf"\1{skip}", text, count=1)
    text = replaced(text, 'id="mdbook-content"', 'id="mdbook-content" tabindex="-1"', path)
    if nav:
        text = replaced(text, "</main>", f"{nav}</main>", path)
    # Its menu of themes has five; two are calm enough.
    text = re.sub(r'\s*<li role="none"><button[^>]*id="mdbook-theme-(?:rust|coal|ayu)".*?</li>', "", text)
    text = text.replace('id="mdbook-theme-navy">Navy<', 'id="mdbook-theme-navy">Dark<')
    path.write_text(text)


def reference_page(path, site, guide):
    """A page of rustdoc: a line that leads back to the guide."""
    text = path.read_text(errors="replace")
    up = os.path.relpath(site, path.parent)
    place = f' · <a href="{up}/{guide}">this page in the guide</a>' if guide else ""
    bar = (f'<nav aria-label="Site" class="site-bar" style="font-size:.9rem;margin-bottom:1rem">'
           f'<a href="{up}/index.html">carom: guide, tutorial and examples</a>{place}</nav>')
    start = '<section id="main-content" class="content" tabindex="-1">'
    if start in text:
        path.write_text(text.replace(start, start + bar, 1))


def replaced(text, old, new, path):
    if old not in text:
        raise SystemExit(f"{path}: mdBook no longer writes {old}")
    return text.replace(old, new, 1)
