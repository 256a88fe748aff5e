//! Why a model does not have as many equations as unknowns: the first level at which something is wrong.
//!
//! Called when the equations do not determine the unknowns. The order is: inputs without a value, open ports, the
//! balance of each component class on its own (MLS 4.8). A plain matching would accuse the innocent.

use super::{Equation, FlatModel, Origin, OriginKind, Variability, WhenAction};
use crate::diag::{Code, Diagnostic};
use crate::expr::{ExprId, Exprs, Node, VarId};
use std::collections::{BTreeMap, BTreeSet};

/// Most diagnostics of one kind.
const MOST: usize = 10;

/// Messages that explain an unbalanced or singular model; empty when every component is sound on its own.
///
/// `solvable` tells whether a changed model would be determined; open ports are blamed only if closing them helps.
pub fn explain(flat: &FlatModel, solvable: &dyn Fn(&FlatModel) -> bool) -> Vec<Diagnostic> {
    for found in [inputs_without_value(flat), local_balance(flat), open_ports(flat, solvable)] {
        if !found.is_empty() {
            return found;
        }
    }
    Vec::new()
}

/// Inputs of components that nothing outside their component gives a value.
fn inputs_without_value(flat: &FlatModel) -> Vec<Diagnostic> {
    let mut inside: BTreeMap<VarId, bool> = flat.given.iter().map(|&v| (v, true)).collect();
    for e in &flat.equations {
        for v in flat.exprs.dependencies(&[e.lhs, e.rhs]).vars {
            let own = flat.variables[v.index()].origin.instance;
            let bound = e.origin.kind == OriginKind::Binding && as_var(&flat.exprs, e.lhs) == Some(v);
            if let Some(only_inside) = inside.get_mut(&v) {
                *only_inside &= e.origin.instance == own && !bound;
            }
        }
    }
    let missing = inside.into_iter().filter(|(_, only_inside)| *only_inside).map(|(v, _)| v);
    let describe = |v: VarId| {
        let variable = &flat.variables[v.index()];
        let info = &flat.instances[variable.origin.instance as usize];
        Diagnostic::new(Code::NoInput, format!("the input `{}` has no value", variable.name))
            .at(info.span, "nothing is connected to it here")
            .at(variable.origin.span, "declared as `input`")
            .instance(info.name.clone())
            .class(info.class.clone())
            .help(format!("connect a signal to it, or give it a value: `{}(... = value)`", last(&info.name)))
    };
    missing.take(MOST).map(describe).collect()
}

/// Leaf components whose own equations do not match their own unknowns.
fn local_balance(flat: &FlatModel) -> Vec<Diagnostic> {
    let counts = Counts::of(flat);
    let mut told: BTreeSet<&str> = BTreeSet::new();
    let mut found = Vec::new();
    for (i, info) in flat.instances.iter().enumerate() {
        if !counts.is_leaf(flat, i) || counts.have[i] == counts.need[i] || !told.insert(&info.class) {
            continue;
        }
        found.push(unbalanced(flat, &counts, i));
        if found.len() == MOST {
            break;
        }
    }
    found
}

/// Equations and unknowns by instance.
struct Counts {
    have: Vec<usize>,
    need: Vec<usize>,
    ports: Vec<usize>,
    own: Vec<usize>,
    composite: Vec<bool>,
}

impl Counts {
    fn of(flat: &FlatModel) -> Counts {
        let n = flat.instances.len();
        let zeros = || vec![0; n];
        let mut composite = vec![false; n];
        for (k, info) in flat.instances.iter().enumerate().skip(1) {
            composite[info.parent as usize] |= !flat.is_port[k];
        }
        let mut c = Counts { have: zeros(), need: zeros(), ports: zeros(), own: zeros(), composite };
        let given: BTreeSet<VarId> = flat.given.iter().copied().collect();
        for (i, v) in flat.variables.iter().enumerate() {
            if v.variability <= Variability::Parameter || v.input || given.contains(&VarId(i as u32)) {
                continue;
            }
            let at = v.origin.instance as usize;
            match owner(flat, at) {
                // A port brings as many equations from outside as it has flows.
                Some(component) if v.flow => {
                    c.need[component] += 1;
                    c.ports[component] += 1;
                }
                Some(_) => {}
                None => {
                    c.need[at] += 1;
                    c.own[at] += 1;
                }
            }
        }
        for e in flat.equations.iter().filter(|e| counts_here(e, flat, &given)) {
            c.have[component_of(flat, e.origin)] += 1;
        }
        let mut assigned = BTreeSet::new();
        for action in flat.whens.iter().flat_map(|w| &w.branches).flat_map(|b| &b.actions) {
            if let WhenAction::Assign { variable, origin, .. } = action
                && assigned.insert(*variable)
            {
                c.have[component_of(flat, *origin)] += 1;
            }
        }
        c
    }

    /// A component without components of its own, but for ports, whose ports carry potentials and flows in pairs.
    fn is_leaf(&self, flat: &FlatModel, i: usize) -> bool {
        !flat.is_port[i] && !self.composite[i]
    }
}

fn counts_here(e: &Equation, flat: &FlatModel, given: &BTreeSet<VarId>) -> bool {
    match e.origin.kind {
        OriginKind::Declared => true,
        OriginKind::Binding => as_var(&flat.exprs, e.lhs).is_none_or(|v| !given.contains(&v)),
        _ => false,
    }
}

/// The component a port belongs to; `None` if the instance is no port.
fn owner(flat: &FlatModel, mut i: usize) -> Option<usize> {
    let mut port = false;
    while flat.is_port[i] {
        port = true;
        i = flat.instances[i].parent as usize;
    }
    port.then_some(i)
}

fn component_of(flat: &FlatModel, origin: Origin) -> usize {
    let i = origin.instance as usize;
    owner(flat, i).unwrap_or(i)
}

fn plural(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

fn unbalanced(flat: &FlatModel, counts: &Counts, i: usize) -> Diagnostic {
    let info = &flat.instances[i];
    let (have, need) = (counts.have[i], counts.need[i]);
    let mut d =
        Diagnostic::new(Code::Balance, format!("`{}` has {} but needs {need}", info.class, plural(have, "equation")))
            .at(info.span, if i == 0 { "this model" } else { "used here" })
            .class(info.class.clone())
            .note(format!(
                "needed: one equation for each own variable ({}) and one for each flow of its ports ({})",
                counts.own[i], counts.ports[i]
            ));
    if i > 0 {
        d = d.instance(info.name.clone());
    }
    let equations: Vec<&Equation> = flat
        .equations
        .iter()
        .filter(|e| component_of(flat, e.origin) == i && e.origin.kind == OriginKind::Declared)
        .collect();
    for (k, e) in equations.iter().take(6).enumerate() {
        d = d.at(e.origin.span, format!("equation {} of {have}", k + 1));
    }
    let silent = unmentioned(flat, i);
    if have < need && !silent.is_empty() {
        let names: Vec<String> = silent.iter().take(5).map(|n| format!("`{n}`")).collect();
        d = d.note(format!("no equation of it mentions {}", names.join(", ")));
    }
    if have < need {
        let missing = need - have;
        let two_port = counts.ports[i] == 2 && missing == 1;
        d.help(if two_port {
            "a two-port without storage usually adds that its flows sum up to zero, as in `a.q + b.q = 0;`".into()
        } else {
            format!("add {}", plural(missing, "equation"))
        })
    } else {
        d.help(format!("remove {}, or declare what they determine", plural(have - need, "equation")))
    }
}

/// Unknowns of a component, its ports included, that none of its own equations mentions.
fn unmentioned(flat: &FlatModel, i: usize) -> Vec<String> {
    let mut seen: BTreeSet<VarId> = BTreeSet::new();
    for e in flat.equations.iter().filter(|e| component_of(flat, e.origin) == i) {
        if matches!(e.origin.kind, OriginKind::Declared | OriginKind::Binding) {
            let found = flat.exprs.dependencies(&[e.lhs, e.rhs]);
            seen.extend(found.vars);
            seen.extend(found.ders);
        }
    }
    let prefix = if flat.instances[i].name.is_empty() { String::new() } else { format!("{}.", flat.instances[i].name) };
    let mine = flat.variables.iter().enumerate().filter(|(k, v)| {
        v.variability > Variability::Parameter
            && component_of(flat, v.origin) == i
            && !seen.contains(&VarId(*k as u32))
            && !flat.given.contains(&VarId(*k as u32))
    });
    mine.map(|(_, v)| v.name.strip_prefix(&prefix).unwrap_or(&v.name).to_string()).collect()
}

/// Ports that nothing is connected to, if holding their potentials would make the model sound.
fn open_ports(flat: &FlatModel, solvable: &dyn Fn(&FlatModel) -> bool) -> Vec<Diagnostic> {
    let open: Vec<usize> =
        (0..flat.equations.len()).filter(|&i| flat.equations[i].origin.kind == OriginKind::OpenPort).collect();
    if open.is_empty() {
        return Vec::new();
    }
    let blamed: Vec<usize> = open.iter().copied().filter(|&i| solvable(&held(flat, &[i]))).take(MOST).collect();
    let blamed = match blamed.is_empty() {
        true if solvable(&held(flat, &open)) => open,
        _ => blamed,
    };
    blamed.into_iter().take(MOST).map(|i| open_port(flat, &flat.equations[i])).collect()
}

/// The model with the potential of some open ports held instead of their flow.
fn held(flat: &FlatModel, open: &[usize]) -> FlatModel {
    let mut changed = flat.clone();
    for &i in open {
        let Some(flow) = as_var(&flat.exprs, flat.equations[i].lhs) else { continue };
        let port = flat.variables[flow.index()].origin.instance;
        let potential = flat.variables.iter().position(|v| v.origin.instance == port && !v.flow);
        if let Some(p) = potential {
            changed.equations[i].lhs = changed.exprs.var(VarId(p as u32));
            changed.equations[i].rhs = Exprs::ONE;
        }
    }
    changed
}

fn open_port(flat: &FlatModel, e: &Equation) -> Diagnostic {
    let flow = as_var(&flat.exprs, e.lhs).map_or("", |v| &flat.variables[v.index()].name);
    let port = flow.rsplit_once('.').map_or(flow, |(p, _)| p);
    let info = &flat.instances[e.origin.instance as usize];
    let component = &flat.instances[info.parent as usize];
    let place = if component.name.is_empty() { info.span } else { component.span };
    Diagnostic::new(Code::OpenPort, format!("port `{port}` is not connected"))
        .at(place, format!("its port `{}` appears in no `connect`", last(port)))
        .at(info.span, "the port")
        .instance(component.name.clone())
        .class(component.class.clone())
        .note(format!("an open port means `{flow} = 0`: with that the equations do not determine everything"))
        .help(format!("connect it, as in `connect({port}, ...)`, or close it on purpose with a plug"))
}

fn as_var(exprs: &Exprs, e: ExprId) -> Option<VarId> {
    match exprs.node(e) {
        Node::Var(v) => Some(v),
        _ => None,
    }
}

fn last(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}
