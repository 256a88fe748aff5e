//! Why equations do not determine their unknowns: the first level at which something is wrong.
//!
//! The order is: inputs without a value, the balance of each component on its own (MLS 4.8), open ports. A plain matching
//! would accuse the innocent.

use super::census::as_variable;
use super::{FlatEquation, FlatModel, OriginKind};
use bramah_expr::{Exprs, VarId};
use bramah_syntax::diag::{Code, Diagnostic};

/// Most diagnostics of one kind.
const MOST: usize = 10;

/// So many open ports are tried one by one.
const MOST_TRIED: usize = 50;

/// Messages that explain an unbalanced or singular model; empty when every component is sound on its own.
///
/// `solvable` tells whether a changed model would be determined; open ports are blamed only if closing them helps.
pub fn explain(flat: &FlatModel, solvable: &dyn Fn(&FlatModel) -> bool) -> Vec<Diagnostic> {
    if flat.doubts.is_empty() { open_ports(flat, solvable) } else { flat.doubts.clone() }
}

/// Ports that nothing is connected to, if holding their potentials would make the model sound.
fn open_ports(flat: &FlatModel, solvable: &dyn Fn(&FlatModel) -> bool) -> Vec<Diagnostic> {
    let open: Vec<usize> =
        (0..flat.equations.len()).filter(|&i| flat.equations[i].origin.kind == OriginKind::OpenPort).collect();
    if open.is_empty() {
        return Vec::new();
    }
    let few = if open.len() <= MOST_TRIED { open.as_slice() } else { &[] };
    let blamed: Vec<usize> = few.iter().copied().filter(|&i| solvable(&held(flat, &[i]))).take(MOST).collect();
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
        let Some(flow) = as_variable(flat, flat.equations[i].lhs) else { continue };
        let port = flat.variables[flow.index()].origin.instance;
        let potential = flat.variables.iter().position(|v| v.origin.instance == port && !v.flow);
        if let Some(p) = potential {
            changed.equations[i].lhs = changed.exprs.var(VarId(p as u32));
            changed.equations[i].rhs = Exprs::ONE;
        }
    }
    changed
}

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

fn last(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}
