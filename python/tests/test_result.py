"""Results: arrays, frames, pictures, files."""

import copy
import pickle

import numpy as np
import pytest
from conftest import level

import bramah as br


@pytest.fixture(scope="module")
def result(tank):
    return tank.simulate(1.0)


def test_a_mapping_of_arrays(result):
    assert isinstance(result["h"], np.ndarray) and result["h"].dtype == np.float64
    assert result["h"].shape == result.time.shape == (len(result.time),)
    assert set(result) == {"u", "h", "high", "y"} and len(result) == 4
    assert "h" in result and "k" not in result and result.get("k") is None
    assert np.allclose(result["h"], [level(t) for t in result.time], rtol=1e-4)
    assert set(result["high"]) == {0, 1}
    assert result == result and result != copy.copy(result) and isinstance(hash(result), int)


def test_nothing_is_copied(result):
    column = result["h"]
    assert result["h"] is column and result.time is result.time
    assert not column.flags.owndata  # the memory is Rust's, and stays while the array does
    assert column.base is not None
    pandas = pytest.importorskip("pandas")
    assert isinstance(result.to_pandas(), pandas.DataFrame)


def test_arrays_outlive_the_result(tank):
    column = tank.simulate(1.0)["h"]
    other = [tank.simulate(1.0, k=9) for _ in range(20)]
    assert column[-1] == pytest.approx(level(1), rel=1e-4) and len(other) == 20


def test_units_and_descriptions(result, press):
    assert result.units == {"u": "m/s", "h": "m", "high": "", "y": "m"}
    assert result.descriptions["h"] == "level"
    pressure = press.simulate(outputs="volume.p")
    assert pressure.units == {"volume.p": "Pa"} and pressure.display_units == {"volume.p": "bar"}


def test_at_a_time(result):
    assert result.at(0.5)["h"] == pytest.approx(level(0.5), rel=1e-4)
    assert result.at(0.0)["high"] == 1 and result.at(0.9)["high"] == 0
    assert result.at(99)["h"] == result["h"][-1]
    with pytest.raises(TypeError, match="a number"):
        result.at("1")


def test_events_have_two_rows(result):
    twice = result.time[:-1][np.diff(result.time) == 0]
    # exp(-2 t)/2 + 1/2 = 0.7
    assert twice == pytest.approx([-np.log(0.4) / 2], rel=1e-4)


def test_to_pandas(result):
    pytest.importorskip("pandas")
    frame = result.to_pandas()
    assert frame.index.name == "time" and list(frame.columns) == list(result)
    assert (frame["h"].to_numpy() == result["h"]).all()
    assert frame.attrs["units"]["h"] == "m"


def test_to_polars(result):
    pytest.importorskip("polars")
    frame = result.to_polars()
    assert frame.columns == ["time", *result]
    assert (frame["h"].to_numpy() == result["h"]).all()


def test_to_xarray(result):
    pytest.importorskip("xarray")
    data = result.to_xarray()
    assert data.h.attrs == {"units": "m", "long_name": "level"} and data.time.attrs["units"] == "s"
    assert (data.h.values == result["h"]).all()


def test_to_csv(result, tmp_path):
    text = result.to_csv()
    assert text.startswith("time,u,h,high,y\n0,1,1,true,2\n")
    assert result.to_csv(units=True).startswith("time,u [m/s],h [m],high,y [m]\n")
    assert result.to_csv(tmp_path / "out.csv") is None
    assert (tmp_path / "out.csv").read_text() == text


def test_plot(result, tmp_path):
    picture = result.plot("h")
    assert picture.svg.startswith("<svg") and "</html>" in picture.html
    assert picture._repr_svg_() == picture.svg and "<iframe" in picture._repr_html_()
    picture.save(tmp_path / "p.svg")
    picture.save(tmp_path / "p.html")
    assert (tmp_path / "p.svg").read_text() == picture.svg
    assert (tmp_path / "p.html").read_text() == picture.html
    with pytest.raises(ValueError, match=".svg or .html"):
        picture.save(tmp_path / "p.png")
    assert "A title" in result.plot(["h", "y"], units="given", title="A title").svg
    with pytest.raises(ValueError, match="no variable"):
        result.plot("nothing")
    with pytest.raises(ValueError, match="engineering"):
        result.plot(units="SI")


def test_pictures_are_in_units_for_people(press, result):
    assert " in bar<" in press.simulate().plot("volume.p").svg
    assert " in mm<" in result.plot("h").svg
    assert " in m<" in result.plot("h", units="given").svg


def test_shown_in_notebooks(result, tank, press):
    assert "<iframe" in result._repr_html_()
    assert "<svg" in press._repr_html_() and "<svg" in press.network()
    table = tank.parameters._repr_html_()
    assert "<td" in table and "rate" in table
    assert "0.5" in tank.steady()._repr_html_()
    assert tank.sensitivity("k", 1.0)._repr_html_() is None  # shows as its text
    tank.simulate(1.0, outputs=["k"])._repr_html_()  # nothing moves: no error


def test_text_of_others_is_escaped():
    model = br.load('model M\n parameter Real a = 1 "<script>";\n Real x = a*time;\nend M;')
    assert "<script>" not in model.parameters._repr_html_()
    assert "<script>" not in model.simulate(1.0, outputs="x").plot("x", title="<script>")._repr_html_().split("srcdoc")[0]
    assert "<script>alert" not in model.simulate(1.0, outputs="x").plot("x", title="<script>alert(1)</script>").html


def test_ends(result):
    assert result.end == "reached" and result.ending is None and result.messages == ""
    low = br.load(
        'model M\n Real x(start = 1, fixed = true);\nequation\n der(x) = -x;\n when x < 0.5 then\n terminate("low");\n'
        " end when;\nend M;"
    ).simulate(5.0)
    assert (low.end, low.ending) == ("terminated", "low")
    assert low.time[-1] == pytest.approx(np.log(2), rel=1e-4)


def test_statistics(result):
    assert result.statistics["steps"] > 0 and result.statistics["events"] == 1 and result.statistics["states"] == 1


def test_pickle(result):
    other = pickle.loads(pickle.dumps(result))
    assert list(other) == list(result) and (other["h"] == result["h"]).all() and (other.time == result.time).all()
    assert other.units == result.units and other.end == "reached" and other.statistics == result.statistics
    assert repr(other) == repr(result)
    assert other.at(0.5) == result.at(0.5)
    assert (pickle.loads(pickle.dumps(other))["h"] == result["h"]).all()


def test_repr(result):
    assert repr(result) == "<bramah.Result Tank: 4 variables, 503 rows, reached 1 s>"
