//! Mass and energy of every circuit of oil in `models/` and of every example with oil: what flows into a component is
//! held, stored or lost there.
//!
//! Power that oil carries is its mass flow times h, the integral of dp/rho from the reference pressure: the work that
//! it takes to bring it to that pressure. `tests/balances.csv` says per class what it stores and what it loses.

#![allow(
    clippy::disallowed_methods,
    clippy::print_stderr,
    reason = "tests read their own files and say what they found"
)]

use crate::disk;
use crate::rig;

use bramah::Code;
use bramah::internals::compile::flatten;
use bramah::internals::flat::FlatModel;
use bramah::results::Trajectory;
use bramah::world::{MemoryWorld, World};
use bramah::{Interpolation, Request, Simulation};
use disk::Disk;
use rig::{column, last};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What leaves a model, or enters it, here.
const SOURCE: &str = "source";

/// Of the runs: what is held shall show the error of the equations.
const TOLERANCE: f64 = 1e-9;

/// Nodes and weights of Gauss and Legendre on 0..1.
const NODES: [(f64, f64); 6] = [
    (0.033_765_242_898_424, 0.085_662_246_189_585),
    (0.169_395_306_766_868, 0.180_380_786_524_069),
    (0.380_690_406_958_402, 0.233_956_967_286_345),
    (0.619_309_593_041_598, 0.233_956_967_286_345),
    (0.830_604_693_233_132, 0.180_380_786_524_069),
    (0.966_234_757_101_576, 0.085_662_246_189_585),
];

/// The integral of dp/rho from the reference pressure to `p`, over the logarithm of the pressure.
fn work_per_mass(p: &str) -> String {
    let nodes = NODES.iter().map(|(x, w)| {
        let pressure = format!("oil.p_0*exp({x}*log({p}/oil.p_0))");
        format!("{w}*{pressure}/oil.density({pressure})")
    });
    format!("log({p}/oil.p_0)*({})", nodes.collect::<Vec<_>>().join(" + "))
}

/// A class of the table, with `{}` for the component and `h(..)` for [`work_per_mass`].
#[derive(Debug)]
struct Row {
    stored: String,
    lost: String,
}

fn table() -> BTreeMap<String, Row> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/balances.csv");
    let mut reader = csv::Reader::from_path(path).expect("the table is there");
    let rows = reader.records().map(|record| {
        let record = record.expect("three columns");
        (record[0].to_owned(), Row { stored: record[1].to_owned(), lost: record[2].to_owned() })
    });
    rows.collect()
}

/// An expression of the table for one component.
fn filled(expression: &str, component: &str) -> String {
    let mut text = expression.replace("{}", component);
    while let Some(start) = text.find("h(") {
        let end = start + text[start..].find(')').expect("h(pressure)");
        text = format!("{}({}){}", &text[..start], work_per_mass(&text[start + 2..end]), &text[end + 1..]);
    }
    text
}

/// The ports of a circuit's components: component, connector, name of the flow.
fn ports(flat: &FlatModel) -> Vec<(String, String, String)> {
    let flows = flat.variables.iter().filter(|v| v.flow);
    let parts = flows.filter_map(|v| {
        let (connector, flow) = v.name.rsplit_once('.')?;
        let (component, port) = connector.split_once('.')?;
        (!port.contains('.')).then(|| (component.to_owned(), connector.to_owned(), flow.to_owned()))
    });
    parts.collect()
}

/// What is asked of one circuit.
struct Circuit {
    class: String,
    /// Components with ports of oil, and whether what they hold is known.
    oil: Vec<(String, bool)>,
    /// Components with any ports, with their classes.
    all: Vec<(String, String)>,
    flat: FlatModel,
    /// No oil is declared: the default is used.
    default_oil: bool,
    /// It has neither tank nor source of oil.
    closed: bool,
    /// Its oil carries heat, and so more than the work of its pressure: tests/circuits/thermo_hydraulics.rs keeps that account.
    thermal: bool,
}

/// Inputs without a value of their own are 0 unless a test says otherwise.
fn at_rest(simulation: &mut Simulation) {
    let dae = simulation.model().dae.clone();
    let variables = dae.inputs.iter().map(|v| &dae.variables[v.index()]);
    for input in variables.filter(|v| v.binding.is_none() && v.start.is_none()) {
        simulation.input(&input.name, &[0.0], &[0.0], Interpolation::Held).expect("an input");
    }
}

impl Circuit {
    /// `None` where there is no oil.
    fn read(class: &str) -> Option<Circuit> {
        let request = Request { source: PathBuf::from(class), ..Request::default() };
        let outcome = flatten(&Disk, &request);
        let default_oil = outcome.diagnostics.iter().any(|d| d.code == Code::AutomaticInner);
        let flattened = outcome.value.unwrap_or_else(|| panic!("{class}"));
        let class_of = |component: &str| {
            let node = flattened.graph.node_weights().find(|n| n.name == component);
            node.map_or_else(String::new, |n| n.class.clone())
        };
        let ports = ports(&flattened.flat);
        let names = |wanted: &dyn Fn(&str) -> bool| {
            let mut names: Vec<String> = ports.iter().filter(|p| wanted(&p.2)).map(|p| p.0.clone()).collect();
            names.sort();
            names.dedup();
            names
        };
        let infinite = ["Tank", "PressureSource", "FlowSource", "Reservoir"];
        let known = |c: &String| !infinite.iter().any(|s| class_of(c).rsplit('.').next() == Some(*s));
        let oil: Vec<(String, bool)> = names(&|flow| flow == "q").into_iter().map(|c| (c.clone(), known(&c))).collect();
        let all = names(&|_| true).into_iter().map(|c| (c.clone(), class_of(&c))).collect();
        // a source of flow alone asks for the density of the circuit's oil, and holds none
        let holds =
            |v: &bramah::internals::flat::FlatVariable| v.name.ends_with(".mass") && v.unit.as_deref() == Some("kg");
        let variables = &flattened.flat.variables;
        let has_oil = !oil.is_empty() && variables.iter().any(|v| v.name == "oil.T") && variables.iter().any(holds);
        let closed = oil.iter().all(|c| c.1);
        let class = class.to_owned();
        let heat =
            |v: &bramah::internals::flat::FlatVariable| v.name.ends_with(".T_oil") || v.name.ends_with(".T_case");
        let of_oil = |v: &bramah::internals::flat::FlatVariable| heat(v) && v.fixed && v.start.is_some();
        let thermal = flattened.flat.variables.iter().any(of_oil);
        has_oil.then(|| Circuit { class, oil, all, flat: flattened.flat, default_oil, closed, thermal })
    }

    /// The circuit with the integrals of what flows in; `energy`: rows of its components.
    fn watched(&self, energy: Option<&BTreeMap<String, Row>>) -> String {
        let ports = ports(&self.flat);
        let oil = if self.default_oil { "  inner Oil.Fluid oil;\n" } else { "" };
        let mut declared = format!("{oil}  Real swelling = oil.density(1e7)/oil.density(1e5) - 1;\n");
        let mut equations = String::new();
        let mut integral = |name: String, nominal: f64, rate: String| {
            let _ = writeln!(declared, "  Real {name}(start = 0, fixed = true, nominal = {nominal});");
            let _ = writeln!(equations, "  der({name}) = {rate};");
        };
        for (i, (component, _)) in self.oil.iter().enumerate() {
            let own = ports.iter().filter(|p| p.0 == *component && p.2 == "q");
            let rate: Vec<String> = own.map(|(_, c, _)| format!("oil.density({c}.p)*{c}.q")).collect();
            integral(format!("mass_in_{i}"), 1e-2, rate.join(" + "));
        }
        let mut stored = String::new();
        for (i, (component, class)) in self.all.iter().enumerate().filter(|_| energy.is_some()) {
            let own = ports.iter().filter(|p| p.0 == *component);
            let power = own.map(|(_, c, flow)| match flow.as_str() {
                "q" => format!("oil.density({c}.p)*{c}.q*{}", work_per_mass(&format!("{c}.p"))),
                "tau" => format!("{c}.tau*der({c}.phi)"),
                "f" => format!("{c}.f*der({c}.s)"),
                "Q_flow" => format!("{c}.Q_flow"),
                other => panic!("{}: what power goes with {other} of {c}?", self.class),
            });
            integral(format!("energy_in_{i}"), 10.0, power.collect::<Vec<_>>().join(" + "));
            let row = energy.and_then(|rows| rows.get(class));
            let row = row.unwrap_or_else(|| panic!("{}: tests/balances.csv has no row for {class}", self.class));
            if row.stored != SOURCE {
                integral(format!("energy_lost_{i}"), 10.0, filled(&row.lost, component));
                let _ =
                    writeln!(stored, "  Real energy_stored_{i}(nominal = 10) = {};", filled(&row.stored, component));
            }
        }
        format!("model Watched\n  extends {};\n{declared}{stored}equation\n{equations}end Watched;\n", self.class)
    }

    /// A run of [`Circuit::watched`]; `None` where the oil is that of textbooks, which keeps its density however it is
    /// compressed: volumes balance there, not masses.
    fn run(&self, energy: Option<&BTreeMap<String, Row>>) -> Option<Trajectory> {
        self.run_with(energy, |simulation| simulation.settings().tolerance = TOLERANCE)
    }

    fn run_with(
        &self,
        energy: Option<&BTreeMap<String, Row>>,
        set: impl FnOnce(&mut Simulation),
    ) -> Option<Trajectory> {
        let text = self.watched(energy);
        let world = MemoryWorld::single("watched.mo", text.clone());
        let request = Request { source: "watched.mo".into(), ..Request::default() };
        let compiled = Simulation::compile(&world, &request);
        let mut simulation = compiled.unwrap_or_else(|e| panic!("{}: {e}\n{text}", self.class));
        at_rest(&mut simulation);
        set(&mut simulation);
        let t = simulation.run().unwrap_or_else(|e| panic!("{}: {e}", self.class)).trajectory;
        (last(&t, "swelling") != 0.0).then_some(t)
    }

    /// What a component holds at a row: all variables in it that are called `mass`.
    fn held(&self, t: &Trajectory, component: &str, row: usize) -> f64 {
        let inside = |name: &str| {
            name.strip_prefix(component)
                .is_some_and(|rest| rest == ".mass" || rest.starts_with('.') && rest.ends_with(".mass"))
        };
        let all = self.flat.variables.iter().filter(|v| inside(&v.name) && v.unit.as_deref() == Some("kg"));
        all.map(|v| column(t, &v.name)[row]).sum()
    }

    /// The worst place at which mass is made or lost, over the mass in the circuit, or a milligram where none is held.
    fn mass_defect(&self, t: &Trajectory) -> (f64, String) {
        let total: f64 = self.oil.iter().map(|(c, _)| self.held(t, c, 0)).sum();
        let mut worst = (0.0, String::new());
        for (i, (component, _)) in self.oil.iter().enumerate().filter(|(_, c)| c.1) {
            let flow = column(t, &format!("mass_in_{i}"));
            let through = flow.iter().fold(0.0f64, |most, m| most.max(m.abs()));
            for (row, flown) in flow.iter().enumerate() {
                let held = self.held(t, component, row) - self.held(t, component, 0);
                let defect = (flown - held).abs() / total.max(through).max(1e-6);
                if defect > worst.0 || !defect.is_finite() {
                    worst = (defect, format!("{} at {} s", component, t.times[row]));
                }
            }
        }
        worst
    }

    /// The worst place at which energy is made or lost, over what passes there, and the same for the whole circuit over
    /// all that passes.
    fn energy_defect(&self, t: &Trajectory, table: &BTreeMap<String, Row>) -> (f64, String, f64) {
        let most = |values: &[f64]| values.iter().fold(0.0f64, |most, v| most.max((v - values[0]).abs()));
        let mut worst = (0.0, String::new());
        let mut whole = vec![0.0; t.len()];
        let mut turned = 0.0f64;
        for (i, (component, class)) in self.all.iter().enumerate() {
            let flow = column(t, &format!("energy_in_{i}"));
            if table[class].stored == SOURCE {
                turned = turned.max(most(flow));
                whole.iter_mut().zip(flow).for_each(|(sum, given)| *sum += given);
                continue;
            }
            let [lost, stored] = ["lost", "stored"].map(|what| column(t, &format!("energy_{what}_{i}")));
            let scale = most(flow).max(most(lost)).max(most(stored)).max(1e-3);
            turned = turned.max(scale);
            for row in 0..t.len() {
                let kept = lost[row] + stored[row] - stored[0];
                whole[row] += kept;
                let defect = (flow[row] - kept).abs() / scale;
                if defect > worst.0 || !defect.is_finite() {
                    worst = (
                        defect,
                        format!("{component} ({class}) at {} s: {} J in, {kept} J kept", t.times[row], flow[row]),
                    );
                }
            }
        }
        (worst.0, worst.1, most(&whole) / turned)
    }
}

fn classes(folder: &Path, root: &Path, out: &mut Vec<String>) {
    for (name, is_folder) in Disk.list(folder).expect("the folder is there") {
        let path = folder.join(&name);
        if is_folder {
            classes(&path, root, out);
        } else if name.ends_with(".mo") {
            let text = Disk.read(&path).expect("a text");
            if text.contains("experiment(") && !text.contains("partial model") {
                let rest = path.strip_prefix(root).expect("below the root").with_extension("");
                out.push(rest.iter().map(|p| p.to_string_lossy()).collect::<Vec<_>>().join("."));
            }
        }
    }
}

/// Circuits of oil in a folder of the project.
fn circuits(folder: &str) -> Vec<Circuit> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut names = Vec::new();
    classes(&root, &root, &mut names);
    names.sort();
    let found: Vec<Circuit> =
        names.iter().filter(|n| !n.starts_with("stiff.")).filter_map(|n| Circuit::read(n)).collect();
    assert!(!found.is_empty());
    found
}

/// What does not hold is said at once for all circuits.
fn none(found: &[String]) {
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// A loss is its flow times dp over the mean density, and the trapezoid misses h by up to 0.6 % where one side is a tank
/// with free air in its oil; what a pump is counted too little, a valve is counted too much, and the circuit closes.
#[test]
fn mass_and_energy_of_every_circuit_balance() {
    let table = table();
    let mut found = Vec::new();
    let mut textbook = Vec::new();
    for circuit in circuits("models") {
        let Some(t) = circuit.run((!circuit.thermal).then_some(&table)) else {
            textbook.push(circuit.class);
            continue;
        };
        let (mass, at) = circuit.mass_defect(&t);
        let (energy, place, whole) = match circuit.thermal {
            true => (0.0, "not counted: its oil carries heat".to_owned(), 0.0),
            false => circuit.energy_defect(&t, &table),
        };
        eprintln!(
            "{}: mass {mass:.1e}, energy of a component {energy:.1e}, of the circuit {whole:.1e}, {place}",
            circuit.class
        );
        if mass > 1e-9 {
            found.push(format!("{}: {mass} of the mass at {at}", circuit.class));
        }
        if energy > 1e-2 {
            found.push(format!("{}: {energy} of the energy, {place}", circuit.class));
        }
        if whole > 2e-4 {
            found.push(format!("{}: {whole} of the energy of the circuit", circuit.class));
        }
    }
    none(&found);
    assert_eq!(textbook, ["GapAxis.Nominal"]);
}

#[test]
fn closed_circuits_keep_their_oil_over_100_s() {
    let mut tried = Vec::new();
    let mut found = Vec::new();
    // other forms of the drive and the pump of `System` run some seconds above: 100 s take minutes in a debug build
    let slow = ["ServoPump.SampledDrive", "ServoPump.SampledFieldOrientedDrive", "ServoPump.PistonPump"];
    let quick = |c: &Circuit| !c.all.iter().any(|(_, class)| slow.contains(&class.as_str()));
    for circuit in circuits("models").into_iter().filter(|c| c.closed && quick(c)) {
        if let Some(t) = circuit.run_with(None, |s| _ = s.stop_time(100.0)) {
            let (mass, at) = circuit.mass_defect(&t);
            eprintln!("{}: mass {mass:.1e}", circuit.class);
            if mass > 1e-6 {
                found.push(format!("{}: {mass} of the mass at {at}", circuit.class));
            }
            tried.push(circuit.class);
        }
    }
    none(&found);
    assert_eq!(tried, ["ClosedCircuit.WarmUp", "ServoPump.DeadZone", "ServoPump.System"]);
}

#[test]
fn mass_of_every_example_balances() {
    let mut found = Vec::new();
    let mut textbook = Vec::new();
    for circuit in circuits("components") {
        let Some(t) = circuit.run(None) else {
            textbook.push(circuit.class);
            continue;
        };
        let (mass, at) = circuit.mass_defect(&t);
        if mass > 1e-6 {
            found.push(format!("{}: {mass} of the mass at {at}", circuit.class));
        }
    }
    none(&found);
    assert_eq!(textbook, ["Oil.Examples.ConstantDensityExample"]);
}
