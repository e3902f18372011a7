"""Finds links that lead nowhere, in the site and in the Markdown files of the repository."""

import functools
import html
import pathlib
import re
import urllib.parse

ELSEWHERE = re.compile(r"^([a-z]+:|//)", re.IGNORECASE)
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)


@functools.cache
def anchors(path):
    """What a link into a file may point at."""
    text = path.read_text(errors="replace")
    if path.suffix == ".html":
        ids = map(html.unescape, re.findall(r'\bid="([^"]+)"', text))
        return {form for own in ids for form in (own, urllib.parse.unquote(own))}
    titles = re.findall(r"^#+ (.+)$", re.sub(r"```.*?```", "", text, flags=re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def dead(path, link):
    """Whether a link of a file leads nowhere."""
    place, _, heading = urllib.parse.unquote(link).partition("#")
    target = (path.parent / place.split("?")[0]).resolve() if place else path
    if target.is_dir() and path.suffix == ".html":
        target = target / "index.html"
    if not target.exists():
        return True
    # Numbers of lines, and the tasks of the playground, are no headings.
    has_anchors = target.suffix in (".html", ".md") and not re.search(r"/(src|playground)/", str(target))
    return bool(heading) and has_anchors and heading not in anchors(target)


def links(path):
    text = path.read_text(errors="replace")
    if path.suffix == ".html":
        text = re.sub(r"<script\b.*?</script>", "", text, flags=re.DOTALL)
        # What other crates say about all types has links of their own.
        text = re.sub(r'<h2 id="blanket-implementations".*', "", text, flags=re.DOTALL)
        return map(html.unescape, re.findall(r'\b(?:href|src)="([^"]*)"', text))
    text = CODE.sub("", text)
    return re.findall(r"\]\(([^)\s]+)\)", text) + re.findall(r"^\[[^\]]+\]:\s*(\S+)", text, re.MULTILINE)


def check(files, site):
    """Prints how many links there are in Markdown files and pages, and returns those that are dead."""
    pages = sorted(path for path in pathlib.Path(site).rglob("*.html"))
    count, bad = 0, []
    for path in [*files, *pages]:
        for link in links(path):
            if not link or ELSEWHERE.match(link) or path.suffix == ".md" and "::" in link:
                continue
            count += 1
            if dead(path, link):
                bad.append(f"{path}: {link}")
    print(f"{count} links in {len(files)} files and {len(pages)} pages, {len(bad)} dead")
    return bad
