"""Writes the pages that mdBook makes into the site: the Markdown files of `docs`, and a page for each
example. What differs from the files is how they link: to items of the crate, to files, to each other.
"""

import html
import os
import re

import links

# In the order in which one learns: title in the table of contents, file, and what the page is about in
# the reference. A title alone begins a part.
GUIDES = [
    ("Welcome", "docs/landing.md", []),
    ("Learn",),
    ("From a robot to a proved plan", "docs/tutorial.md", ["hybrid"]),
    ("Hybrid systems", "docs/hybrid_system.md", ["hybrid"]),
    ("Scenes: vehicles among walls", "docs/scenes.md", ["hybrid::scene"]),
    ("A mission", "docs/missions.md", ["hybrid"]),
    ("Models", "docs/modelling.md", ["model", "reformulate"]),
    ("A search that does not finish", "docs/my_search_does_not_finish.md", ["solver", "explain"]),
    ("What makes a statement weak", "docs/weak_statements.md", ["hybrid", "reformulate"]),
    ("A file and a solver", "docs/a_file_and_a_solver.md", ["model"]),
    ("Help: what a message means", "docs/help.md", ["error"]),
    ("From Python", "docs/python.md", []),
    ("On a cluster", "docs/cluster.md", ["sweep"]),
    ("How horizons are refuted", "docs/reach_sets.md", ["hybrid::reach"]),
    ("Plans that hold", "docs/robust_plans.md", ["hybrid"]),
    ("Solved beforehand: tables for a chip", "docs/explicit_control.md", ["explicit"]),
    ("The paper, equation by equation", "docs/formulation.md", ["collision_tolerant"]),
    ("Examples",),
    ("Gallery", "docs/gallery.md", []),
    ("Behind it",),
    ("Proofs that others can check", "docs/proofs.md", ["solver"]),
    ("Benchmarks", "docs/benchmarks.md", []),
    ("Decisions", "docs/decisions.md", []),
    ("Architecture", "docs/architecture.md", []),
    ("Contributing", "CONTRIBUTING.md", []),
    ("Changes", "CHANGELOG.md", []),
]
KINDS = ["struct", "enum", "trait", "fn", "macro", "type", "constant", "derive"]
MEMBERS = ["method", "tymethod", "variant", "structfield", "associatedconstant"]
FENCES = re.compile(r"^(```.*?^```[^\n]*\n?)", re.DOTALL | re.MULTILINE)
CODE = re.compile(r"(`[^`]*`)")
RUN = re.compile(r"`(?:cargo run (?:--release )?--example|docs/pictures) (\w+)[^`]*`")


class Pages:
    """The pages of a book in `folder`, with links to the reference in `api`, whose address is `api/`."""

    def __init__(self, root, folder, api):
        self.root, self.folder, self.api = root, folder, api
        self.examples = {
            path.stem if path.suffix else path.name: path
            for path in sorted((root / "examples").iterdir())
            if path.suffix == ".rs" or (path / "main.rs").exists()
        }
        self.names = {file: os.path.basename(file) for _, file, *_ in filter(lambda g: len(g) > 1, GUIDES)}
        self.names["docs/landing.md"] = "index.md"
        for name, path in self.examples.items():
            self.names[str(path.relative_to(root))] = f"examples/{name}.md"
        # What the reference says about links that end in files (`src/guide.rs`).
        text = (root / "src/guide.rs").read_text()
        named = r'((?:#\[doc = "\[[^"]*"\]\s*)*)#!?\[doc = include_str!\("\.\./([^"]+)"\)\]\s*(?:pub mod (\w+))?'
        found = re.findall(named, text)
        self.definitions = {file: re.findall(r'"(\[[^"]*)"', before) for before, file, _ in found}
        self.modules = {file: f"guide/{module}" if module else "guide" for _, file, module in found}

    def write(self):
        """All pages; returns the order of them, as title and name."""
        summary, order = [], []
        for title, *guide in GUIDES:
            if not guide:
                summary.append(f"\n# {title}\n")
                continue
            file, modules = guide
            name = self.names[file]
            text = (self.root / file).read_text()
            if file == "docs/landing.md":
                # The picture of the README.
                hero = re.search(r"!\[[^\]]*\]\(docs/(images/[^)]+)\)", (self.root / "README.md").read_text())
                text = text.replace("\nHERO\n", f"\n{hero[0].replace('docs/images', 'images')}\n")
            text = self.page(file, text)
            self.save(name, self.with_reference(text, modules))
            order.append((title, name))
            summary.append(f"- [{title}]({name})" if file != "docs/landing.md" else f"[{title}]({name})")
            if file == "docs/gallery.md":
                for example, path in self.examples.items():
                    name = f"examples/{example}.md"
                    self.save(name, self.example(example, path))
                    order.append((example, name))
                    summary.append(f"    - [{example}]({name})")
        self.save("SUMMARY.md", "# Summary\n\n" + "\n".join(summary) + "\n")
        return order

    def save(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def with_reference(self, text, modules):
        """A page with a line below its title that says where the reference is."""
        if not modules:
            return text
        own = ", ".join(f"[`{path}`]({self.item('crate::' + path)})" for path in modules)
        return re.sub(r"^(# .+\n)", rf'\1\n<p class="reference">\n\nIn the reference: {own}\n\n</p>\n', text, count=1, flags=re.M)

    def page(self, file, text):
        """A Markdown file as a page."""
        name = self.names[file]
        text = "\n".join([*self.definitions.get(file, []), "", text])
        pieces = FENCES.split(text)
        for k, piece in enumerate(pieces):
            if piece.startswith("```"):
                pieces[k] = re.sub(r"\A```(?:no_run|compile_fail|should_panic|ignore)?\n", "```rust\n", piece)
                continue
            piece = re.sub(r"^(\[[^\]]+\]:\s*)(\S+)", lambda m: m[1] + self.target(file, m[2]), piece, flags=re.M)
            parts = CODE.split(piece)
            for i in range(0, len(parts), 2):
                link = lambda m: "](" + self.target(file, m[1]) + ")"
                parts[i] = re.sub(r"\]\(\s*([^)\s]+)\s*\)", link, parts[i])
            piece = "".join(parts)
            # A command that runs an example leads to its page, a picture to itself in full size.
            run = lambda m: f"[{m[0]}]({self.near(name, 'examples/' + m[1] + '.md')})" if m[1] in self.examples else m[0]
            piece = RUN.sub(run, piece)
            piece = re.sub(r"^(!\[[^\]]*\]\(([^)]+)\))$", r"[\1](\2)", piece, flags=re.M)
            if file == "docs/gallery.md":
                piece = re.sub(r"^\| (`.*?) \|", lambda m: "| " + self.named(m[1]) + " |", piece, flags=re.M)
            pieces[k] = piece
        return "".join(pieces).strip() + "\n"

    def named(self, cell):
        return re.sub(r"`(\w+)`", lambda m: f"[{m[0]}](examples/{m[1]}.md)" if m[1] in self.examples else m[0], cell)

    def target(self, file, link):
        """Where a link of a file leads in the site."""
        if link == "crate":
            return "api/carom/index.html"
        if links.ELSEWHERE.match(link) and not link.startswith("crate::") or link.startswith("#"):
            return link
        own = self.names[file]
        place, _, heading = link.partition("#")
        heading = f"#{heading}" if heading else ""
        if place.startswith("crate::guide"):
            module = place.removeprefix("crate::").replace("::", "/")
            page = next((file for file, name in self.modules.items() if name == module), None)
            return self.near(own, self.names[page] if page in self.names else self.item(place)) + heading
        if place.startswith("crate::"):
            return self.near(own, self.item(place)) + heading
        path = os.path.normpath(os.path.join(os.path.dirname(file), place))
        if path.startswith("docs/images/"):
            return self.near(own, path.removeprefix("docs/")) + heading
        if path == "examples":
            return self.near(own, "gallery.md")
        if path in self.names:
            return self.near(own, self.names[path]) + heading
        source = re.match(r"(?:crates/([\w-]+)/)?src/(.*)", path)
        if source:
            if not self.has_reference():
                return self.near(own, "api/carom/index.html")
            crate = (source[1] or "carom").replace("-", "_")
            return self.near(own, f"api/src/{crate}/{source[2]}.html")
        raise SystemExit(f"{file}: no page of the site for {link}")

    def near(self, own, target):
        return os.path.relpath(target, os.path.dirname(own) or ".")

    def has_reference(self):
        return (self.api / "carom/all.html").exists()

    def item(self, path):
        """The page of an item of the crate, by its path."""
        if not self.has_reference():
            return "api/carom/index.html"
        parts = path.removeprefix("crate::").split("::")
        folder = "/".join(parts)
        if (self.api / "carom" / folder / "index.html").exists():
            return f"api/carom/{folder}/index.html"
        for split in (len(parts) - 1, len(parts) - 2):
            if split < 0:
                continue
            # What a module exports of a module within has its page there.
            base = self.api / "/".join(["carom", *parts[:split]])
            for kind in KINDS:
                pages = sorted(base.rglob(f"{kind}.{parts[split]}.html"), key=lambda page: len(page.parts))
                if not pages:
                    continue
                address = f"api/{pages[0].relative_to(self.api)}"
                if split == len(parts) - 1:
                    return address
                for member in MEMBERS:
                    if f"{member}.{parts[-1]}" in links.anchors(pages[0]):
                        return f"{address}#{member}.{parts[-1]}"
        raise SystemExit(f"no page of the reference for {path}")

    def example(self, name, path):
        """The page of an example: what it says about itself, its pictures, its source."""
        files = [path] if path.suffix else sorted(path.glob("*.rs"), key=lambda file: (file.stem != "main", file))
        about, _ = self.divided(files[0])
        text = f"# `{name}`\n\n{about}\n"
        for alt, picture in self.pictures(name):
            text += f"\n[![{alt}](../{picture})](../{picture})\n"
        for file in files:
            if len(files) > 1:
                text += f"\n## {file.name}\n"
            head, source = self.divided(file)
            if file is not files[0]:
                text += f"\n{head}\n"
            text += f"\n```rust\n{source}\n```\n"
        shared = sorted(set(re.findall(r'#\[path = "(?:\.\./)?(?:common/)?(\w+)\.rs"\]', text)))
        for own in shared:
            source = self.root / f"examples/common/{own}.rs"
            if source.exists():
                head, source = self.divided(source)
                text += f"\n## common/{own}.rs\n\n{head}\n\n```rust\n{source}\n```\n"
        return text

    def divided(self, path):
        """The sentences at the beginning of a source file, and the rest of it."""
        lines = path.read_text().rstrip().split("\n")
        end = next((k for k, line in enumerate(lines) if not line.startswith("//!")), len(lines))
        about = "\n".join(re.sub(r"^//! ?", "", line) for line in lines[:end])
        # Names of items are links in the reference alone.
        about = re.sub(r"\[(`[^`]+`)\](?![\[(:])", r"\1", about)
        about = re.sub(r"^```(?:no_run)?\n", "```text\n", about, count=1)
        return about, "\n".join(lines[end:]).strip("\n")

    def pictures(self, example):
        """The pictures that an example makes, by the gallery."""
        text = (self.root / "docs/gallery.md").read_text()
        own = []
        pieces = re.split(r"(`(?:cargo run|docs/pictures)[^`]*`|^## )", text, flags=re.M)
        for head, body in zip(pieces[1::2], pieces[2::2]):
            run = RUN.match(head)
            if run and run[1] == example:
                own += re.findall(r"!\[([^\]]*)\]\((images/[^)]+)\)", body)
        return own


def address(name):
    """The page that mdBook makes of a file."""
    return name.removesuffix(".md") + ".html"


def neighbours(order, at):
    """Links to the pages before and after one, in HTML."""
    _, own = order[at]
    parts = []
    for step, word, text in ((-1, "Previous", '<span aria-hidden="true">←</span> {}'), (1, "Next", '{} <span aria-hidden="true">→</span>')):
        k = at + step
        if not 0 <= k < len(order):
            continue
        title, name = order[k]
        place = os.path.relpath(address(name), os.path.dirname(own) or ".")
        parts.append(f'<a class="{word.lower()}-page" href="{place}"><small>{word}</small>'
                     f"<span>{text.format(html.escape(title))}</span></a>")
    return f'<nav class="neighbours" aria-label="Previous and next page">{"".join(parts)}</nav>'
