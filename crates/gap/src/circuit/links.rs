//! Signals inside the model: what an equation or a `connect` of its top level gives to an input of a component.
//!
//! Effects on commands may act there too, as on a valve whose command a controller in the model computes.
//! Enters: the topology, the instance tree, the connections and the flat equations. Leaves: [`SignalLink`] entries.
//! `augment` later replaces the statement of such a signal.

use super::{CircuitTopology, ModelInput};
use bramah_expr::{ExprId, ExprNode as Term, VarId};
use bramah_model::flat::{FlatEquation, FlatModel, OriginKind, ScalarType, Variability};
use bramah_model::instance::Instance;
use bramah_model::network::Network;
use bramah_model::shipped::ShippedWorld;
use bramah_syntax::ast::{CausalityPrefix, Class, ClassBody, ElementKind, Equation, EquationKind};
use bramah_syntax::diag::{FileId, Sources, Span};
use bramah_syntax::world::World;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A signal that a component receives.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalLink {
    /// The receiving variable, with its unit as written.
    pub signal: ModelInput,
    /// Source expression as written.
    pub value: String,
    /// Inputs of the model, if the signal follows from these alone; else empty.
    pub inputs: Vec<String>,
    /// File of the statement.
    pub file: PathBuf,
    /// Bytes of the statement in the file.
    pub statement: Range<usize>,
}

/// A signal whose statement is known by its position only.
pub struct UnresolvedLink {
    /// The receiving variable.
    signal: ModelInput,
    /// Inputs of the model, if the signal follows from these alone.
    inputs: Vec<String>,
    /// Position of the statement.
    span: Span,
}

/// Signals of a model that are set by one statement each, from equations first and from connections then.
pub fn placed(
    circuit: &CircuitTopology,
    instance: &Instance<'_, '_>,
    network: &Network,
    flat: &FlatModel,
) -> Vec<UnresolvedLink> {
    let links = SignalLinkFinder { circuit, flat };
    let mut all: Vec<UnresolvedLink> = flat.equations.iter().filter_map(|e| links.of_equation(e)).collect();
    let top = network.signals.iter().filter(|p| instance.scope(p.scope).name.is_empty());
    for pair in top {
        let sides = [pair.a, pair.b].map(|i| &instance.variables[i as usize]);
        // the receiver must be an input of a component, not of a port
        let receives =
            |i: usize| sides[i].causality == Some(CausalityPrefix::Input) && links.is_of_component(&sides[i].name);
        let receiver = (0..2).find(|&i| receives(i) && !receives(1 - i));
        let link = receiver.and_then(|i| links.of_variable(&sides[i].name, &sides[1 - i].name, pair.span));
        all.extend(link);
    }
    let mut statements: BTreeMap<(u32, u32, u32), usize> = BTreeMap::new();
    let key = |p: &UnresolvedLink| (p.span.file.0, p.span.start, p.span.end);
    all.iter().for_each(|p| *statements.entry(key(p)).or_default() += 1);
    // a statement in a loop or between arrays sets several signals and cannot be replaced for one
    all.retain(|p| statements[&key(p)] == 1);
    all
}

/// Reads the statements of the signals. Signals whose statement is not found are left out.
pub fn read(placed: Vec<UnresolvedLink>, sources: &Sources) -> Vec<SignalLink> {
    let mut files: BTreeMap<FileId, Vec<Class>> = BTreeMap::new();
    let link = |p: UnresolvedLink| {
        let source = sources.get(p.span.file);
        // a class of the shipped library is read from there, so that a changed text has no effect
        if ShippedWorld.read(Path::new(&source.path)).is_ok() {
            return None;
        }
        let parsed = || bramah_syntax::parse(p.span.file, &source.text).tree.classes;
        let classes = files.entry(p.span.file).or_insert_with(parsed);
        let equation = classes.iter().find_map(|c| statement(c, p.span))?;
        let (EquationKind::Equal(a, b) | EquationKind::Connect(a, b)) = &equation.kind else { return None };
        let (a, b) = (a.to_string(), b.to_string());
        let value = if a == p.signal.name { b } else { a };
        let statement = p.span.start as usize..p.span.end as usize;
        Some(SignalLink { signal: p.signal, value, inputs: p.inputs, file: PathBuf::from(&source.path), statement })
    };
    placed.into_iter().filter_map(link).collect()
}

/// The equation of a class, or of a class inside it, at exactly this position.
fn statement(class: &Class, span: Span) -> Option<&Equation> {
    let ClassBody::Long(body) = &class.body else { return None };
    let own = body.equations.iter().find(|e| (e.span.start, e.span.end) == (span.start, span.end));
    own.or_else(|| {
        body.elements.iter().find_map(|e| match &e.kind {
            ElementKind::Class(c) => statement(c, span),
            _ => None,
        })
    })
}

/// Finds signals in equations and connections.
struct SignalLinkFinder<'a> {
    /// Topology of the nominal model.
    circuit: &'a CircuitTopology,
    /// Its flat equations.
    flat: &'a FlatModel,
}

impl SignalLinkFinder<'_> {
    /// The signal that an equation of the top level gives to a component; `None` for other equations.
    /// The receiver is a variable of a component on the left side, and the right side changes in time.
    fn of_equation(&self, e: &FlatEquation) -> Option<UnresolvedLink> {
        if e.origin.instance != 0 || e.origin.kind != OriginKind::Declared {
            return None;
        }
        let exprs = &self.flat.exprs;
        // the receiver stands on the left, as in `valve.u = k*e`; `w = shaft.w` only reads a component
        let Term::Var(v) = exprs.node(e.lhs) else { return None };
        let leaves = exprs.dependencies(&[e.rhs]);
        let apart = !leaves.vars.contains(&v) && !leaves.ders.contains(&v) && !leaves.pres.contains(&v);
        // an equation that contains its left side on the right is a loop, no assignment
        if !apart || !self.is_of_component(&self.flat.variables[v.index()].name) {
            return None;
        }
        let moving: Vec<VarId> = leaves.vars.into_iter().filter(|v| self.moves(*v)).collect();
        // a constant is no command
        if moving.is_empty() && leaves.ders.is_empty() && !leaves.time {
            return None;
        }
        let alone = leaves.ders.is_empty() && !leaves.time && moving.iter().all(|v| self.is_input(*v));
        let names = moving.iter().map(|v| self.flat.variables[v.index()].name.clone());
        let inputs = if alone { names.collect() } else { Vec::new() };
        // an input used only here is a place already: the input itself
        if matches!(exprs.node(e.rhs), Term::Var(u) if self.is_input(u) && self.uses(u) == 1) {
            return None;
        }
        self.placed(v, inputs, e.origin.span)
    }

    /// The signal that a connection gives to `receiver`; `None` if the source is constant or a place already.
    fn of_variable(&self, receiver: &str, source: &str, span: Span) -> Option<UnresolvedLink> {
        let (receiver, source) = (self.variable(receiver)?, self.variable(source)?);
        if self.is_input(source) && self.uses(source) == 1 || !self.moves(source) {
            return None;
        }
        let inputs =
            if self.is_input(source) { vec![self.flat.variables[source.index()].name.clone()] } else { vec![] };
        self.placed(receiver, inputs, span)
    }

    /// A link to a continuous Real variable that is no flow.
    fn placed(&self, receiver: VarId, inputs: Vec<String>, span: Span) -> Option<UnresolvedLink> {
        let v = &self.flat.variables[receiver.index()];
        let real = v.ty == ScalarType::Real && v.variability == Variability::Continuous && !v.flow;
        let number = |e: Option<ExprId>| e.and_then(|e| self.flat.exprs.as_num(e));
        let (name, unit) = (v.name.clone(), v.unit.as_deref().unwrap_or("").to_string());
        let signal = ModelInput { name, ty: v.ty, unit, start: None, nominal: number(v.nominal) };
        real.then_some(UnresolvedLink { signal, inputs, span })
    }

    /// Whether a variable belongs to a component itself, not to a port of it.
    fn is_of_component(&self, name: &str) -> bool {
        let owner = name.rsplit_once('.').map(|(owner, _)| owner);
        owner.is_some_and(|o| self.circuit.components.iter().any(|c| c.name == o))
    }

    /// Identifier of a variable by name.
    fn variable(&self, name: &str) -> Option<VarId> {
        super::super::problem::variable(self.flat, name)
    }

    /// Whether a variable can change in time.
    fn moves(&self, v: VarId) -> bool {
        self.flat.variables[v.index()].variability > Variability::Parameter
    }

    /// Whether a variable is an input of the model.
    fn is_input(&self, v: VarId) -> bool {
        self.flat.variables[v.index()].input
    }

    /// Number of equations in which a variable occurs; an input with one use is a place by itself.
    fn uses(&self, v: VarId) -> usize {
        let holds = |e: &&FlatEquation| self.flat.exprs.dependencies(&[e.lhs, e.rhs]).vars.contains(&v);
        self.flat.equations.iter().filter(holds).count()
    }
}
