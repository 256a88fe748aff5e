//! Signals inside the model: what an equation or a `connect` of its top level gives to a component. What a command suffers
//! may be suffered there too, as by a valve whose command a controller in the model computes.

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
    /// The variable that receives it, with its unit as written.
    pub signal: ModelInput,
    /// What it receives, as written.
    pub value: String,
    /// Inputs of the model, where it follows from these alone.
    pub inputs: Vec<String>,
    /// The file of the statement, and its bytes there.
    pub file: PathBuf,
    /// First byte of the statement and one past the last.
    pub statement: Range<usize>,
}

/// A signal whose statement is known by its place only.
pub struct UnresolvedLink {
    signal: ModelInput,
    inputs: Vec<String>,
    span: Span,
}

/// The signals of a model that are set once, by a statement of their own.
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
        let receives =
            |i: usize| sides[i].causality == Some(CausalityPrefix::Input) && links.is_of_component(&sides[i].name);
        let receiver = (0..2).find(|&i| receives(i) && !receives(1 - i));
        let link = receiver.and_then(|i| links.of_variable(&sides[i].name, &sides[1 - i].name, pair.span));
        all.extend(link);
    }
    let mut statements: BTreeMap<(u32, u32, u32), usize> = BTreeMap::new();
    let key = |p: &UnresolvedLink| (p.span.file.0, p.span.start, p.span.end);
    all.iter().for_each(|p| *statements.entry(key(p)).or_default() += 1);
    // a statement in a loop or between arrays gives to several
    all.retain(|p| statements[&key(p)] == 1);
    all
}

/// The same with their statements read.
pub fn read(placed: Vec<UnresolvedLink>, sources: &Sources) -> Vec<SignalLink> {
    let mut files: BTreeMap<FileId, Vec<Class>> = BTreeMap::new();
    let link = |p: UnresolvedLink| {
        let source = sources.get(p.span.file);
        // a class that comes with bramah is read from there, whatever lies over it
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

/// The statement of a class at a place; not one inside another.
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

struct SignalLinkFinder<'a> {
    circuit: &'a CircuitTopology,
    flat: &'a FlatModel,
}

impl SignalLinkFinder<'_> {
    fn of_equation(&self, e: &FlatEquation) -> Option<UnresolvedLink> {
        if e.origin.instance != 0 || e.origin.kind != OriginKind::Declared {
            return None;
        }
        let exprs = &self.flat.exprs;
        // what is given stands on the left: `valve.u = k*e`, but `w = shaft.w` only looks
        let Term::Var(v) = exprs.node(e.lhs) else { return None };
        let leaves = exprs.dependencies(&[e.rhs]);
        let apart = !leaves.vars.contains(&v) && !leaves.ders.contains(&v) && !leaves.pres.contains(&v);
        if !apart || !self.is_of_component(&self.flat.variables[v.index()].name) {
            return None;
        }
        let moving: Vec<VarId> = leaves.vars.into_iter().filter(|v| self.moves(*v)).collect();
        if moving.is_empty() && leaves.ders.is_empty() && !leaves.time {
            return None;
        }
        let alone = leaves.ders.is_empty() && !leaves.time && moving.iter().all(|v| self.is_input(*v));
        let names = moving.iter().map(|v| self.flat.variables[v.index()].name.clone());
        let inputs = if alone { names.collect() } else { Vec::new() };
        // an input that goes nowhere else is a place already
        if matches!(exprs.node(e.rhs), Term::Var(u) if self.is_input(u) && self.uses(u) == 1) {
            return None;
        }
        self.placed(v, inputs, e.origin.span)
    }

    fn of_variable(&self, receiver: &str, source: &str, span: Span) -> Option<UnresolvedLink> {
        let (receiver, source) = (self.variable(receiver)?, self.variable(source)?);
        if self.is_input(source) && self.uses(source) == 1 || !self.moves(source) {
            return None;
        }
        let inputs =
            if self.is_input(source) { vec![self.flat.variables[source.index()].name.clone()] } else { vec![] };
        self.placed(receiver, inputs, span)
    }

    fn placed(&self, receiver: VarId, inputs: Vec<String>, span: Span) -> Option<UnresolvedLink> {
        let v = &self.flat.variables[receiver.index()];
        let real = v.ty == ScalarType::Real && v.variability == Variability::Continuous && !v.flow;
        let number = |e: Option<ExprId>| e.and_then(|e| self.flat.exprs.as_num(e));
        let (name, unit) = (v.name.clone(), v.unit.as_deref().unwrap_or("").to_string());
        let signal = ModelInput { name, ty: v.ty, unit, start: None, nominal: number(v.nominal) };
        real.then_some(UnresolvedLink { signal, inputs, span })
    }

    /// Whether a variable is a component's own and no part of a port of it.
    fn is_of_component(&self, name: &str) -> bool {
        let owner = name.rsplit_once('.').map(|(owner, _)| owner);
        owner.is_some_and(|o| self.circuit.components.iter().any(|c| c.name == o))
    }

    fn variable(&self, name: &str) -> Option<VarId> {
        super::super::problem::variable(self.flat, name)
    }

    fn moves(&self, v: VarId) -> bool {
        self.flat.variables[v.index()].variability > Variability::Parameter
    }

    fn is_input(&self, v: VarId) -> bool {
        self.flat.variables[v.index()].input
    }

    /// In how many equations a variable occurs.
    fn uses(&self, v: VarId) -> usize {
        let holds = |e: &&FlatEquation| self.flat.exprs.dependencies(&[e.lhs, e.rhs]).vars.contains(&v);
        self.flat.equations.iter().filter(holds).count()
    }
}
