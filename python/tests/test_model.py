"""Models: values, runs, linear models, sensitivities, sweeps."""

import copy
import math
import pickle
import statistics
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import DECAY, TANK, level

import bramah as br


def test_from_text_file_folder_and_shipped(tmp_path):
    file = tmp_path / "Decay.mo"
    file.write_text(DECAY)
    (tmp_path / "Lib").mkdir()
    (tmp_path / "Lib" / "package.mo").write_text("package Lib\nend Lib;")
    (tmp_path / "Lib" / "Decay.mo").write_text("within Lib;\n" + DECAY)
    for model in (br.load(DECAY), br.load(file), br.load(str(file)), br.load(tmp_path / "Lib", "Lib.Decay")):
        assert model.simulate(1.0)["x"][-1] == pytest.approx(math.exp(-2), rel=1e-4)
    assert br.load("ServoPump.DeadZone").name == "ServoPump.DeadZone"


def test_a_library_beside(tmp_path):
    (tmp_path / "Lib").mkdir()
    (tmp_path / "Lib" / "package.mo").write_text("package Lib\nend Lib;")
    (tmp_path / "Lib" / "Decay.mo").write_text("within Lib;\n" + DECAY)
    text = "model M\n  Lib.Decay d(k = 3);\nend M;"
    for libraries in ([tmp_path], str(tmp_path)):
        model = br.load(text, libraries=libraries)
        assert model.simulate(1.0)["d.x"][-1] == pytest.approx(math.exp(-3), rel=1e-4)
        assert pickle.loads(pickle.dumps(model)).parameters["d.k"].value == 3


def test_one_of_several_models():
    text = "model A\n Real x = 1;\nend A;\nmodel B\n Real x = 2;\nend B;"
    assert br.load(text, "B").name == "B"
    with pytest.raises(br.Error, match="`A`, `B`"):
        br.load(text)


def test_load_with_values():
    model = br.load(TANK, set={"k": 5, "n": 3, "on": False, "a": [3, 4], "p": "2 bar"})
    values = {name: p.value for name, p in model.parameters.items()}
    assert values == {"k": 5, "n": 3, "on": 0, "a[1]": 3, "a[2]": 4, "p": 2e5}


def test_parameters_inputs_variables(tank):
    k = tank.parameters["k"]
    assert (k.value, k.unit, k.min, k.max, k.description, k.kind) == (2, "1/s", 0, 100, "rate", "Real")
    assert tank.parameters["p"].display_unit == "bar"
    assert tank.parameters["on"].kind == "Boolean" and tank.parameters["n"].kind == "Integer"
    assert list(tank.inputs) == ["u"] and tank.inputs["u"].unit == "m/s"
    assert set(tank.variables) == {"u", "h", "high", "y"}
    assert tank.variables["h"].description == "level"
    with pytest.raises(KeyError, match="did you mean 'k'"):
        tank.parameters["kk"]


def test_runs_as_the_model_says(press):
    assert (press.start_time, press.stop_time) == (0, 1)
    result = press.simulate()
    assert result.end == "reached" and result.time[-1] == 1
    # the pump's 6 l/min go over the relief valve in the end
    assert result["relief.port_a.q"][-1] == pytest.approx(1e-4, rel=1e-6)


def test_values_with_units(press):
    result = press.simulate(stop=1.0, **{"pump.q": "12 l/min"}, outputs=["relief.port_a.q", "volume.p"])
    assert set(result) == {"volume.p", "relief.port_a.q"}
    assert result["relief.port_a.q"][-1] == pytest.approx(2e-4, rel=1e-6)
    assert press.with_values({"relief.p_set": "120 bar"}).parameters["relief.p_set"].value == pytest.approx(120e5)
    assert press.parameters["relief.p_set"].value == 150e5  # the model itself never changes


@pytest.mark.parametrize("k", [3, 3.0, "3 1/s", "180 1/min", np.int64(3), np.float32(3), np.array(3.0)])
def test_kinds_of_values(tank, k):
    assert tank.simulate(1.0, k=k)["h"][-1] == pytest.approx(level(1, k=3), rel=1e-4)
    assert tank.simulate(1.0, set={"k": k})["h"][-1] == pytest.approx(level(1, k=3), rel=1e-4)


def test_booleans_integers_arrays(tank):
    for off in (False, np.bool_(False), "false"):
        assert tank.simulate(1.0, on=off)["y"][-1] == 0
    result = tank.simulate(1.0, n=5)
    assert result["y"][-1] == pytest.approx(5 * result["h"][-1])
    for given in ([3, 4], (3, 4), np.array([3, 4]), np.array([3.0, 4.0]), "{3, 4}"):
        assert tank.with_values(a=given).parameters["a[2]"].value == 4
    assert tank.with_values({"a[2]": 7}).parameters["a[2]"].value == 7


def test_values_stay_through_later_ones(tank):
    """`n` and `a` need a new compilation, which must keep `k`."""
    model = tank.with_values(k=5).with_values(n=3).with_values(p="2 bar").with_values(a=[3, 4])
    assert {n: model.parameters[n].value for n in ("k", "n", "p", "a[2]")} == {"k": 5, "n": 3, "p": 2e5, "a[2]": 4}
    assert tank.with_values(k=5).simulate(1.0, n=3)["h"][-1] == pytest.approx(level(1, k=5), rel=1e-4)


def test_start_stop_interval_tolerance(tank):
    result = tank.simulate(2.0, start=1.0, interval=0.25, event_rows=False)
    assert result.time.tolist() == [1, 1.25, 1.5, 1.75, 2]
    fine, coarse = tank.simulate(1.0, tolerance=1e-10), tank.simulate(1.0, tolerance=1e-3)
    exact = level(1)
    assert abs(fine["h"][-1] - exact) < 1e-8
    assert abs(fine["h"][-1] - exact) < abs(coarse["h"][-1] - exact)
    assert len(tank.simulate(1.0, event_rows=False).time) == 501
    assert len(tank.simulate(0.0).time) == 1


def test_outputs(tank):
    assert list(tank.simulate(1.0, outputs="h")) == ["h"]
    assert list(tank.simulate(1.0, outputs=["h*"])) == ["h", "high"]
    assert list(tank.simulate(1.0, outputs=["h", "h"])) == ["h"]
    assert (tank.simulate(1.0, outputs=["k"], k=3)["k"] == 3).all()


def test_inputs(tank):
    assert tank.simulate(1.0, inputs={"u": 3})["h"][-1] == pytest.approx(level(1, u=3), rel=1e-4)
    assert tank.simulate(1.0, u="180 m/min")["h"][-1] == pytest.approx(level(1, u=3), rel=1e-4)
    half = level(0.5)
    held = tank.simulate(1.0, inputs={"u": ([0, 0.5], [1, 0])})
    assert held["h"][-1] == pytest.approx(half * math.exp(-1), rel=1e-4)
    held = tank.simulate(1.0, inputs={"u": (np.array([0, 0.5]), np.array([1, 0]), "hold")})
    assert held["h"][-1] == pytest.approx(half * math.exp(-1), rel=1e-4)
    # h' = t - 2 h, h(0) = 1: h = t/2 - 1/4 + 5/4 exp(-2 t)
    ramp = tank.simulate(1.0, inputs={"u": ([0, 1], [0, 1], "linear")})
    assert ramp["h"][-1] == pytest.approx(0.25 + 1.25 * math.exp(-2), rel=1e-4)


def test_from_state(tank):
    first = tank.simulate(1.0)
    second = tank.simulate(2.0, from_state=first.state)
    assert (second.time[0], second.time[-1]) == (1, 2)
    assert len(second.time) == 501
    assert second["h"][-1] == pytest.approx(level(2), rel=1e-4)
    assert first.state.time == 1
    assert dict(first.state.values())["h"] == pytest.approx(level(1), rel=1e-4)


def test_progress(long, tank):
    seen = []
    long.simulate(200.0, progress=seen.append)
    assert len(seen) > 3 and seen == sorted(seen) and 0 < seen[-1] <= 200
    pytest.importorskip("tqdm")
    assert tank.simulate(1.0, progress=True).end == "reached"


def test_steady(tank):
    rest = tank.steady(k=4)
    assert rest["h"] == pytest.approx(0.25, rel=1e-6)
    assert rest["y"] == pytest.approx(0.5, rel=1e-6)
    with pytest.raises(KeyError, match="did you mean"):
        rest["hh"]


def test_linearize(tank):
    linear = tank.linearize(k=3, inputs=["u", "k"], outputs=["y", "h"])
    assert linear.A == pytest.approx(np.array([[-3.0]]))
    assert linear.B == pytest.approx(np.array([[1.0, -1.0]]))  # d(u - k h)/dk = -h = -1 at the start
    assert linear.C == pytest.approx(np.array([[2.0], [1.0]]))
    assert linear.D.shape == (2, 2) and not linear.D.any()
    assert linear.poles == pytest.approx([-3])
    assert (list(linear.states), list(linear.inputs), list(linear.outputs)) == (["h"], ["u", "k"], ["y", "h"])
    assert linear.units["k"] == "1/s" and linear.states["h"] == 1
    rest = tank.linearize(steady=True, inputs="k")
    assert rest.B == pytest.approx(np.array([[-0.5]]), rel=1e-5)
    later = tank.linearize(at=0.5, inputs="k")
    assert later.time == 0.5 and later.B == pytest.approx(np.array([[-level(0.5)]]), rel=1e-4)


def test_poles_of_a_slide():
    from conftest import SLIDE

    linear = br.load(SLIDE, "Slide.Nominal").linearize()
    # 10 s^2 + 30 s + 400 = 0
    root = complex(-1.5, math.sqrt(400 / 10 - 1.5**2))
    found = sorted(linear.poles, key=lambda p: p.imag)
    assert np.allclose(found, [root.conjugate(), root], rtol=1e-6)


def test_sensitivity(decay):
    moved = decay.sensitivity(["k"], 1.0, k=3)
    t = moved["time"]
    assert t.shape == moved["k"]["x"].shape
    assert np.allclose(moved["k"]["x"], -t * np.exp(-3 * t), atol=1e-4)
    assert set(decay.sensitivity("k", 1.0, outputs="x")["k"]) == {"x"}


def test_sweep(decay):
    pandas = pytest.importorskip("pandas")
    frame = decay.sweep({"k": [1, 2, 3]}, 1.0, reduce=lambda r: r["x"][-1])
    assert isinstance(frame, pandas.DataFrame)
    assert frame["k"].tolist() == [1, 2, 3]
    assert np.allclose(frame["value"], np.exp([-1, -2, -3]), rtol=1e-4)
    assert frame.attrs["end"] == "reached"


def test_sweep_over_a_grid(tank):
    frame = tank.sweep({"k": [1, 2], "u": np.array([0.0, 1.0])}, 1.0, reduce=lambda r: {"end": r["h"][-1], "n": len(r)})
    assert len(frame) == 4
    expected = [level(1, k=k, u=u) for k in (1, 2) for u in (0, 1)]
    assert np.allclose(frame["end"], expected, rtol=1e-4)


def test_sweep_keeps_results_and_errors(tank):
    seen = []
    frame = tank.sweep({"k": [1, -1, "120 1/min"]}, 1.0, progress=lambda done, of: seen.append((done, of)))
    assert isinstance(frame["result"][0], br.Result)
    assert frame["result"][2]["h"][-1] == pytest.approx(level(1, k=2), rel=1e-4)
    assert isinstance(frame["error"][1], br.Error) and frame["error"][1].code == "E215"
    assert seen == [(1, 3), (2, 3), (3, 3)]


def test_sweep_over_a_list_of_points(tank):
    frame = tank.sweep([{"k": 1}, {"k": 2, "u": 0}], 1.0, reduce=lambda r: r["h"][-1])
    assert np.allclose(frame["value"], [level(1, k=1), level(1, k=2, u=0)], rtol=1e-4)
    assert len(tank.sweep([], 1.0)) == 0
    assert len(tank.sweep({"k": 3}, 1.0)) == 1


def test_pickle_and_copy(tank):
    for model in (pickle.loads(pickle.dumps(tank)), copy.copy(tank), copy.deepcopy(tank)):
        assert model.name == "Tank" and model.simulate(1.0)["h"][-1] == tank.simulate(1.0)["h"][-1]


def test_pickle_keeps_values(tank):
    other = pickle.loads(pickle.dumps(tank.with_values(k=5, n=3)))
    assert (other.parameters["k"].value, other.parameters["n"].value) == (5, 3)
    other = pickle.loads(pickle.dumps(tank.with_values(k=0.1 + 0.2)))
    assert other.parameters["k"].value == 0.1 + 0.2
    shipped = br.load("ServoPump.DeadZone").with_values({"pump.V": "12 ml"})
    assert pickle.loads(pickle.dumps(shipped)).parameters["pump.V"].value == pytest.approx(
        shipped.parameters["pump.V"].value
    )


def test_calls_cost_less_than_a_millisecond(decay):
    took = []
    for i in range(200):
        begun = time.perf_counter()
        decay.simulate(1.0, k=1 + i / 1000)
        took.append(time.perf_counter() - begun)
    assert statistics.median(took) < 1e-3


def test_help_reads_well():
    for thing in (br.load, br.Model.simulate, br.Model.sweep, br.gap, br.identify):
        assert "Args:" in thing.__doc__, thing
    public = [br.Model, br.Result, br.Stepper, br.Study, br.Verdict, br.Identified, br.Picture]
    for cls in public:
        for name, member in vars(cls).items():
            if not name.startswith("_"):
                assert (member.__doc__ or "").strip(), f"{cls.__name__}.{name} has no docstring"
    assert (Path(br.__file__).parent / "py.typed").exists()


def test_reprs(tank):
    assert repr(tank) == "<bramah.Model Tank: 6 parameters, 1 inputs>"
    assert "1 states" in repr(tank.linearize())
