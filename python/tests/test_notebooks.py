"""The notebooks run, each in less than a minute, and show pictures and reports."""

import time
from pathlib import Path

import pytest

pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
pytest.importorskip("pandas")

NOTEBOOKS = Path(__file__).parent.parent / "notebooks"


def shown(notebook):
    """All that cells show, by kind."""
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            yield from output.get("data", {}).items()


@pytest.mark.parametrize("name", sorted(p.name for p in NOTEBOOKS.glob("*.ipynb")))
def test_runs(name, tmp_path):
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(NOTEBOOKS / name, as_version=4)
    nbformat.validate(notebook)
    assert not any(cell.get("outputs") for cell in notebook.cells), "stored without outputs"
    begun = time.perf_counter()
    NotebookClient(notebook, timeout=60, resources={"metadata": {"path": str(tmp_path)}}).execute()
    assert time.perf_counter() - begun < 60
    kinds = [kind for kind, text in shown(notebook) if text]
    assert "text/html" in kinds, "a notebook shows its networks and reports"


def test_there_are_three():
    assert len(list(NOTEBOOKS.glob("*.ipynb"))) == 3
