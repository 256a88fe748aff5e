"""Models and recordings: parameters, and what a model lacks."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from . import _bramah, _given
from .model import Model
from .result import framed


def identify(
    study: str | os.PathLike[str] | Study,
    data: str | os.PathLike[str] | None = None,
    *,
    method: str = "auto",
    starts: int = 1,
    seed: int = 1,
) -> Identified:
    """Finds the parameters that a study lists from its recordings.

    Args:
        study: a study file (docs/study.md), or a `Study`.
        data: the folder of the recordings; that of the study where left out.
        method: "output" compares runs from the inputs alone with the signals, "inverse" the force that the measured motion
            needs with the measured one; "auto" takes the inverse model where forces or torques are measured.
        starts: search from so many places, the values of the model first, and keep the best end; `seed` draws them.

    Raises:
        Error: study, model or recordings are wrong (E601, E604, E902); the message says where and what to do.
    """
    files, path = _files(study)
    return Identified(*_bramah.identify(files, path, _folder(data), method, starts, seed))


def gap(
    study: str | os.PathLike[str] | Study,
    data: str | os.PathLike[str] | None = None,
    *,
    effect: str | None = None,
    budget: float | None = None,
    progress: bool | Callable[[str], None] = False,
) -> Verdict:
    """Diagnoses the gap between a model and recordings of its machine.

    Args:
        study: a study file (docs/study.md), or a `Study`.
        data: the folder of the recordings; that of the study where left out.
        effect: fit this effect alone and show it, even where the diagnosis refuses it: "Effects.SensorLag@p".
        budget: how long the search may take, s; where left out 60, or as long as 500 simulations of all recordings take. Effects for which the time does not last are named.
        progress: True prints the stages, or a function that gets each as a text.

    Raises:
        Error: study, model or recordings are wrong (E601, E604, E902); the message says where and what to do.
        ValueError: the budget is not a time above zero.
        KeyboardInterrupt: after Ctrl-C, once the stage that is running has ended.
    """
    if not callable(progress) and not isinstance(progress, bool):
        raise TypeError(f"progress is True, False or a function, not of type {type(progress).__name__}")
    files, path = _files(study)
    show = progress if callable(progress) else (_print if progress else None)
    return Verdict(*_bramah.diagnose(files, path, _folder(data), effect, budget, show))


def _print(stage: str) -> None:
    print(stage, flush=True)


def _folder(data: str | os.PathLike[str] | None) -> str | None:
    if data is None:
        return None
    folder = os.fspath(data)
    if not os.path.isdir(folder):
        raise NotADirectoryError(f"there is no folder {folder!r} of recordings")
    return folder


def _files(study: str | os.PathLike[str] | Study) -> tuple[list[tuple[str, str]], str]:
    return (study._files, study._path) if isinstance(study, Study) else ([], os.fspath(study))


class Identified:
    """Parameters found from recordings, by `identify`. As a text it reads as on the command line.

    Attributes:
        report: the numbers of `bramah identify`, as a dict.
        messages: warnings, or "".
    """

    def __init__(self, report: str, words: str, messages: str) -> None:
        self.report: dict[str, Any] = json.loads(report)
        self.messages = messages
        self._words = words

    @property
    def values(self) -> dict[str, float]:
        """The values found, in the parameters' units: `model.with_values(found.values)` is the fitted model."""
        return {name: p["value"] for name, p in self.report["parameters"].items()}

    @property
    def std(self) -> dict[str, float]:
        """One standard deviation of each, in its unit; NaN where the data say nothing."""
        return {n: np.nan if p["std"] is None else p["std"] for n, p in self.report["parameters"].items()}

    def to_pandas(self) -> Any:
        """A row for each parameter: value, std, interval (95 %), unit."""
        import pandas

        rows = {
            name: {"value": p["value"], "std": p["std"], "low": low, "high": high, "unit": p["unit"]}
            for name, p in self.report["parameters"].items()
            for low, high in [p["interval"] or (None, None)]
        }
        return pandas.DataFrame.from_dict(rows, orient="index")

    def __str__(self) -> str:
        return self._words

    def __repr__(self) -> str:
        return f"<bramah.Identified: {', '.join(self.values)}>"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self._words)}</pre>"


class Verdict:
    """What a diagnosis came to, by `gap`. As a text it reads as on the command line; a notebook shows its page.

    Attributes:
        report: the numbers of `bramah gap`, as a dict (docs/gap.md).
        html: the same as one page, which a notebook shows.
        corrected: the corrected model as Modelica text, class `Fixed`; `load(verdict.corrected)` runs it. None where
            it cannot be written.
        messages: warnings, or "".
    """

    def __init__(self, report: str, words: str, page: str, corrected: str | None, messages: str) -> None:
        self.report: dict[str, Any] = json.loads(report)
        self.html, self.corrected, self.messages = page, corrected, messages
        self._words = words

    @property
    def verdict(self) -> str:
        """"effects", "outside_library", "gap_open", "undecidable", "nothing_found" or "recording_error"."""
        return str(self.report["verdict"])

    @property
    def effects(self) -> list[dict[str, Any]]:
        """What the model lacks: effect, places, parameters, evidence; the surest first."""
        effects: list[dict[str, Any]] = self.report["effects"]
        return effects

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the page (.html), the numbers (.json) or the corrected model (.mo)."""
        path = os.fspath(path)
        if not path.endswith((".html", ".htm", ".json", ".mo")):
            raise ValueError(f"a verdict is written as .html, .json or .mo, not as {os.path.basename(path)!r}")
        if path.endswith(".json"):
            text = json.dumps(self.report, indent=2)
        elif path.endswith(".mo"):
            if self.corrected is None:
                raise ValueError("there is no corrected model")
            text = self.corrected
        else:
            text = self.html
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def __str__(self) -> str:
        return self._words

    def __repr__(self) -> str:
        named = ", ".join(f"{e['effect']} at {e['places'][0]['place']}" for e in self.effects)
        return f"<bramah.Verdict {self.verdict}{': ' + named if named else ''}>"

    def _repr_html_(self) -> str:
        return framed(self.html, 800)


class Study:
    """A model tied to recordings that are data frames.

    >>> study = br.Study(model, recordings=[run1, run2], held=[run3],
    ...                  inputs={"u": "u_valve"}, signals={"vol.p": ("p1", "bar"), "cyl.x": ("x", "mm")},
    ...                  tolerances={"shaft.J": "3 %", "pump.V": "exact"})
    >>> study.gap()

    Args:
        model: from `load`.
        recordings: pandas or polars frames, or mappings of columns: train recordings. Columns have the shape (rows,);
            cells of signals may be empty (NaN), cells of inputs may not. Columns without numbers are left out.
        held: recordings that only confirm.
        time: the time column (or the index of that name), in seconds, as spans of time or as dates; "time" or another
            usual name where left out. Time must grow, without gaps.
        signals: for each measured variable its column, or (column, unit), or a dict with the keys of docs/study.md
            (column, unit, sign, full_scale, accuracy).
        inputs: for each input of the model its column, (column, unit), or a dict (column, unit, hold, kind).
        tolerances: for each parameter one standard deviation: "3 %", "0.2 bar", a number in its unit; "exact"; or a
            dict (sigma, min, max).
        effects: dict with include, exclude, places, folder.

    Attributes:
        text: the study as TOML.

    Raises:
        KeyError: a recording has no such column.
        TypeError, ValueError: a column does not hold numbers, columns have unequal lengths, there is no recording.
    """

    def __init__(
        self,
        model: Model,
        recordings: Iterable[Any],
        *,
        held: Iterable[Any] = (),
        time: str | None = None,
        signals: Mapping[str, Any],
        inputs: Mapping[str, Any] | None = None,
        tolerances: Mapping[str, Any] | None = None,
        effects: Mapping[str, Any] | None = None,
    ) -> None:
        if not isinstance(model, Model):
            raise TypeError(f"a study takes a model from `load`, not a {type(model).__name__}")
        text, source, name, libraries, overrides = model._core.recipe()
        if libraries or overrides:
            raise ValueError("a study takes a model as its text has it: without libraries and values that were set")
        signals, inputs = _given.mapping("signals", signals), _given.mapping("inputs", inputs)
        tied = {k: _with_variable(k, v) for k, v in signals.items()}
        driven = {k: _entry(v, ("column", "unit")) for k, v in inputs.items()}
        columns = [str(e["column"]) for e in [*tied.values(), *driven.values()] if "column" in e]
        lines = ["version = 1"]
        self._files: list[tuple[str, str]] = []
        if text is not None:
            lines.append('model = "model.mo"')
            self._files.append(("model.mo", text))
        elif os.path.exists(source):
            lines.append(f"model = {_toml(os.path.abspath(source))}")
        lines.append(f"class = {_toml(model.name)}")
        lines += _table("inputs", driven) + _table("signals", tied)
        frames = [("train", f) for f in _list(recordings)] + [("held", f) for f in _list(held)]
        if not frames:
            raise ValueError("there is no recording")
        for number, (role, frame) in enumerate(frames, 1):
            lines += self._recording(f"recording_{number}.csv", role, frame, time, columns)
        known = _given.mapping("tolerances", tolerances)
        lines += _table("parameters", {k: _entry(v, ()) for k, v in known.items()})
        lines += ["", "[effects]"] if effects else []
        lines += [f"{key} = {_toml(value)}" for key, value in (effects or {}).items()]
        self.text = "\n".join(lines) + "\n"
        self._path = "study.toml"
        self._files.append((self._path, self.text))

    def _recording(self, name: str, role: str, frame: Any, time: str | None, needed: list[str]) -> list[str]:
        needed = needed if time is None else [time, *needed]
        columns = _given.frame_columns(frame, needed)
        for column in needed:
            if column not in columns:
                has = ", ".join(map(repr, columns))
                raise KeyError(f"a recording has no column {column!r}; it has {has}{_given.nearest(column, columns)}")
        # an empty cell where nothing was measured
        rows = (",".join("" if v != v else repr(v) for v in row) for row in zip(*columns.values()))
        head = ",".join('"' + name.replace('"', '""') + '"' for name in columns)
        self._files.append((name, "\n".join([head, *rows]) + "\n"))
        lines = ["", "[[recordings]]", f"file = {_toml(name)}", f"role = {_toml(role)}"]
        return lines + ([] if time is None else [f"time = {_toml(time)}"])

    def identify(self, *, method: str = "auto", starts: int = 1, seed: int = 1) -> Identified:
        """Finds the parameters that have tolerances or bounds: as `bramah.identify`."""
        return identify(self, method=method, starts=starts, seed=seed)

    def gap(self, *, effect: str | None = None, progress: bool | Callable[[str], None] = False) -> Verdict:
        """Diagnoses the gap between model and recordings: as `bramah.gap`."""
        return gap(self, effect=effect, progress=progress)

    def __repr__(self) -> str:
        return f"<bramah.Study: {self.text.count('[[recordings]]')} recordings>"


def _list(given: Iterable[Any]) -> list[Any]:
    one = isinstance(given, Mapping) or hasattr(given, "columns")
    return [given] if one else list(given)


def _with_variable(variable: str, entry: Any) -> dict[str, Any]:
    return {"variable": variable, **_entry(entry, ("column", "unit"))}


def _entry(entry: Any, keys: tuple[str, ...]) -> Any:
    """What the study says of a signal or an input (with keys for short forms), or of a parameter."""
    if isinstance(entry, str):
        return {keys[0]: entry} if keys else ("exact" if entry == "exact" else {"sigma": entry})
    if not keys and isinstance(entry, (int, float, np.integer, np.floating)) and not isinstance(entry, bool):
        return {"sigma": entry}
    if keys and isinstance(entry, (tuple, list)) and 1 <= len(entry) <= len(keys):
        return dict(zip(keys, entry))
    if isinstance(entry, Mapping):
        return dict(entry)
    forms = "a column, (column, unit) or a dict" if keys else '"3 %", "0.2 bar", a number, "exact" or a dict'
    raise TypeError(f"{entry!r} is none of {forms}")


def _table(name: str, entries: Mapping[str, Any]) -> list[str]:
    if not entries:
        return []
    return ["", f"[{name}]", *(f"{_toml(key)} = {_toml(value)}" for key, value in entries.items())]


def _toml(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_toml(v)}" for key, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, (int, float, np.integer, np.floating)):
        return repr(value.item() if hasattr(value, "item") else value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    raise TypeError(f"a study cannot hold a {type(value).__name__}")
