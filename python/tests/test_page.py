"""The Python blocks of the pages about the package, run from top to bottom."""

import pathlib
import re

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[1]
PAGES = [FOLDER.parent / "docs" / "python.md", FOLDER / "README.md"]


@pytest.mark.parametrize("page", PAGES, ids=[page.name for page in PAGES])
def test_blocks_run(page, tmp_path, monkeypatch):
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    assert blocks
    if any("cvxpy" in block for block in blocks):
        pytest.importorskip("cvxpy")
    monkeypatch.chdir(tmp_path)
    pathlib.Path("model.mps").write_text(
        "NAME m\nROWS\n N cost\n G need\nCOLUMNS\n x cost 1 need 1\nRHS\n RHS need 2\nENDATA\n", encoding="ascii"
    )
    names = {}
    for block in blocks:
        exec(compile(block, page.name, "exec"), names)
