//! Explanations for a singular model: the first level at which something is wrong.
//!
//! The levels are, in order: inputs without a value, the balance of each component by itself (MLS 4.8), open ports. A
//! matching alone would often blame a correct component, because it knows nothing of components. `compile` calls
//! [`explain`] after `structure` has found the model singular.

use super::census::as_variable;
use super::{FlatEquation, FlatModel, OriginKind};
use bramah_expr::{Exprs, VarId};
use bramah_syntax::diag::{Code, Diagnostic};

/// The most diagnostics about open ports.
const MOST: usize = 10;

/// Up to this number open ports are tried one by one; each trial is an analysis of the whole model.
const MOST_TRIED: usize = 50;

/// Messages that explain an unbalanced or singular model. Empty when every component is balanced and no open port is to
/// blame.
///
/// `solvable` says whether a changed model would be determined. Open ports are blamed only if closing them helps.
pub fn explain(flat: &FlatModel, solvable: &dyn Fn(&FlatModel) -> bool) -> Vec<Diagnostic> {
    if flat.doubts.is_empty() { open_ports(flat, solvable) } else { flat.doubts.clone() }
}

/// The open ports that make the model singular: those of which a single one helps when its potential is held, else all
/// of them if holding all helps, else none.
fn open_ports(flat: &FlatModel, solvable: &dyn Fn(&FlatModel) -> bool) -> Vec<Diagnostic> {
    let open: Vec<usize> =
        (0..flat.equations.len()).filter(|&i| flat.equations[i].origin.kind == OriginKind::OpenPort).collect();
    if open.is_empty() {
        return Vec::new();
    }
    // With many open ports the single trials would take too long; only all together are tried.
    let few = if open.len() <= MOST_TRIED { open.as_slice() } else { &[] };
    let blamed: Vec<usize> = few.iter().copied().filter(|&i| solvable(&held(flat, &[i]))).take(MOST).collect();
    let blamed = match blamed.is_empty() {
        true if solvable(&held(flat, &open)) => open,
        _ => blamed,
    };
    blamed.into_iter().take(MOST).map(|i| open_port(flat, &flat.equations[i])).collect()
}

/// A copy of the model in which the potentials of some open ports are held instead of their flows. `open` are the
/// numbers of their equations.
fn held(flat: &FlatModel, open: &[usize]) -> FlatModel {
    let mut changed = flat.clone();
    for &i in open {
        let Some(flow) = as_variable(flat, flat.equations[i].lhs) else { continue };
        let port = flat.variables[flow.index()].origin.instance;
        let potential = flat.variables.iter().position(|v| v.origin.instance == port && !v.flow);
        if let Some(p) = potential {
            changed.equations[i].lhs = changed.exprs.var(VarId(p as u32));
            // Any value does; only the structure is of interest.
            changed.equations[i].rhs = Exprs::ONE;
        }
    }
    changed
}

/// The message about one open port, given the equation that makes its flow 0.
fn open_port(flat: &FlatModel, e: &FlatEquation) -> Diagnostic {
    let flow = as_variable(flat, e.lhs).map_or("", |v| &flat.variables[v.index()].name);
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

/// The part of a name after its last dot.
fn last(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}
