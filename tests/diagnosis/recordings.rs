//! Whatever a study and its recordings hold, a diagnosis ends with a verdict or a message: circuits of the library beside
//! random columns (constant, stepped, noisy, huge, with gaps, three samples long, times that go back).
//!
//! `./x fuzz` looks at other cases, `PROPTEST_CASES=10000 cargo test --release --test diagnosis recordings::` at many.

#![allow(clippy::disallowed_methods, reason = "reads its cases")]

use crate::rig;

use bramah::Budget;
use bramah::Sources;
use bramah::internals::gap::fixed::corrected;
use bramah::internals::gap::report::report;
use bramah::internals::gap::select::search::search;
use bramah::internals::gap::study::question;
use bramah::internals::gap::verdict::conclude;
use bramah::internals::gap::words::words;
use bramah::internals::study::Study;
use bramah::world::MemoryWorld;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rig::{Numbers, ORIFICE};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

/// Circuits with inputs: a volume between two orifices, a shaft with friction.
const CIRCUITS: &str = "
package Circuits
  model Volume
    inner Oil.ISOVG46 oil;
    Interfaces.RealInput p(unit = \"Pa\", nominal = 1e6);
    Hydraulic.PressureSource supply(useInput = true);
    Hydraulic.Orifice into(A = 1e-6);
    Hydraulic.Volume volume(V = 1e-3);
    Hydraulic.Orifice out(A = 1e-6);
    Hydraulic.Tank tank;
  equation
    connect(p, supply.p_in);
    connect(supply.port, into.port_a);
    connect(into.port_b, volume.port);
    connect(volume.port, out.port_a);
    connect(out.port_b, tank.port);
  end Volume;
  model Shaft
    Interfaces.RealInput u(unit = \"N.m\", nominal = 1);
    Mechanical.Rotational.Torque torque;
    Mechanical.Rotational.Inertia rotor(J = 1e-2);
    Mechanical.Rotational.Damper friction(d = 1e-2);
    Mechanical.Rotational.Fixed ground;
  equation
    connect(u, torque.tau);
    connect(torque.flange, rotor.flange_a);
    connect(rotor.flange_b, friction.flange_a);
    connect(friction.flange_b, ground.flange);
  end Shaft;
end Circuits;";

/// A model that a study may name: source, class, its input if it has one, signals.
type Nominal = (Option<&'static str>, String, Option<&'static str>, Vec<String>);

/// The circuits above, one without states, and every example of the library with the signals that its golden figures speak of.
static NOMINAL: LazyLock<Vec<Nominal>> = LazyLock::new(|| {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("tests/examples.csv")).expect("the list of examples");
    let mut examples: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let mut cells = line.split(',');
        let (class, signal) = (cells.next().expect("a class"), cells.nth(1).expect("a signal"));
        examples.entry(class).or_default().push(signal.to_string());
    }
    let own = [
        ("Circuits.mo", "Circuits.Volume", "p", ["volume.p", "into.q"]),
        ("Circuits.mo", "Circuits.Shaft", "u", ["rotor.w", "rotor.phi"]),
        ("Static.mo", "Static", "p", ["orifice.q", "supply.port.p"]),
    ];
    let own =
        own.map(|(s, c, input, signals)| (Some(s), c.to_string(), Some(input), signals.map(String::from).to_vec()));
    own.into_iter().chain(examples.into_iter().map(|(c, s)| (None, c.to_string(), None, s))).collect()
});

/// What a column holds.
#[derive(Clone, Copy, Debug)]
enum Column {
    Constant,
    Steps,
    Noise,
    Ramp,
    Sine,
    Huge,
    Tiny,
    Gaps,
    Words,
}

/// How its times go.
#[derive(Clone, Copy, Debug)]
enum Clock {
    Even,
    Uneven,
    Twice,
    Back,
    Still,
}

#[derive(Clone, Debug)]
struct Case {
    nominal: usize,
    columns: Vec<Column>,
    clock: Clock,
    step: f64,
    samples: Vec<usize>,
    held: bool,
    measured: bool,
    full_scale: Option<f64>,
    seed: u64,
}

fn case() -> impl Strategy<Value = Case> {
    use Column::{Constant, Gaps, Huge, Noise, Ramp, Sine, Steps, Tiny, Words};
    let plain = || prop::sample::select(vec![Constant, Steps, Noise, Ramp, Sine]);
    let odd = prop::sample::select(vec![Huge, Tiny, Gaps, Words]);
    let column = prop_oneof![12 => plain(), 1 => odd];
    let clock = prop_oneof![12 => Just(Clock::Even), 2 => Just(Clock::Uneven), 1 => Just(Clock::Twice),
        1 => Just(Clock::Back), 1 => Just(Clock::Still)];
    let samples = prop::collection::vec(prop_oneof![1 => 0_usize..5, 4 => 5_usize..120], 1..4);
    let full_scale = prop_oneof![3 => Just(None), 1 => prop::sample::select(vec![1e-9, 1.0, 1e12]).prop_map(Some)];
    let nominal = prop_oneof![3 => 0..3_usize, 1 => 3..NOMINAL.len()];
    (
        (nominal, prop::collection::vec(column, 6), clock, prop::sample::select(vec![1e-5, 1e-3, 0.05, 10.0])),
        (samples, any::<bool>(), any::<bool>(), full_scale, any::<u64>()),
    )
        .prop_map(|((nominal, columns, clock, step), (samples, held, measured, full_scale, seed))| Case {
            nominal,
            columns,
            clock,
            // A machine that resolves its pistons takes minutes for seconds of one simulation, and a diagnosis has many:
            // recordings of an example are at most 0.1 s long.
            step: if nominal < 3 { step } else { step.min(1e-3) },
            samples,
            held,
            measured,
            full_scale,
            seed,
        })
}

fn cell(column: Column, k: usize, size: f64, random: &mut Numbers, last: &mut f64) -> String {
    let x = k as f64;
    let value = match column {
        Column::Constant => 0.5,
        Column::Steps => {
            if k.is_multiple_of(20) {
                *last = random.between(-1.0, 1.0);
            }
            *last
        }
        Column::Noise => random.between(-1.0, 1.0),
        Column::Ramp => 0.01 * x,
        Column::Sine => (0.3 * x).sin(),
        Column::Huge => 1e300 * random.between(-1.0, 1.0),
        Column::Tiny => 1e-300 * random.between(-1.0, 1.0),
        Column::Gaps if k % 7 == 3 => return String::new(),
        Column::Gaps => random.between(-1.0, 1.0),
        Column::Words => return "n/a".into(),
    };
    format!("{}", size * value)
}

fn recording(case: &Case, nominal: &Nominal, samples: usize, random: &mut Numbers) -> String {
    let (.., input, signals) = nominal;
    let names = input.iter().map(ToString::to_string).chain((0..signals.len()).map(|i| format!("y{i}")));
    let mut text = String::from("t");
    let names: Vec<String> = names.collect();
    names.iter().for_each(|name| write!(text, ",{name}").expect("a text"));
    text.push('\n');
    let sizes: Vec<f64> = names.iter().map(|_| 10.0_f64.powf(4.0 * random.between(-1.0, 1.0) + 2.0)).collect();
    let mut last = vec![0.0; names.len()];
    for k in 0..samples {
        let x = k as f64;
        let t = match case.clock {
            Clock::Even => x,
            Clock::Uneven => x + 0.4 * random.between(-1.0, 1.0),
            Clock::Twice => (k / 2) as f64,
            Clock::Back => -x,
            Clock::Still => 1.0,
        };
        write!(text, "{}", case.step * t).expect("a text");
        for (i, last) in last.iter_mut().enumerate() {
            let column = case.columns[i % case.columns.len()];
            write!(text, ",{}", cell(column, k, sizes[i], random, last)).expect("a text");
        }
        text.push('\n');
    }
    text
}

fn study(case: &Case, nominal: &Nominal) -> String {
    let (source, class, input, signals) = nominal;
    let mut text = String::from("version = 1\n");
    if let Some(source) = source {
        writeln!(text, "model = \"{source}\"").expect("a text");
    }
    writeln!(text, "class = \"{class}\"").expect("a text");
    if let Some(input) = input {
        let kind = if case.measured { "measured" } else { "command" };
        writeln!(text, "[inputs]\n{input} = {{ column = \"{input}\", kind = \"{kind}\" }}").expect("a text");
    }
    text.push_str("[signals]\n");
    for (i, signal) in signals.iter().enumerate() {
        let scale = case.full_scale.map_or(String::new(), |s| format!(", full_scale = {s:e}"));
        writeln!(text, "y{i} = {{ variable = \"{signal}\", column = \"y{i}\"{scale} }}").expect("a text");
    }
    for r in 0..case.samples.len() {
        let role = if case.held && r > 0 && r + 1 == case.samples.len() { "held" } else { "train" };
        writeln!(text, "[[recordings]]\nfile = \"r{r}.csv\"\nrole = \"{role}\"\ntime = \"t\"").expect("a text");
    }
    text
}

/// The whole command but its files; whether there was a verdict.
fn diagnosed(case: &Case) -> bool {
    let nominal = &NOMINAL[case.nominal];
    let mut world = MemoryWorld::single("Circuits.mo", CIRCUITS);
    world.add("Static.mo", ORIFICE);
    let mut random = Numbers(case.seed);
    for (r, samples) in case.samples.iter().enumerate() {
        world.add(format!("r{r}.csv"), recording(case, nominal, *samples, &mut random));
    }
    world.add("study.toml", study(case, nominal));
    let mut sources = Sources::default();
    let Some(study) = Study::read(&world, Path::new("study.toml"), &mut sources).value else { return false };
    let Ok(question) = question(&world, &study, None, &mut sources) else { return false };
    let Ok(held) = question.held(None, &mut sources) else { return false };
    // as the command does; without a budget one case in a hundred takes minutes
    let start = Instant::now();
    let gone = || start.elapsed();
    let budget = Some(Budget { time: Some(Duration::from_secs(10)), gone: &gone });
    let Ok(found) = search(&question.problem, &held.recordings, budget, &mut |_| ControlFlow::Continue(())) else {
        return false;
    };
    let verdict = conclude(&question.problem, &found, &held.recordings, 0.0);
    assert!(!words(&verdict).contains("NaN"), "{}", words(&verdict));
    serde_json::to_string(&verdict).expect("a verdict is JSON");
    report(&question.problem, &found, &verdict, &held);
    corrected(&question.problem, &found.last.fit);
    true
}

/// Where nothing is odd there is a verdict: the random cases below go all the way.
#[test]
fn plain_recordings_have_a_verdict() {
    for nominal in 0..3 {
        let case = Case {
            nominal,
            columns: vec![Column::Steps, Column::Noise, Column::Sine],
            clock: Clock::Even,
            step: 0.05,
            samples: vec![60, 60],
            held: true,
            measured: false,
            full_scale: None,
            seed: 1,
        };
        assert!(diagnosed(&case), "{}", NOMINAL[nominal].1);
    }
}

/// Few cases every day, and the same ones: each is a whole diagnosis, and of some hundred one takes minutes. `./x fuzz`
/// and whoever asks for more cases get others.
fn config() -> ProptestConfig {
    let asked = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok());
    let seeded = std::env::var_os("PROPTEST_RNG_SEED").is_some();
    let usual = ProptestConfig { max_shrink_iters: 30, failure_persistence: None, ..ProptestConfig::default() };
    match asked {
        Some(cases) => ProptestConfig { cases, ..usual },
        None if seeded => ProptestConfig { cases: 12, ..usual },
        None => ProptestConfig { cases: 12, rng_seed: RngSeed::Fixed(1), ..usual },
    }
}

proptest! {
    #![proptest_config(config())]
    #[test]
    fn any_recording_ends(case in case()) {
        prop_assert!(std::panic::catch_unwind(|| diagnosed(&case)).is_ok(), "panics");
    }
}
