"""Annotations and the stubs of the core."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import bramah as br
from bramah import _bramah

PACKAGE = Path(br.__file__).parent


def test_annotations_are_strict(tmp_path):
    pytest.importorskip("mypy")
    copy = tmp_path / "source" / "bramah"
    copy.mkdir(parents=True)
    for file in [*PACKAGE.glob("*.py"), *PACKAGE.glob("*.pyi")]:
        shutil.copy(file, copy)
    # whether other packages have stubs is not the question
    command = [sys.executable, "-m", "mypy", "--strict", "--disable-error-code=import-untyped", "--ignore-missing-imports"]
    command += ["--cache-dir", str(tmp_path / "cache"), str(copy)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stdout


def test_types_that_users_see(tmp_path):
    pytest.importorskip("mypy")
    (tmp_path / "use.py").write_text("""
import bramah as br

model = br.load("Press.mo")
result = model.simulate(1.0, outputs=["p"])
reveal_type(result["p"])
reveal_type(result.units)
reveal_type(model.parameters["k"].value)
reveal_type(model.stepper().step(0.1)["p"])
reveal_type(result.state)
model.simulate(stop="1")
""")
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), "use.py"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    said = done.stdout
    for kind in ("float64", "dict[str, str]", '"float"', "State"):
        assert kind in said, said
    assert 'use.py:11: error: Argument "stop"' in said, said


def test_stubs_name_what_the_core_has():
    text = (PACKAGE / "_bramah.pyi").read_text()
    for name, thing in vars(_bramah).items():
        if name.startswith("__") and name != "__version__":
            continue
        assert f"class {name}:" in text or f"def {name}(" in text or f"{name}: " in text, name
        if isinstance(thing, type):
            body = text.split(f"class {name}:")[1].split("\n@final")[0]
            for member in vars(thing):
                if not member.startswith("_"):
                    assert f"def {member}(" in body, f"{name}.{member}"
