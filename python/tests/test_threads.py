"""Threads, processes, Ctrl-C."""

import math
import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import DECAY, LONG, level

import bramah as br

HERE = Path(__file__).parent  # not where the source of the package lies: it has no core
posix = pytest.mark.skipif(os.name != "posix", reason="signals and fork")


def run(code, timeout=60):
    """A Python process of its own, in which `LONG` and `DECAY` are models' texts."""
    head = f"LONG = {LONG!r}\nDECAY = {DECAY!r}\nimport bramah as br, os, signal, sys, threading, time\n"
    head += "def soon(seconds):\n    threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
    text = head + textwrap.dedent(code)
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=timeout, check=False, cwd=HERE)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="one core")
def test_threads_run_at_the_same_time(long):
    def work(_=None):
        return long.simulate(40000.0, interval=100.0)["x"][-1]

    def clock(call):
        begun, used = time.perf_counter(), time.process_time()
        call()
        return time.perf_counter() - begun, time.process_time() - used

    work()
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(work, range(2)))
        seen = []
        for _ in range(5):
            one, _ = clock(work)
            two, used = clock(lambda: list(pool.map(work, range(2))))
            seen.append((two / one, used / two))
            # where others use the cores too: more than one core at work, which runs that take turns never have
            if two < 1.6 * one or used > 1.2 * two:
                return
    if os.getloadavg()[0] > os.cpu_count():
        pytest.skip("others use the cores")
    raise AssertionError(f"times as long as one thread, and cores at work: {seen}")


def test_python_goes_on_during_a_run(long):
    stop, ticks = threading.Event(), []

    def tick():
        while not stop.wait(0.005):
            ticks.append(time.perf_counter())

    thread = threading.Thread(target=tick)
    thread.start()
    begun = time.perf_counter()
    long.simulate(20000.0, interval=100.0)
    during = [t for t in ticks if t > begun]
    stop.set()
    thread.join()
    assert len(during) >= 3


def test_one_model_in_many_threads(tank):
    def work(i):
        k = 1 + i / 10
        return tank.simulate(1.0, k=k)["h"][-1], level(1, k=k)

    with ThreadPoolExecutor(8) as pool:
        for found, exact in pool.map(work, range(100)):
            assert found == pytest.approx(exact, rel=1e-4)


def test_one_stepper_in_many_threads(tank):
    s = tank.stepper()

    def work(_):
        for _ in range(50):
            s.step(1e-3)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(work, range(4)))
    assert s.time == pytest.approx(0.2) and s["h"] == pytest.approx(level(0.2), rel=1e-4)


def test_compiled_in_threads():
    with ThreadPoolExecutor(4) as pool:
        models = list(pool.map(lambda _: br.load(DECAY), range(8)))
    assert {m.simulate(1.0)["x"][-1] for m in models} == {models[0].simulate(1.0)["x"][-1]}


@posix
def test_ctrl_c_keeps_what_is_there():
    status, out, err = run("""
        soon(0.5)
        begun = time.perf_counter()
        r = br.load(LONG).simulate(1e9, interval=1.0)
        print(r.end, time.perf_counter() - begun < 5, len(r.time) > 100, r.time[-1] == len(r.time) - 1, r.time[-1] < 1e9)
        more = br.load(LONG).simulate(r.state.time + 1, from_state=r.state)
        print(more.end)
    """)
    assert out.split() == ["interrupted", "True", "True", "True", "True", "reached"], err
    assert status == 0


@posix
def test_sigint_from_outside():
    code = f"import bramah as br\nm = br.load({LONG!r})\nprint('begins', flush=True)\nprint(m.simulate(1e9, interval=1.0).end)"
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, cwd=HERE)
    assert process.stdout.readline() == "begins\n"
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=30)
    assert out == "interrupted\n" and process.returncode == 0


@posix
def test_ctrl_c_in_a_sweep():
    pytest.importorskip("pandas")
    status, out, err = run("""
        import warnings
        warnings.simplefilter("ignore")
        m = br.load(LONG)
        soon(1.0)
        begun = time.perf_counter()
        frame = m.sweep({"mu": [4 + i / 100 for i in range(200)]}, 20000.0, interval=100.0)
        print(frame.attrs["end"], 0 < len(frame) < 200, time.perf_counter() - begun < 5)
    """)
    assert out.split() == ["interrupted", "True", "True"], err
    assert status == 0


@posix
def test_fork():
    """A child runs, and sweeps, also after its parent has."""
    status, out, err = run("""
        m = br.load(DECAY)
        m.simulate(1.0); m.sweep({"k": [1, 2, 3]}, 1.0)
        sys.stdout.flush()
        child = os.fork()
        if child == 0:
            x = m.simulate(1.0, k=3)["x"][-1]
            n = len(m.sweep({"k": [1, 2, 3]}, 1.0))
            other = br.load(DECAY).simulate(1.0, k=3)["x"][-1]
            os._exit(0 if abs(x - 0.049787) < 1e-4 and n == 3 and x == other else 1)
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    """)
    assert out.split() == ["0"] and status == 0, err


@posix
def test_fork_after_sensitivities():
    """The core's own threads are not there in a child; it must not wait for them."""
    status, out, err = run(
        """
        m = br.load(DECAY)
        m.sensitivity("k", 1.0)
        sys.stdout.flush()
        child = os.fork()
        if child == 0:
            m.sensitivity("k", 1.0)
            os._exit(0)
        for _ in range(100):
            pid, status = os.waitpid(child, os.WNOHANG)
            if pid:
                break
            time.sleep(0.1)
        else:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
        print("ends" if pid else "hangs")
    """
    )
    assert out.split() == ["ends"], err


def end_of(given):
    model, k = given
    return model.simulate(1.0, k=k)["x"][-1]


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
def test_processes(decay, method):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {method} here")
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context(method)) as pool:
        found = list(pool.map(end_of, [(decay, k) for k in (1, 2, 3)], timeout=60))
    assert np.allclose(found, np.exp([-1, -2, -3]), rtol=1e-4)


def test_joblib(decay):
    joblib = pytest.importorskip("joblib")
    results = joblib.Parallel(n_jobs=2)(joblib.delayed(decay.simulate)(1.0, k=k) for k in (1, 2, 3))
    assert [r["x"][-1] for r in results] == pytest.approx([math.exp(-k) for k in (1, 2, 3)], rel=1e-4)
    assert results[0].units == {"x": ""} and results[0].end == "reached"


def test_joblib_brings_errors_back(tank):
    joblib = pytest.importorskip("joblib")
    with pytest.raises(br.Error) as caught:
        joblib.Parallel(n_jobs=2)(joblib.delayed(tank.simulate)(1.0, k=k) for k in (1, -1))
    assert caught.value.code == "E215"


def test_installed_not_source():
    """Tests run against what is installed: the source has no core."""
    assert any(Path(br.__file__).parent.glob("_bramah*.so")) or any(Path(br.__file__).parent.glob("_bramah*.pyd"))
