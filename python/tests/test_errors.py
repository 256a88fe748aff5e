"""What goes wrong, and that nothing is the worse for it."""

import pickle

import numpy as np
import pytest
from conftest import TANK, level

import bramah as br


def raises(call):
    with pytest.raises(br.Error) as caught:
        call()
    return caught.value


def test_code_place_help():
    error = raises(lambda: br.load("model M\n  Foo x;\nend M;"))
    assert (error.code, error.line) == ("E010", 2)
    assert error.file == "model.mo" and error.help
    assert "Foo x;" in str(error) and str(error).startswith("error[E010]")
    assert error.diagnostics[0]["severity"] == "error"


def test_pickles():
    error = raises(lambda: br.load("model M\n  Foo x;\nend M;"))
    other = pickle.loads(pickle.dumps(error))
    assert isinstance(other, br.Error) and str(other) == str(error) and other.code == error.code and other.line == 2


def test_files():
    assert raises(lambda: br.load("nothing.mo")).code == "E902"
    assert "ServoPump.DeadZone" in str(raises(lambda: br.load("ServoPump.DeadZon")))
    for source in (3, None):
        with pytest.raises(TypeError):
            br.load(source)


@pytest.mark.parametrize(
    ("call", "code", "meant"),
    [
        (lambda m: m.simulate(1.0, kk=3), "E012", "k"),
        (lambda m: m.with_values(kk=3), "E012", "k"),
        (lambda m: m.simulate(1.0, inputs={"uu": 1}), "E012", "u"),
        (lambda m: m.simulate(1.0, inputs={"uu": ([0, 1], [0, 1])}), "E023", "u"),
        (lambda m: m.simulate(1.0, outputs="hihg"), "E023", "high"),
        (lambda m: m.linearize(inputs="kk"), "E901", "k"),
        (lambda m: m.linearize(outputs="yy"), "E901", "y"),
        (lambda m: m.sensitivity("kk", 1.0), "E023", "k"),
        (lambda m: m.stepper(kk=1), "E012", "k"),
    ],
)
def test_unknown_names_come_with_the_nearest(tank, call, code, meant):
    error = raises(lambda: call(tank))
    assert error.code == code and f"did you mean `{meant}`?" in error.help and "did you mean" in str(error)


def test_names_with_dots(press):
    error = raises(lambda: press.simulate(set={"pump.qq": 1}))
    assert error.code == "E012" and "did you mean `pump.q`?" in error.help
    assert "did you mean `volume.p`?" in raises(lambda: press.simulate(outputs="volume.pp")).help


def test_a_variable_is_no_parameter(tank):
    assert "equations decide it" in str(raises(lambda: tank.simulate(1.0, h=1)))


def test_units_and_limits(tank):
    error = raises(lambda: tank.simulate(1.0, k="3 bar"))
    assert error.code == "E023" and "1/s" in str(error)
    assert raises(lambda: tank.simulate(1.0, k=-1)).code == "E215"
    assert raises(lambda: tank.simulate(1.0, inputs={"u": "3 bar"})).code == "E023"


def test_kinds_and_shapes(tank):
    for wrong in (None, 1j, object(), {}, ["1 bar"]):
        with pytest.raises(TypeError, match="'k'"):
            tank.simulate(1.0, k=wrong)
    for wrong in (float("nan"), np.inf):
        with pytest.raises(ValueError, match="'k'"):
            tank.simulate(1.0, k=wrong)
    with pytest.raises(ValueError, match="'a'"):
        tank.simulate(1.0, a=[1, [2, 3]])
    with pytest.raises(ValueError, match="'a'"):
        tank.simulate(1.0, a=[1, np.nan])
    assert raises(lambda: tank.simulate(1.0, k=[1, 2])).code == "E211"
    assert raises(lambda: tank.simulate(1.0, a=[1, 2, 3])).code == "E211"
    assert raises(lambda: tank.simulate(1.0, n=2.5)).code == "E210"
    for wrong in (3, "k", [("k", 3)]):
        with pytest.raises(TypeError):
            tank.simulate(1.0, set=wrong)
    with pytest.raises(TypeError, match="texts"):
        tank.simulate(1.0, set={3: 3})


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (([0, 1], [1]), "2 times and 1 values"),
        (([], []), "no samples"),
        (([1, 0], [1, 1]), "do not grow"),
        (([0, 1, 1], [1, 1, 1]), "do not grow"),
        (([0, np.nan], [1, 1]), "time that is not finite"),
        (([0, 1], [1, np.nan]), "value that is not finite"),
        (([[0, 1]], [[1, 1]]), "shape"),
        (([0, 1], [1, 1], "cubic"), "linear"),
        ([1, 2, 3, 4], "times, values"),
    ],
)
def test_wrong_samples(tank, given, says):
    with pytest.raises(ValueError, match=says):
        tank.simulate(1.0, inputs={"u": given})


def test_inputs_of_the_wrong_kind(tank):
    for given in (np.zeros(3), lambda t: 0.0, (["a"], ["b"])):
        with pytest.raises(TypeError, match="'u'"):
            tank.simulate(1.0, inputs={"u": given})
    with pytest.raises(TypeError, match="mapping"):
        tank.simulate(1.0, inputs=3)
    assert raises(lambda: tank.simulate(1.0, inputs={"k": ([0, 1], [1, 1])})).code == "E903"


@pytest.mark.parametrize(
    "times",
    [
        {"stop": -1},
        {"stop": float("nan")},
        {"stop": float("inf")},
        {"stop": 1, "start": 2},
        {"stop": 1, "interval": 0},
        {"stop": 1, "interval": -1},
        {"stop": 1, "tolerance": 0},
        {"stop": 1, "tolerance": 2},
        {"stop": 1, "tolerance": float("nan")},
    ],
)
def test_times_that_make_no_run(tank, times):
    with pytest.raises(ValueError):
        tank.simulate(**times)


def test_arguments_of_the_wrong_kind(tank):
    for wrong in ({"stop": "1"}, {"outputs": 3}, {"outputs": [3]}, {"progress": 3}, {"from_state": 3}):
        with pytest.raises(TypeError):
            tank.simulate(**{"stop": 1.0, **wrong})


def test_a_state_at_the_end(tank):
    state = tank.simulate(1.0).state
    with pytest.raises(ValueError, match="later stop"):
        tank.simulate(0.5, from_state=state)
    with pytest.raises(ValueError, match="later stop"):
        tank.simulate(from_state=state)


def test_columns_that_are_not_there(tank):
    result = tank.simulate(1.0)
    with pytest.raises(KeyError, match="did you mean 'high'"):
        result["hig"]
    with pytest.raises(KeyError):
        result[3]


def test_runs_that_do_not_reach_their_end():
    fails = br.load('model M\n Real x(start = 1, fixed = true);\nequation\n der(x) = -x;\n assert(x > 0.5, "low x");\nend M;')
    error = raises(lambda: fails.simulate(5.0))
    assert error.code == "E503" and "low x" in str(error)
    root = br.load("model M\n Real x(start = 1, fixed = true);\nequation\n der(x) = -sqrt(x - 0.5);\nend M;")
    assert raises(lambda: root.simulate(5.0)).code == "E504"


def test_an_error_of_the_caller_comes_through(long):
    def stop(_):
        raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        long.simulate(2000.0, progress=stop)


def test_a_model_after_an_error():
    model = br.load(TANK)
    before = model.simulate(1.0)["h"][-1]
    for wrong in ({"kk": 1}, {"k": -1}, {"k": "1 bar"}, {"h": 1}):
        raises(lambda: model.simulate(1.0, **wrong))
        assert model.simulate(1.0)["h"][-1] == before == pytest.approx(level(1), rel=1e-4)


def test_an_input_without_a_value_is_an_error():
    model = br.load("model M input Real u; Real x(start = 0, fixed = true); equation der(x) = u; end M;")
    with pytest.raises(br.Error) as said:
        model.simulate(1.0)
    assert said.value.code == "E106"
    assert model.simulate(1.0, inputs={"u": 2.0})["x"][-1] == pytest.approx(2.0)
