"""Runs under the control of the caller."""

import math
import pickle

import pytest
from conftest import level

import bramah as br


def test_steps(tank):
    s = tank.stepper(k=2)
    assert s.time == 0 and s["h"] == 1
    s.step(0.5)
    assert s.time == 0.5 and s["h"] == pytest.approx(level(0.5), rel=1e-4)
    s.step(0.5, u=0)
    assert s["h"] == pytest.approx(level(0.5) * math.exp(-1), rel=1e-4)
    s.step(0.5)  # the input keeps its value
    assert s["h"] == pytest.approx(level(0.5) * math.exp(-2), rel=1e-4)
    s.step(0.5, {"u": 1.0})
    assert s.observe("u", "y") == {"u": 1.0, "y": s["y"]}
    assert s.step(0.1) is s


def test_a_controller(tank):
    """A controller that holds the level: u = 2 h_set + 10 (h_set - h), every millisecond."""
    s = tank.stepper()
    while s.time < 2:
        s.step(1e-3, u=2 * 0.8 + 10 * (0.8 - s["h"]))
    assert s["h"] == pytest.approx(0.8, abs=1e-3)


def test_values_and_reset(tank):
    s = tank.stepper(set={"k": "120 1/min"}, u=0)
    assert s.step(1.0)["h"] == pytest.approx(math.exp(-2), rel=1e-4)
    s.step(1.0, u=5)
    assert s.reset() is s and s.time == 0 and s["h"] == 1
    assert s.step(1.0)["h"] == pytest.approx(math.exp(-2), rel=1e-4)


def test_states_go_to_runs_and_back(tank):
    s = tank.stepper().step(1.0)
    result = tank.simulate(2.0, from_state=s.state)
    assert result["h"][-1] == pytest.approx(level(2), rel=1e-4)
    again = tank.stepper(from_state=result.state)
    assert again.time == 2 and again["h"] == pytest.approx(level(2), rel=1e-4)
    again.step(1.0)
    assert again["h"] == pytest.approx(level(3), rel=1e-4)
    assert again.reset().time == 2


def test_a_model_that_ends_its_run():
    text = 'model M\n Real x(start = 1, fixed = true);\nequation\n der(x) = -1;\n when x < 0.5 then\n terminate("low");\n end when;\nend M;'
    s = br.load(text).stepper()
    assert s.terminated is None
    s.step(1.0)
    assert s.terminated == "low" and s.time == pytest.approx(0.5, rel=1e-6)


def test_wrong_steps(tank):
    s = tank.stepper()
    for seconds, why in ((-1, ValueError), (float("nan"), ValueError), ("1", TypeError), (None, TypeError)):
        with pytest.raises(why):
            s.step(seconds)
    with pytest.raises(br.Error, match="did you mean `u`"):
        s.step(0.1, uu=1)
    with pytest.raises(br.Error) as wrong:
        s.step(0.1, k=1)
    assert wrong.value.code == "E903"
    with pytest.raises(TypeError, match="'u'"):
        s.step(0.1, u="1 m/s")
    with pytest.raises(ValueError, match="'u'"):
        s.step(0.1, u=float("nan"))
    with pytest.raises(br.Error, match="did you mean"):
        s["hh"]
    with pytest.raises(TypeError):
        s[0]
    assert s.time == 0 and s.step(0.5)["h"] == pytest.approx(level(0.5), rel=1e-4)  # none of them did harm


def test_pickle_says_why_not(tank):
    with pytest.raises(TypeError, match="stepper cannot be pickled"):
        pickle.dumps(tank.stepper())


def test_repr(tank):
    assert repr(tank.stepper().step(0.5)) == "<bramah.Stepper Tank at 0.5 s>"
