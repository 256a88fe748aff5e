//! The balance of every component by itself: it must bring as many equations as it owes (MLS 4.8).
//!
//! Enters: the census and the signal connections. Leaves: doubts, kept in `FlatModel::doubts` and reported only if the
//! whole model turns out to be singular. So a component that an unusual but valid circuit completes is not blamed.
//! Ports are checked before, in `ports`.

use super::census::{BalanceCensus, BalanceRole};
use super::ports::SignalConnections;
use super::{FlatEquation, FlatModel, OriginKind};
use crate::instance::{Instance, ScopeId};
use bramah_expr::VarId;
use bramah_syntax::diag::{Code, Diagnostic};
use rustc_hash::FxHashSet;

/// The most places that a message shows.
const MOST_PLACES: usize = 6;

/// What seems wrong, at the first level that shows anything: signals, then each component, then the whole model. One
/// message for each class, since all its instances have the same fault.
///
/// Components that cannot be judged alone are skipped. If no component is found wrong, the whole model is counted.
pub(super) fn doubts(
    instance: &Instance<'_, '_>,
    signals: &SignalConnections<'_>,
    flat: &FlatModel,
    census: &BalanceCensus,
    scopes: &[ScopeId],
) -> Vec<Diagnostic> {
    let found = signals.doubts();
    if !found.is_empty() {
        return found;
    }
    let mut blamed: FxHashSet<&str> = FxHashSet::default();
    let mut found = Vec::new();
    for (i, &owner) in (0u32..).zip(&census.owner) {
        let at = i as usize;
        // Only instances that are components of their own are judged.
        if owner != i || census.unjudged[at] || census.owed[at] == census.brought[at] {
            continue;
        }
        if blamed.insert(&flat.instances[at].class) {
            found.push(BalanceChecker { instance, flat, census, scopes, at: i }.verdict());
        }
    }
    if found.is_empty() { whole(flat, census).into_iter().collect() } else { found }
}

/// The count of the whole model, where some components could not be judged alone. `None` where it is balanced or all
/// components were judged.
///
/// The code is E202. Equations of connections count here, and so do the inputs of components, which are unknowns.
fn whole(flat: &FlatModel, census: &BalanceCensus) -> Option<Diagnostic> {
    if !census.unjudged.contains(&true) {
        return None;
    }
    let given: usize = flat.variables.iter().filter(|v| v.input).count();
    let unknowns = census.role.iter().filter(|r| **r != BalanceRole::Fixed).count() - given;
    // Variables assigned in `when` clauses count as equations, each once.
    let assigned: FxHashSet<VarId> = flat.whens.iter().flat_map(super::WhenClause::assigned).collect();
    let equations = flat.equations.len() + assigned.len();
    if equations == unknowns {
        return None;
    }
    let word = if equations < unknowns { "few" } else { "many" };
    let span = flat.instances[0].span;
    Some(
        Diagnostic::new(Code::GlobalBalance, format!("`{}` has too {word} equations", flat.class))
            .at(span, format!("{equations} equations for {unknowns} unknowns"))
            .note("some ports have variables that are neither pairs of potential and flow nor inputs and outputs, so no component can be judged alone")
            .help("give each port as many flows as potentials, and mark signals `input` or `output`"),
    )
}

/// Makes the message about one component with the wrong number of equations.
/// It is made only for components whose counts differ.
struct BalanceChecker<'j, 'a, 'l> {
    /// The component tree, for places of declarations.
    instance: &'j Instance<'a, 'l>,
    /// The flat model.
    flat: &'j FlatModel,
    /// The counts.
    census: &'j BalanceCensus,
    /// The scopes of all instances.
    scopes: &'j [ScopeId],
    /// The component.
    at: u32,
}

impl BalanceChecker<'_, '_, '_> {
    /// The message: counts, what the equations are needed for, and places.
    ///
    /// The code is E201. The first place is the name of the class, since the fault is in the class and not in one
    /// instance.
    fn verdict(&self) -> Diagnostic {
        let (owed, brought) = (self.census.owed[self.at as usize], self.census.brought[self.at as usize]);
        let info = &self.flat.instances[self.at as usize];
        let plural = if brought == 1 { "equation" } else { "equations" };
        let message = format!("`{}` has {brought} {plural} but needs {owed}", info.class);
        let class = self.instance.scope(self.scopes[self.at as usize]).template.class;
        let name = self.instance.library.class(class).name.span;
        let text =
            if brought < owed { format!("{} too few", owed - brought) } else { format!("{} too many", brought - owed) };
        let mut made = Diagnostic::new(Code::Balance, message).at(name, text).class(info.class.clone());
        if !info.name.is_empty() {
            made = made.instance(info.name.clone());
        }
        made = self.needed(made);
        if brought < owed { self.too_few(made, owed - brought) } else { self.too_many(made, brought) }
    }

    /// Adds a note that says what the needed equations are for: ports, own variables, inputs of components.
    fn needed(&self, made: Diagnostic) -> Diagnostic {
        let of = |role: BalanceRole| -> Vec<String> {
            let all = (0..self.census.role.len()).filter(|&i| self.census.role[i] == role);
            all.filter(|&i| self.census.holder[i] == self.at).map(|i| self.local(i)).collect()
        };
        let (own, flows) = (of(BalanceRole::Own), of(BalanceRole::Flow));
        let mut parts = Vec::new();
        if !flows.is_empty() {
            parts.push(format!("one for each port ({}: {})", flows.len(), listed(&flows)));
        }
        if !own.is_empty() {
            parts.push(format!("one for each variable of its own ({}: {})", own.len(), listed(&own)));
        }
        let rest = self.census.owed[self.at as usize] - own.len() - flows.len();
        if rest > 0 {
            parts.push(format!("one for each input of its components ({rest})"));
        }
        if parts.is_empty() { made } else { made.note(format!("needed: {}", parts.join(", "))) }
    }

    /// Adds the variables that no equation mentions. A two-port that lacks one equation gets advice to balance its
    /// flows.
    /// At most [`MOST_PLACES`] variables are shown. A variable inside a port is shown at the port.
    fn too_few(&self, mut made: Diagnostic, missing: usize) -> Diagnostic {
        let mentioned = self.mentioned();
        let mut shown = 0;
        for (i, v) in self.flat.variables.iter().enumerate() {
            let counts =
                matches!(self.census.role[i], BalanceRole::Own | BalanceRole::Flow) && self.census.holder[i] == self.at;
            let id = VarId(u32::try_from(i).expect("limited sizes"));
            if counts && !mentioned.contains(&id) && shown < MOST_PLACES {
                let holder = &self.flat.instances[v.origin.instance as usize];
                let span = if v.origin.instance == self.at { v.origin.span } else { holder.span };
                made = made.at(span, format!("no equation mentions `{}`", self.local(i)));
                shown += 1;
            }
        }
        let flows = (0..self.census.role.len())
            .filter(|&i| self.census.holder[i] == self.at && self.census.role[i] == BalanceRole::Flow)
            .map(|i| self.local(i))
            .collect::<Vec<_>>();
        match flows.as_slice() {
            [a, b] if missing == 1 && shown < 2 => {
                made.help(format!("a two-port without storage usually adds `{a} + {b} = 0`"))
            }
            _ => made.help("add the equations that are missing, or remove variables that nothing needs"),
        }
    }

    /// Adds the equations of the component, or the one that contains no unknown.
    /// If the component has bindings, the help says that a variable with a binding needs no further equation.
    fn too_many(&self, mut made: Diagnostic, brought: usize) -> Diagnostic {
        let own: Vec<&FlatEquation> = self.equations().collect();
        let idle = |e: &&&FlatEquation| {
            let found = self.flat.exprs.dependencies(&[e.lhs, e.rhs]);
            found.ders.is_empty() && found.vars.iter().all(|v| self.census.role[v.index()] == BalanceRole::Fixed)
        };
        if let Some(e) = own.iter().find(idle) {
            return made
                .at(e.origin.span, "this equation holds no unknown: everything in it is known before the run")
                .help("if it is meant to determine a parameter, declare that without `parameter`; else remove it");
        }
        for (i, e) in own.iter().take(MOST_PLACES).enumerate() {
            made = made.at(e.origin.span, format!("equation {} of {brought}", i + 1));
        }
        let bindings = own.iter().any(|e| e.origin.kind == OriginKind::Binding);
        made.help(if bindings {
            "a variable declared with `= value` needs no further equation: remove one of the two"
        } else {
            "remove an equation, or declare the variable that it determines"
        })
    }

    /// The equations written in the component, those of connections excluded.
    fn equations(&self) -> impl Iterator<Item = &FlatEquation> {
        let made = [OriginKind::ConnectPotential, OriginKind::ConnectFlow, OriginKind::OpenPort];
        self.flat
            .equations
            .iter()
            .filter(move |e| self.census.owner[e.origin.instance as usize] == self.at && !made.contains(&e.origin.kind))
    }

    /// Variables in equations, connections and `when`s of the component.
    /// Derivatives count as well as values. The equations of open ports do not count.
    fn mentioned(&self) -> FxHashSet<VarId> {
        let here = |instance: u32| self.census.owner[instance as usize] == self.at;
        let all =
            self.flat.equations.iter().filter(|e| here(e.origin.instance) && e.origin.kind != OriginKind::OpenPort);
        let roots: Vec<_> = all.flat_map(|e| [e.lhs, e.rhs]).collect();
        let found = self.flat.exprs.dependencies(&roots);
        let whens = self.flat.whens.iter().filter(|w| here(w.origin.instance)).flat_map(super::WhenClause::assigned);
        found.vars.into_iter().chain(found.ders).chain(whens).collect()
    }

    /// The name of a variable as seen from inside the component.
    /// Names in other components stay complete.
    fn local(&self, variable: usize) -> String {
        let name = &self.flat.variables[variable].name;
        let prefix = &self.flat.instances[self.at as usize].name;
        let cut = name.strip_prefix(prefix.as_str()).and_then(|rest| rest.strip_prefix('.'));
        cut.unwrap_or(name).to_owned()
    }
}

/// Up to eight names in backticks, joined by commas.
fn listed(names: &[String]) -> String {
    let shown: Vec<String> = names.iter().take(8).map(|n| format!("`{n}`")).collect();
    let more = if names.len() > 8 { format!(" and {} more", names.len() - 8) } else { String::new() };
    shown.join(", ") + &more
}
