"""axe-core, which finds what people with screen readers, keyboards or bad sight stumble over."""

import os
import pathlib
import shutil
import subprocess

VERSION = "4.10.3"
ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDER = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve() / "axe"


def source():
    """The script, from npm; None where that cannot be had."""
    file = FOLDER / f"node_modules/axe-core/axe.min.js"
    if not file.exists():
        if not shutil.which("npm"):
            return None
        command = ["npm", "install", "--silent", "--no-audit", "--no-fund", "--prefix", FOLDER, f"axe-core@{VERSION}"]
        FOLDER.mkdir(parents=True, exist_ok=True)
        if subprocess.run(command, check=False).returncode:
            return None
    return file.read_text()


def violations(browser, script):
    """What is wrong with the page that is open, a line each."""
    browser.run(script + "; window.axe = axe")
    found = browser.run_async("""
        const done = arguments[arguments.length - 1];
        axe.run(document, { resultTypes: ["violations"] }).then(
          found => done(found.violations.map(({ id, nodes }) => `${id}: ${nodes.map(node => node.html.slice(0, 120)).join(" | ")}`)),
          error => done([String(error)]));
    """)
    return found
