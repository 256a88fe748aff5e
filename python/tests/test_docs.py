"""The Python blocks of the pages run, in order."""

import re
from pathlib import Path

import pytest

pytest.importorskip("pandas")

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", ROOT.parent / "docs" / "python.md"]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_blocks_run(page, tmp_path, monkeypatch):
    if not page.exists():
        pytest.skip(f"{page.name} is not here")
    monkeypatch.chdir(tmp_path)
    text = page.read_text(encoding="utf-8")
    blocks = list(re.finditer(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL))
    assert blocks
    names = {"__name__": "page"}
    for block in blocks:
        line = text[: block.start(1)].count("\n")
        exec(compile("\n" * line + block.group(1), str(page), "exec"), names)


def test_the_docstring_of_the_package():
    import bramah as br

    result = br.load("ServoPump.DeadZone").simulate(outputs=["N", "p_A"])
    assert result["p_A"][-1] > 2e7 and result.units["p_A"] == "Pa"
