#!/usr/bin/env python3
"""Bramah beside what one would take instead: the same problems, in turn, at equal error.

usage: compare.py BRAMAH [--full] [--out FOLDER]

Peers that are not installed are named, with how to get them. Writes results.md and one SVG a problem into FOLDER
(target/bench). Times are medians over interleaved runs, each in a process of its own; errors are the largest of all
values at the end, each relative to its reference of tests/stiff/references.toml."""
import argparse, datetime, glob, importlib, json, math, os, platform, shutil, statistics, subprocess, sys, tempfile, time

try:
    import tomllib
except ImportError:
    sys.exit('error: the benches need Python 3.11 or newer\nhelp: name one with PYTHON=...')

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(HERE)
WORK_PRECISION = ['Robertson', 'HiRes', 'VanDerPol']
NAMES = {'Robertson': ['y_1', 'y_2', 'y_3'], 'HiRes': [f'y[{i}]' for i in range(1, 9)], 'VanDerPol': ['y_1', 'y_2']}
# --- peers ------------------------------------------------------------------------------------------------------------

def build_c(folder):
    """The C programs on SUNDIALS at -O3, from the source that sundials-sys carries; None where they cannot be built."""
    sources = sorted(glob.glob(os.path.expanduser('~/.cargo/registry/src/*/sundials-sys-*/vendor')))
    if not sources or not shutil.which('cc') or not shutil.which('cmake'):
        return None
    os.makedirs(folder, exist_ok=True)
    inst = os.path.join(folder, 'inst')
    with open(os.path.join(folder, 'build.log'), 'w') as log:
        if not glob.glob(inst + '/lib*/libsundials_idas.a'):
            off = ['ARKODE', 'CVODE', 'CVODES', 'IDA', 'KINSOL', 'TESTING', 'SHARED_LIBS']
            options = [f'-DBUILD_{o}=OFF' for o in off] + ['-DBUILD_IDAS=ON', '-DEXAMPLES_ENABLE_C=OFF', '-DEXAMPLES_INSTALL=OFF']
            flags = '-DCMAKE_C_FLAGS_RELEASE=-O3 -march=native -DNDEBUG'
            make = ['cmake', '-S', sources[-1], '-B', folder + '/build', '-DCMAKE_BUILD_TYPE=Release', flags, *options,
                    '-DCMAKE_INSTALL_PREFIX=' + inst]
            for command in (make, ['cmake', '--build', folder + '/build', '--target', 'install', '-j2']):
                if subprocess.run(command, stdout=log, stderr=log).returncode:
                    return None
        lib = os.path.dirname(glob.glob(inst + '/lib*/libsundials_idas.a')[0])
        names = ['idas', 'nvecserial', 'sunmatrixdense', 'sunlinsoldense', 'sunmatrixband', 'sunlinsolband', 'sunnonlinsolnewton', 'core']
        link = [f'{lib}/libsundials_{n}.a' for n in names]
        for program in ('stiff_ida', 'stiff_set'):
            command = ['cc', '-O3', '-march=native', f'-I{inst}/include', f'{HERE}/peers/{program}.c', '-o',
                       os.path.join(folder, program), *link, '-lm']
            if subprocess.run(command, stdout=log, stderr=log).returncode:
                return None
    return os.path.join(folder, 'stiff_ida')

def bramah_run(binary, model, tolerance, end, names, extra=()):
    with tempfile.TemporaryDirectory() as d:
        out, stats = d + '/o.csv', d + '/s.json'
        command = [binary, 'simulate', model, '--relative-tolerance', repr(tolerance), '--stop-time', repr(end),
                   '--output-interval', repr(end), '--output-file', out, '--statistics', stats, *extra]
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode:
            return None
        s = json.load(open(stats))
        lines = open(out).read().splitlines()
        row = dict(zip(split(lines[0]), split(lines[-1])))
        return s, [float(row[n] or 'nan') for n in names]

def split(line):
    import csv
    return next(csv.reader([line]))

def c_run(program, model, tolerance, end, names):
    run = subprocess.run([program, model, repr(tolerance), '1'], capture_output=True, text=True)
    if run.returncode:
        return None
    r = json.loads(run.stdout)
    return {'solve_s': r['solve_s'], 'steps': r['steps']}, r['y']

def scipy_problem(name):
    import numpy as np
    if name == 'Robertson':
        f = lambda t, y: (a := -0.04*y[0] + 1e4*y[1]*y[2], -a - 3e7*y[1]**2, 3e7*y[1]**2)
        j = lambda t, y: [[-0.04, 1e4*y[2], 1e4*y[1]], [0.04, -1e4*y[2] - 6e7*y[1], -1e4*y[1]], [0, 6e7*y[1], 0]]
        return f, j, [1, 0, 0], [1, 1e-6, 1]
    if name == 'VanDerPol':
        f = lambda t, y: (y[1], ((1 - y[0]**2)*y[1] - y[0])*1e6)
        j = lambda t, y: [[0, 1], [(-2*y[0]*y[1] - 1)*1e6, (1 - y[0]**2)*1e6]]
        return f, j, [2, 0], [1, 1]
    A = np.zeros((8, 8))
    for i, k, v in [(0,0,-1.71),(0,1,.43),(0,2,8.32),(1,0,1.71),(1,1,-8.75),(2,2,-10.03),(2,3,.43),(2,4,.035),(3,1,8.32),(3,2,1.71),
                    (3,3,-1.12),(4,4,-1.745),(4,5,.43),(4,6,.43),(5,3,.69),(5,4,1.71),(5,5,-.43),(5,6,.69),(6,6,-1.81),(7,6,1.81)]:
        A[i, k] = v
    s = np.array([0, 0, 0, 0, 0, -1, 1, -1.0])
    c = np.array([.0007] + [0]*7)
    f = lambda t, y: A @ y + c + 280*y[5]*y[7]*s
    def j(t, y):
        J = A.copy()
        J[:, 5] += 280*y[7]*s
        J[:, 7] += 280*y[5]*s
        return J
    return f, j, [1, 0, 0, 0, 0, 0, 0, .0057], [1e-3, 1e-4, 1e-4, 1e-3, 1e-3, 1e-2, 1e-3, 1e-3]

def scipy_run(method):
    def run(model, tolerance, end):
        from scipy.integrate import solve_ivp
        f, j, y0, size = scipy_problem(model)
        begun = time.perf_counter()
        s = solve_ivp(f, (0, end), y0, method=method, rtol=tolerance, atol=[tolerance*x for x in size], jac=j)
        return ({'solve_s': time.perf_counter() - begun, 'steps': len(s.t) - 1}, list(s.y[:, -1])) if s.success else None
    return run

def rumoca_run():
    """Reads the same model files; one absolute tolerance for all, that of the smallest unknown."""
    import rumoca
    session, models = rumoca.Session(), {}
    def run(model, tolerance, end):
        if model not in models:
            models[model] = session.load(f'{ROOT}/models/stiff/{model}.mo')
        config = rumoca.SimConfig(solver='bdf', rtol=tolerance, atol=tolerance*min(scipy_sizes(model)))
        begun = time.perf_counter()
        try:
            r = models[model].simulate(end, dt=end, config=config)
        except rumoca.RumocaError:
            return None
        return {'solve_s': time.perf_counter() - begun, 'steps': ''}, [float(r[n][-1]) for n in NAMES[model]]
    return run

def casadi_run():
    """IDAS with derivatives by CasADi, unknowns scaled so that one absolute tolerance serves; making it is not counted."""
    import casadi
    made = {}
    def run(model, tolerance, end):
        _, _, y0, size = scipy_problem(model)
        if (model, tolerance) not in made:
            x = casadi.SX.sym('x', len(y0))
            rate = symbolic(model)([x[i]*size[i] for i in range(len(y0))])
            dae = {'x': x, 'ode': casadi.vertcat(*(r/s for r, s in zip(rate, size)))}
            options = {'reltol': tolerance, 'abstol': tolerance, 'max_num_steps': 10**6}
            made[model, tolerance] = casadi.integrator('F', 'idas', dae, 0, end, options)
        integrator = made[model, tolerance]
        begun = time.perf_counter()
        x = integrator(x0=[a/s for a, s in zip(y0, size)])['xf']
        took = time.perf_counter() - begun
        return {'solve_s': took, 'steps': integrator.stats().get('nsteps', '')}, [float(x[i])*size[i] for i in range(len(y0))]
    return run

def symbolic(model):
    """The right-hand sides written out, for symbols."""
    if model == 'Robertson':
        return lambda y: (-0.04*y[0] + 1e4*y[1]*y[2], 0.04*y[0] - 1e4*y[1]*y[2] - 3e7*y[1]**2, 3e7*y[1]**2)
    if model == 'VanDerPol':
        return lambda y: (y[1], ((1 - y[0]**2)*y[1] - y[0])*1e6)
    def hires(y):
        r = 280*y[5]*y[7]
        return (-1.71*y[0] + 0.43*y[1] + 8.32*y[2] + 0.0007, 1.71*y[0] - 8.75*y[1], -10.03*y[2] + 0.43*y[3] + 0.035*y[4],
                8.32*y[1] + 1.71*y[2] - 1.12*y[3], -1.745*y[4] + 0.43*y[5] + 0.43*y[6],
                -r + 0.69*y[3] + 1.71*y[4] - 0.43*y[5] + 0.69*y[6], r - 1.81*y[6], -r + 1.81*y[6])
    return hires

def sundae_run(model, tolerance, end):
    import numpy as np
    from sksundae.cvode import CVODE
    f, j, y0, size = scipy_problem(model)
    def rate(t, y, out):
        out[:] = f(t, y)
    def slopes(t, y, yp, out):
        out[:] = j(t, y)
    options = dict(rtol=tolerance, atol=[tolerance*x for x in size], jacfn=slopes, max_num_steps=10**6)
    begun = time.perf_counter()
    s = CVODE(rate, **options).solve(np.array([0.0, end]), np.array(y0, float))
    took = time.perf_counter() - begun
    return ({'solve_s': took, 'steps': ''}, list(s.y[-1])) if s.success else None

def build_diffsol(folder):
    """diffsol is a crate: its program is built by cargo, once; None where that does not work (no network, say)."""
    if not shutil.which('cargo'):
        return None
    manifest = HERE + '/peers/diffsol/Cargo.toml'
    environment = dict(os.environ, CARGO_TARGET_DIR=folder)
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, 'build.log'), 'w') as log:
        command = ['cargo', 'build', '--release', '--manifest-path', manifest]
        failed = subprocess.run(command, stdout=log, stderr=log, env=environment).returncode
    return None if failed else os.path.join(folder, 'release', 'stiff_diffsol')

def program_peer(name, program, version):
    """A program of benches/peers as a peer; None where it could not be built."""
    return program and ({name: lambda m, tol, end: c_run(program, m, tol, end, NAMES[m])}, version)

def scipy_peers(scipy):
    return {f'scipy {m}': scipy_run(m) for m in ('LSODA', 'BDF', 'Radau')}, f'scipy {scipy.__version__}, exact Jacobian'

def rumoca_peer(rumoca):
    return {'rumoca': rumoca_run()}, f'rumoca {rumoca.version() if callable(rumoca.version) else rumoca.version}'

def casadi_peer(casadi):
    return {'CasADi IDAS': casadi_run()}, f'CasADi {casadi.__version__}, IDAS, its own derivatives'

def sundae_peer(sksundae):
    return {'scikit-sundae': sundae_run}, f'scikit-sundae {sksundae.__version__}, CVODE, exact Jacobian'

def python_peer(make, *modules):
    """A peer from Python packages, the first of which is its own; None where one of them is missing."""
    try:
        return make([importlib.import_module(m) for m in modules][0])
    except ImportError:
        return None

def installed(folder):
    """All peers: name, how to get it, and its runs by name with a text on its version, or None."""
    pip = 'python3 -m pip install '
    yield 'C on IDA', 'apt-get install gcc cmake make, and build bramah once', program_peer(
        'C on IDA', build_c(folder), 'C on IDAS of sundials-sys, -O3, exact Jacobian')
    yield 'scipy', pip + 'scipy', python_peer(scipy_peers, 'scipy', 'scipy.integrate')
    yield 'rumoca', pip + 'rumoca', python_peer(rumoca_peer, 'rumoca')
    yield 'diffsol', 'the network once, for `cargo build` in benches/peers/diffsol', program_peer(
        'diffsol', build_diffsol(os.path.join(folder, 'diffsol')), 'diffsol 0.18.0, BDF, exact Jacobian')
    yield 'CasADi', pip + 'casadi numpy', python_peer(casadi_peer, 'casadi', 'numpy')
    yield 'scikit-sundae', pip + 'scikit-sundae scipy', python_peer(sundae_peer, 'sksundae', 'scipy')

def scipy_sizes(model):
    return {'Robertson': [1e-6], 'HiRes': [1e-4], 'VanDerPol': [1]}[model]

# --- work and precision -----------------------------------------------------------------------------------------------

def references():
    table = tomllib.load(open(ROOT + '/tests/stiff/references.toml', 'rb'))['problem']
    found = {p['model']: (p['end'], [p['values'][n] for n in NAMES[p['model']]]) for p in table if p['model'] in NAMES}
    # to 40 s, as most know it: digits of Radau of scipy at 1e-13, which agree with IDA at 1e-12 to 11
    found["Robertson"] = (40.0, [0.7158270687194032, 9.185534764557798e-6, 0.2841637457458286])
    return found

def attempt(run, model, tolerance, end):
    """A run of a peer; one that fails, in whatever way, or has no finite values is no point of the comparison."""
    try:
        got = run(model, tolerance, end)
    except Exception as why:
        print(f'{model} at {tolerance:.0e}: {type(why).__name__}: {why}', file=sys.stderr)
        return None
    return got if got and all(math.isfinite(y) for y in got[1]) else None

def work_precision(peers, tolerances, repeats):
    rows = []
    for model in WORK_PRECISION:
        end, reference = references()[model]
        for tolerance in tolerances:
            times, last = {p: [] for p in peers}, {}
            for _ in range(repeats):
                for name, run in peers.items():
                    got = attempt(run, model, tolerance, end)
                    if got:
                        times[name].append(got[0]['solve_s'])
                        last[name] = got
            for name in peers:
                if name in last:
                    stats, y = last[name]
                    error = max(abs(a - b)/abs(b) for a, b in zip(y, reference))
                    rows.append((model, name, tolerance, error, statistics.median(times[name]), stats['steps']))
    return rows

def at_error(rows, model, peer, error):
    """The time that a peer needs for an error, by a straight line between its runs in logarithms."""
    points = sorted((r[3], r[4]) for r in rows if r[0] == model and r[1] == peer and r[3] > 0 and r[4] > 0)
    for (e0, t0), (e1, t1) in zip(points, points[1:]):
        if e0 <= error <= e1 and e0 < e1:
            w = (math.log(error) - math.log(e0))/(math.log(e1) - math.log(e0))
            return math.exp(math.log(t0) + w*(math.log(t1) - math.log(t0)))
    return None

def picture(rows, model, path):
    colours = ['#0b62a4', '#c1440e', '#2e8540', '#7a4fa3', '#8a6d00', '#555555', '#b0307a', '#1f9e9e', '#d08a2e']
    points = [r for r in rows if r[0] == model and r[3] > 0 and r[4] > 0]
    if not points:
        return
    x = [math.log10(r[3]) for r in points]
    y = [math.log10(r[4]) for r in points]
    x0, x1, y0, y1 = math.floor(min(x)), math.ceil(max(x)), math.floor(min(y)), math.ceil(max(y))
    x1, y1 = max(x1, x0 + 1), max(y1, y0 + 1)
    px = lambda v: 70 + 520*(x1 - v)/(x1 - x0)
    py = lambda v: 350 - 310*(v - y0)/(y1 - y0)
    svg = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 410" font-family="sans-serif" font-size="12">',
           '<rect width="760" height="410" fill="white"/>', f'<text x="70" y="24" font-size="15">{model}: time over error</text>']
    for k in range(x0, x1 + 1):
        svg.append(f'<path d="M{px(k):.1f} 40V350" stroke="#ddd"/><text x="{px(k):.1f}" y="368" text-anchor="middle">1e{k}</text>')
    for k in range(y0, y1 + 1):
        svg.append(f'<path d="M70 {py(k):.1f}H590" stroke="#ddd"/><text x="62" y="{py(k) + 4:.1f}" text-anchor="end">1e{k} s</text>')
    svg.append('<text x="330" y="392" text-anchor="middle">largest relative error at the end</text>')
    for i, peer in enumerate(dict.fromkeys(r[1] for r in points)):
        c = colours[i % len(colours)]
        line = sorted((r[2], px(math.log10(r[3])), py(math.log10(r[4]))) for r in points if r[1] == peer)
        svg.append(f'<polyline fill="none" stroke="{c}" stroke-width="2" points="' + ' '.join(f'{a:.1f},{b:.1f}' for _, a, b in line) + '"/>')
        svg += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3" fill="{c}"/>' for _, a, b in line]
        svg.append(f'<path d="M605 {60 + 20*i}h20" stroke="{c}" stroke-width="2"/><text x="632" y="{64 + 20*i}">{peer}</text>')
    open(path, 'w').write('\n'.join(svg + ['</svg>\n']))

# --- the stiff set ----------------------------------------------------------------------------------------------------

IN_C = ['Robertson', 'HiRes', 'VanDerPol', 'Pollution', 'E5', 'RingModulator', 'AkzoNobel', 'TransistorAmplifier', 'MedicalAkzo',
        'Brusselator', 'CarAxis', 'Squeezer', 'SliderCrank', 'WaterTubes', 'Brusselator2D']

def stiff_set(binary, program, full):
    """Steps and errors of the problems that are written in C too: medians over tolerances around each, the same for both,
    for the error of a single run is a matter of luck within a factor of ten."""
    around = [10**(k/26) for k in (range(-4, 5) if full else (-4, 0, 4))]
    table = tomllib.load(open(ROOT + '/tests/stiff/references.toml', 'rb'))['problem']
    rows = []
    for p in table:
        for tolerance in (1e-4, 1e-6, 1e-8) if p['model'] in IN_C else ():
            runs = [r for factor in around if (r := beside_c(binary, program, p, tolerance*factor))]
            if runs:
                rows.append((p['model'], tolerance, *(statistics.median(column) for column in zip(*runs))))
    return rows

def beside_c(binary, program, p, tolerance):
    """Steps of both, errors of both; None where one fails."""
    with tempfile.TemporaryDirectory() as d:
        open(d + '/run.mo', 'w').write(f"model Run\n  extends {p['model']}({p.get('modify', '')});\nend Run;\n")
        own = bramah_run(binary, d + '/run.mo', tolerance, p['end'], list(p['values']))
    run = subprocess.run([program, p['model'], repr(tolerance)], capture_output=True, text=True)
    if own is None or run.returncode:
        return None
    c = json.loads(run.stdout)
    if p['model'] == 'E5':
        c['values']['y_3'] = c['values']['y_2'] - c['values']['y_4']
    error = lambda values: max(abs(a - b)/abs(b) for a, b in zip(values, p['values'].values()))
    return own[0]['steps'], c['steps'], error(own[1]), error([c['values'][n] for n in p['values']])

# --- growth -----------------------------------------------------------------------------------------------------------

def growth(binary, full):
    sizes = {'Grid': ('N', [10, 30, 100] if full else [10, 20, 40]), 'Tree': ('L', [64, 512, 4096] if full else [64, 256, 1024]),
             'Frictions': ('N', [10, 100, 1000] if full else [10, 30, 100])}
    rows = []
    for model, (parameter, values) in sizes.items():
        for n in values:
            got = None
            runs = []
            for _ in range(3 if not full else 1):
                with tempfile.TemporaryDirectory() as d:
                    run = subprocess.run([binary, 'simulate', HERE + '/models/Networks.mo', '--model', 'Networks.' + model, '--set',
                                          f'{parameter}={n}', '--output-file', d + '/o.csv', '--statistics', d + '/s.json'], capture_output=True)
                    if run.returncode == 0:
                        got = json.load(open(d + '/s.json'))
                        runs.append((got['compile_s'], got['solve_s']))
            if got:
                rows.append((f'{model} {parameter} = {n}', got['unknowns'], statistics.median(r[0] for r in runs),
                             statistics.median(r[1] for r in runs), got['steps'], got['events'], (got['peak_memory_bytes'] or math.nan)/2**20))
    return rows

def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument('bramah')
    arguments.add_argument('--full', action='store_true')
    arguments.add_argument('--out', default=ROOT + '/target/bench')
    a = arguments.parse_args()
    os.makedirs(a.out, exist_ok=True)
    version = subprocess.run([a.bramah, '--version'], capture_output=True, text=True).stdout.strip()
    peers = {'bramah': lambda m, tol, end: bramah_run(a.bramah, m, tol, end, NAMES[m])}
    versions, skipped = [version], []
    folder = os.path.join(os.path.dirname(os.path.abspath(a.bramah)), 'peers')
    for name, how, found in installed(folder):
        if found:
            peers.update(found[0])
            versions.append(found[1])
        else:
            skipped.append((name, how))
    skipped += [('OpenModelica', 'https://openmodelica.org: reads models/stiff as they are')]
    tolerances = [10.0**-k for k in (range(3, 11) if a.full else range(3, 10, 2))]
    rows = work_precision(peers, tolerances, 11 if a.full else 5)
    if not any(r[1] == 'bramah' for r in rows):
        sys.exit(f'error: `{a.bramah}` runs none of the models in models/stiff')
    text = [f'Run on {datetime.date.today().isoformat()}: {platform.processor() or platform.machine()}, {os.cpu_count()} cores, {platform.system()}; '
            + '; '.join(versions) + '.', '', '## Time for an error', '',
            'Milliseconds of solving, at the same error, by a line between the measured points in logarithms; in brackets as a multiple of bramah.', '',
            '| problem | error | ' + ' | '.join(peers) + ' |', '|---' * (2 + len(peers)) + '|']
    for model in WORK_PRECISION:
        for error in (1e-3, 1e-5, 1e-7):
            own = at_error(rows, model, 'bramah', error)
            cells = []
            for peer in peers:
                t = at_error(rows, model, peer, error)
                cells.append('' if t is None else f'{1e3*t:.3g}' + (f' ({t/own:.2g})' if own and peer != 'bramah' else ''))
            text.append(f'| {model} | {error:.0e} | ' + ' | '.join(cells) + ' |')
        picture(rows, model, f'{a.out}/{model}.svg')
    text += ['', '## All runs', '', '| problem | solver | tolerance | error | milliseconds | steps |', '|---|---|---|---|---|---|']
    text += [f'| {m} | {p} | {tol:.0e} | {e:.1e} | {1e3*t:.3g} | {s} |' for m, p, tol, e, t, s in rows]
    if 'C on IDA' in peers:
        text += ['', '## The stiff set beside C', '', '| problem | tolerance | steps | of C | ratio | error | of C | ratio |', '|---|---|---|---|---|---|---|---|']
        text += [f'| {m} | {tol:.0e} | {own:.0f} | {c:.0f} | {own/c:.2f} | {e:.1e} | {f:.1e} | {e/f:.2g} |'
                 for m, tol, own, c, e, f in stiff_set(a.bramah, os.path.join(folder, 'stiff_set'), a.full)]
    text += ['', '## Growth', '', '| network | unknowns | compile, s | solve, s | steps | events | memory, MB |', '|---|---|---|---|---|---|---|']
    text += [f'| {n} | {u} | {c:.3g} | {s:.3g} | {st} | {e} | {mb:.0f} |' for n, u, c, s, st, e, mb in growth(a.bramah, a.full)]
    text += ['', '## Skipped', ''] + [f'- {name}: {how}' for name, how in skipped]
    open(a.out + '/results.md', 'w').write('\n'.join(text) + '\n')
    print('\n'.join(text))

if __name__ == '__main__':
    main()
