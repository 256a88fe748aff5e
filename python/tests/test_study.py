"""Parameters and effects from data frames and from study files."""

import json
import os
import pickle
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import SLIDE, TANK

import bramah as br

pandas = pytest.importorskip("pandas")

STEP = 0.004


def recorded(model, seed, rows=1500, **values):
    """A recording of the slide under steps of force, with noise of its sensors."""
    noise = np.random.default_rng(seed)
    t = STEP * np.arange(rows)
    u = np.repeat(20 * noise.standard_normal(rows // 75), 75)
    r = model.simulate(t[-1], interval=STEP, event_rows=False, inputs={"u": (t, u)}, set=values)
    s = r["mass.s"] + 2e-4 * noise.standard_normal(rows)
    v = r["mass.v"] + 2e-3 * noise.standard_normal(rows)
    return pandas.DataFrame({"t": t, "u": u, "s": s, "v": v})


TIED = {
    "time": "t",
    "inputs": {"u": "u"},
    "signals": {"mass.s": ("s", "m"), "mass.v": ("v", "m/s")},
    "tolerances": {"mass.m": "2 %", "spring.c": "2 %", "spring.d": "10 %"},
}


@pytest.fixture(scope="module")
def nominal():
    return br.load(SLIDE, "Slide.Nominal")


@pytest.fixture(scope="module")
def frames():
    rig = br.load(SLIDE, "Slide.Rig")
    return recorded(rig, 1), recorded(rig, 2)


@pytest.fixture(scope="module")
def verdict(nominal, frames):
    return br.Study(nominal, [frames[0]], held=[frames[1]], **TIED).gap()


def study(nominal, frame, **more):
    return br.Study(nominal, [frame], **{**TIED, **more})


def test_gap_names_dry_friction(verdict):
    assert verdict.verdict == "effects"
    effect = verdict.effects[0]
    assert effect["effect"] == "Effects.TranslationalDryFriction"
    assert "dry friction" in str(verdict) and "mass.flange_a" in repr(verdict)
    assert "<iframe" in verdict._repr_html_() and "</html>" in verdict.html


def test_the_corrected_model_is_closer(verdict, nominal, frames):
    held = frames[1]
    fixed = br.load(verdict.corrected)
    errors = []
    for model, name in ((nominal, "mass.s"), (fixed, "plant.mass.s")):
        r = model.simulate(held.t.iloc[-1], interval=STEP, event_rows=False, inputs={"u": (held.t, held.u)})
        errors.append(np.std(r[name] - held.s))
    assert errors[1] < errors[0] / 5


def test_verdicts_are_saved_and_pickled(verdict, tmp_path):
    for name in ("v.html", "v.json", "v.mo"):
        verdict.save(tmp_path / name)
    assert json.loads((tmp_path / "v.json").read_text())["verdict"] == "effects"
    assert "Fixed" in (tmp_path / "v.mo").read_text()
    with pytest.raises(ValueError, match=".html, .json or .mo"):
        verdict.save(tmp_path / "v.pdf")
    assert pickle.loads(pickle.dumps(verdict)).effects == verdict.effects


def test_a_certain_effect_and_progress(nominal, frames):
    stages = []
    st = br.Study(nominal, frames[0], held=frames[1], **TIED)
    found = st.gap(effect="Effects.TranslationalViscousFriction@mass.flange_a", progress=stages.append)
    assert found.report and stages and all(isinstance(s, str) for s in stages)
    with pytest.raises(br.Error, match="Effects.Nothing"):
        st.gap(effect="Effects.Nothing@mass.flange_a")


def test_identify(nominal):
    """A machine that differs in three parameters, and in nothing else."""
    truth = {"mass.m": 10.4, "spring.c": 388.0, "spring.d": 33.0}
    frame = recorded(nominal, 3, **truth)
    wide = {name: "20 %" for name in truth}
    found = study(nominal, frame, tolerances=wide, signals={"mass.v": ("v", "m/s")}).identify()
    assert set(found.values) == set(truth)
    for name, value in truth.items():
        assert abs(found.values[name] - value) < max(4 * found.std[name], 0.01 * value), name
        assert 0 < found.std[name] < 0.05 * value
    table = found.to_pandas()
    assert list(table.columns) == ["value", "std", "low", "high", "unit"]
    assert (table.low < table.value).all() and (table.value < table.high).all()
    assert table.unit["mass.m"] == "kg"
    fitted = nominal.with_values(found.values)
    assert fitted.parameters["mass.m"].value == pytest.approx(found.values["mass.m"])
    assert "mass.m" in str(found) and "<pre>" in found._repr_html_()


def same(a, b):
    return a.values == pytest.approx(b.values, rel=1e-9)


def test_kinds_of_frames(nominal, frames):
    polars = pytest.importorskip("polars")
    frame = frames[0]
    expected = study(nominal, frame).identify()
    assert same(study(nominal, polars.from_pandas(frame)).identify(), expected)
    assert same(study(nominal, {c: frame[c].to_numpy() for c in frame}).identify(), expected)
    assert same(study(nominal, {c: frame[c].tolist() for c in frame}).identify(), expected)
    assert same(study(nominal, frame.set_index("t")).identify(), expected)
    assert same(study(nominal, frame.convert_dtypes()).identify(), expected)
    assert same(br.Study(nominal, frame, **TIED).identify(), expected)


def test_kinds_of_times(nominal, frames):
    frame = frames[0]
    expected = study(nominal, frame).identify()
    spans = frame.assign(t=pandas.to_timedelta(frame.t, unit="s"))
    dates = frame.assign(t=pandas.Timestamp("2026-11-26 08:00") + pandas.to_timedelta(frame.t, unit="s"))
    zoned = dates.assign(t=dates.t.dt.tz_localize("Europe/Berlin"))
    for other in (spans, dates, zoned):
        assert study(nominal, other).identify().values == pytest.approx(expected.values, rel=1e-6)
    unnamed = frame.drop(columns="t").set_index(frame.t.to_numpy())
    assert same(study(nominal, unnamed, time=None).identify(), expected)
    assert same(study(nominal, frame.rename(columns={"t": "time"}), time=None).identify(), expected)


def test_other_columns_do_no_harm(nominal, frames):
    frame = frames[0].assign(note="x", empty=np.nan, when=pandas.Timestamp("2026-11-26"))
    assert same(study(nominal, frame).identify(), study(nominal, frames[0]).identify())
    odd = frames[0].rename(columns={"s": 'a "quoted", name'})
    signals = {"mass.s": ('a "quoted", name', "m"), "mass.v": ("v", "m/s")}
    assert same(study(nominal, odd, signals=signals).identify(), study(nominal, frames[0]).identify())


def test_units_signs_and_dicts(nominal, frames):
    frame = frames[0]
    expected = study(nominal, frame).identify()
    other = frame.assign(s=-1000 * frame.s, u=frame.u / 1000)
    signals = {"mass.s": {"column": "s", "unit": "mm", "sign": -1}, "mass.v": ("v", "m/s")}
    found = study(nominal, other, signals=signals, inputs={"u": {"column": "u", "unit": "kN", "hold": True}}).identify()
    assert found.values == pytest.approx(expected.values, rel=1e-6)


def test_tolerances(nominal, frames):
    text = study(
        nominal, frames[0], tolerances={"mass.m": 0.2, "spring.c": "exact", "spring.d": {"sigma": "10 %", "min": 0.0}}
    ).text
    assert '"mass.m" = { sigma = 0.2 }' in text and '"spring.c" = "exact"' in text and "min = 0.0" in text
    assert set(study(nominal, frames[0], tolerances={"mass.m": 0.2, "spring.c": "exact"}).identify().values) == {"mass.m"}


def test_warnings_are_printed_with_the_result(nominal, frames):
    found = study(nominal, frames[0].assign(w=0.0), signals={**TIED["signals"], "spring.f": ("w", "N")}).identify()
    assert "W605" in found.messages and "`w`" in found.messages


def test_empty_cells(nominal, frames):
    third = frames[0].index % 3 > 0
    some = frames[0].assign(s=frames[0].s.where(third))
    assert study(nominal, some).identify().values.keys() == TIED["tolerances"].keys()
    none = frames[0].assign(s=frames[0].s.where(third).astype(object).where(third, None))
    assert same(study(nominal, none).identify(), study(nominal, some).identify())


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda f: f.assign(s=np.nan), "holds no number"),
        (lambda f: f.assign(u=f.u.where(f.index % 3 > 0)), "a cell of the input `u` is empty"),
        (lambda f: f.assign(t=f.t.where(f.index != 5, f.t[4])), "time does not grow"),
        (lambda f: f.assign(t=f.t.where(f.index != 5)), "a row has no time"),
        (lambda f: f.drop(index=range(300, 500)), "the recording has a gap"),
        (lambda f: f.iloc[::-1], "time runs backwards"),
        (lambda f: f.assign(s=np.inf), "not finite"),
        (lambda f: f.iloc[:0], "no rows"),
        (lambda f: f.iloc[:5], "too short|too few"),
    ],
)
def test_frames_that_cannot_be_used(nominal, frames, change, says):
    with pytest.raises(br.Error, match=says) as caught:
        study(nominal, change(frames[0])).identify()
    assert caught.value.code in ("E601", "E604")


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"signals": {"mass.ss": ("s", "m")}}, "did you mean `mass.s`"),
        ({"signals": {"mass.s": ("s", "bar")}}, "`bar`"),
        ({"signals": {"mass.s": {"columm": "s"}}}, "did you mean `column`"),
        ({"tolerances": {"mass.mm": "2 %"}}, "did you mean `mass.m`"),
        ({"tolerances": {"mass.m": "2 bar"}}, "kg"),
        ({"inputs": {"uu": "u"}}, "no input `uu`"),
    ],
)
def test_studies_that_are_wrong(nominal, frames, more, says):
    with pytest.raises(br.Error, match=says):
        study(nominal, frames[0], **more).identify()


def test_arguments_of_the_wrong_kind(nominal, frames):
    with pytest.raises(KeyError, match="no column 'tt'.*did you mean 't'"):
        study(nominal, frames[0], time="tt")
    with pytest.raises(KeyError, match="no column 's'.*'u', 'v'"):
        study(nominal, frames[0].drop(columns="s"))
    with pytest.raises(TypeError, match="'s' does not hold numbers"):
        study(nominal, frames[0].assign(s="x"))
    with pytest.raises(ValueError, match="unequal lengths"):
        study(nominal, {"t": [0, 1], "u": [1], "s": [1, 2], "v": [1, 2]})
    with pytest.raises(ValueError, match="no recording"):
        br.Study(nominal, [], **TIED)
    for frame in ("abc", np.zeros((3, 3))):
        with pytest.raises(TypeError, match="data frame"):
            study(nominal, frame)
    with pytest.raises(TypeError, match="from `load`"):
        br.Study("Slide.mo", frames[0], **TIED)
    with pytest.raises(TypeError, match="none of"):
        study(nominal, frames[0], tolerances={"mass.m": None})
    with pytest.raises(TypeError, match="none of"):
        study(nominal, frames[0], signals={"mass.s": 3})


def test_models_with_values_are_refused(nominal, frames):
    for model in (nominal.with_values({"mass.m": 11}), br.load(SLIDE, "Slide.Nominal", set={"mass.m": 11})):
        with pytest.raises(ValueError, match="values that were set"):
            study(model, frames[0])


def test_a_model_from_a_file(tmp_path, frames):
    (tmp_path / "Slide.mo").write_text(SLIDE)
    here = os.getcwd()
    os.chdir(tmp_path)
    try:
        st = study(br.load("Slide.mo", "Slide.Nominal"), frames[0])
    finally:
        os.chdir(here)
    assert set(st.identify().values) == set(TIED["tolerances"])


def test_study_files(tmp_path, frames):
    (tmp_path / "data").mkdir()
    (tmp_path / "Slide.mo").write_text(SLIDE)
    frames[0].to_csv(tmp_path / "data" / "train.csv", index=False)
    frames[1].to_csv(tmp_path / "data" / "held.csv", index=False)
    text = """
version = 1
model = "Slide.mo"
class = "Slide.Nominal"
[inputs]
u = { column = "u" }
[signals]
s = { variable = "mass.s", column = "s", unit = "m" }
[[recordings]]
file = "train.csv"
time = "t"
[[recordings]]
file = "held.csv"
role = "held"
time = "t"
[parameters]
"spring.c" = { sigma = "2 %" }
"""
    (tmp_path / "study.toml").write_text(text)
    found = br.identify(tmp_path / "study.toml", data=tmp_path / "data")
    assert set(found.values) == {"spring.c"}
    verdict = br.gap(str(tmp_path / "study.toml"), data=str(tmp_path / "data"))
    assert verdict.effects[0]["effect"] == "Effects.TranslationalDryFriction"
    for name in ("train.csv", "held.csv"):
        shutil.copy(tmp_path / "data" / name, tmp_path)
    assert same(br.identify(tmp_path / "study.toml"), found)


def test_files_that_are_not_there(tmp_path):
    for call in (br.gap, br.identify):
        with pytest.raises(br.Error) as caught:
            call(tmp_path / "nothing.toml")
        assert caught.value.code == "E902"
    (tmp_path / "study.toml").write_text("version = 1\nmodel = 'M.mo'\n")
    for call in (br.gap, br.identify):
        with pytest.raises(NotADirectoryError, match="nothing"):
            call(tmp_path / "study.toml", data=tmp_path / "nothing")
        with pytest.raises(br.Error):
            call(tmp_path / "study.toml")


def test_a_study_pickles(nominal, frames):
    st = pickle.loads(pickle.dumps(study(nominal, frames[0])))
    assert same(st.identify(), study(nominal, frames[0]).identify())
    assert repr(st) == "<bramah.Study: 1 recordings>"


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_ctrl_c_stops_a_diagnosis(tmp_path, frames):
    frames[0].to_csv(tmp_path / "a.csv", index=False)
    code = f"""
import os, signal
import pandas, bramah as br
from conftest import SLIDE
from test_study import TIED
frame = pandas.read_csv({str(tmp_path / "a.csv")!r})
st = br.Study(br.load(SLIDE, "Slide.Nominal"), [frame] * 4, held=[frame], **TIED)
def stage(text):
    os.kill(os.getpid(), signal.SIGINT)
try:
    st.gap(progress=stage)
    print("went on")
except KeyboardInterrupt:
    print("interrupted")
"""
    here = Path(__file__).parent
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False, cwd=here)
    assert done.stdout == "interrupted\n", done.stderr
