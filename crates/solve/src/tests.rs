//! Systems built by hand, run whole.

mod events;
mod integration;

use crate::lower::{ExecutableSystem, LoweringOptions, lower};
use crate::{Control, RecordedInput, RunResult, Settings, signals, simulate};
use bramah_expr::{ExprId, Exprs, RelationalOp, VarId};
use bramah_model::flat::{ElementOrigin, FlatEquation, FlatVariable, OriginKind, ScalarType, Variability};
use bramah_model::structure::{
    AlgebraicLoop, BltBlock, CrossingKind, Dae, EventAction, EventActionKind, ExplicitAssignment, SampleEvent, Unknown,
    ZeroCrossing,
};
use bramah_results::Trajectory;
use bramah_syntax::diag::{FileId, Span};
use std::sync::Arc;

const ORIGIN: ElementOrigin =
    ElementOrigin { span: Span { file: FileId(0), start: 0, end: 0 }, instance: 0, kind: OriginKind::Declared };

/// A plain continuous variable.
pub fn variable(name: &str) -> FlatVariable {
    FlatVariable::plain(name, ScalarType::Real, Variability::Continuous, ORIGIN)
}

/// Builds a sorted model: calls stand in the order of evaluation.
#[derive(Default)]
struct Make {
    dae: Dae,
}

impl Make {
    fn e(&mut self) -> &mut Exprs {
        &mut self.dae.exprs
    }

    fn num(&mut self, value: f64) -> ExprId {
        self.e().num(value)
    }

    fn var(&mut self, v: VarId) -> ExprId {
        self.e().var(v)
    }

    fn add(&mut self, variable: FlatVariable) -> VarId {
        self.dae.variables.push(variable);
        VarId(self.dae.variables.len() as u32 - 1)
    }

    /// A state with its initial value.
    fn state(&mut self, name: &str, start: f64) -> (VarId, ExprId) {
        let start = self.num(start);
        let v = self.add(FlatVariable { start: Some(start), fixed: true, ..variable(name) });
        self.dae.states.push(v);
        let assign = self.made(Unknown::Var(v), start);
        self.dae.initial.push(BltBlock::Assign(assign));
        (v, self.dae.exprs.var(v))
    }

    fn parameter(&mut self, name: &str, value: f64) -> ExprId {
        let binding = Some(self.num(value));
        let v = self.add(FlatVariable { binding, variability: Variability::Parameter, ..variable(name) });
        self.dae.parameters.push(v);
        self.var(v)
    }

    fn discrete(&mut self, name: &str, start: f64) -> (VarId, ExprId) {
        let start = Some(self.num(start));
        let v = self.add(FlatVariable { start, variability: Variability::Discrete, ..variable(name) });
        self.dae.discrete.push(v);
        (v, self.dae.exprs.var(v))
    }

    fn made(&mut self, unknown: Unknown, value: ExprId) -> ExplicitAssignment {
        let lhs = match unknown {
            Unknown::Var(v) => self.dae.exprs.var(v),
            Unknown::Der(v) => self.dae.exprs.der(v),
        };
        self.dae.equations.push(FlatEquation { lhs, rhs: value, origin: ORIGIN });
        ExplicitAssignment { unknown, value, equation: self.dae.equations.len() as u32 - 1 }
    }

    /// A continuous assignment, in all three systems.
    fn assign(&mut self, unknown: Unknown, value: ExprId) {
        let assign = self.made(unknown, value);
        for blocks in [&mut self.dae.continuous, &mut self.dae.event, &mut self.dae.initial] {
            blocks.push(BltBlock::Assign(assign));
        }
    }

    fn algebraic(&mut self, name: &str, value: ExprId) -> ExprId {
        let v = self.add(variable(name));
        self.assign(Unknown::Var(v), value);
        self.var(v)
    }

    /// A discrete assignment, at events and at the start.
    fn assign_discrete(&mut self, v: VarId, value: ExprId) {
        let assign = self.made(Unknown::Var(v), value);
        self.dae.event.push(BltBlock::Assign(assign));
        self.dae.initial.push(BltBlock::Assign(assign));
    }

    /// The mode of a relation with a root function.
    fn relation(&mut self, name: &str, rel: RelationalOp, left: ExprId, right: ExprId) -> ExprId {
        let (mode, e) = self.discrete(name, 0.0);
        self.dae.crossings.push(ZeroCrossing { mode, kind: CrossingKind::Relation(rel, left, right), origin: ORIGIN });
        let value = self.dae.exprs.rel(rel, left, right);
        self.assign_discrete(mode, value);
        e
    }

    /// The mode of `time >= at`.
    fn after(&mut self, name: &str, at: ExprId) -> ExprId {
        let (mode, e) = self.discrete(name, 0.0);
        self.dae.crossings.push(ZeroCrossing { mode, kind: CrossingKind::Time(RelationalOp::Ge, at), origin: ORIGIN });
        let time = self.e().time();
        let value = self.e().rel(RelationalOp::Ge, time, at);
        self.assign_discrete(mode, value);
        e
    }

    fn sample(&mut self, start: f64, interval: f64) -> ExprId {
        let (mode, e) = self.discrete("sample", 0.0);
        self.dae.discrete.pop();
        let (start, interval) = (self.num(start), self.num(interval));
        self.dae.samples.push(SampleEvent { mode, start, interval, origin: ORIGIN });
        e
    }

    /// True in the pass in which a discrete variable becomes true, not during initialization.
    fn edge(&mut self, e: ExprId) -> ExprId {
        let bramah_expr::ExprNode::Var(v) = self.dae.exprs.node(e) else { panic!("a variable") };
        let before = self.e().pre(v);
        let not_before = self.e().not(before);
        let initial = self.e().intern(bramah_expr::ExprNode::Initial);
        let running = self.e().not(initial);
        let edge = self.e().and(e, not_before);
        self.e().and(running, edge)
    }

    /// `when condition then v = value`.
    fn when(&mut self, condition: ExprId, v: VarId, value: ExprId) {
        let fires = self.edge(condition);
        let before = self.e().pre(v);
        let value = self.e().if_(fires, value, before);
        self.assign_discrete(v, value);
    }

    fn reinit(&mut self, condition: ExprId, x: VarId, value: ExprId) {
        let fires = self.edge(condition);
        self.dae.actions.push(EventAction { fires, kind: EventActionKind::Reinit(x, value), origin: ORIGIN });
    }

    /// A loop in all three systems.
    fn torn(&mut self, tearing: Vec<Unknown>, residuals: Vec<ExprId>, linear: bool) {
        let zero = self.num(0.0);
        let residuals = residuals
            .into_iter()
            .map(|lhs| {
                self.dae.equations.push(FlatEquation { lhs, rhs: zero, origin: ORIGIN });
                (lhs, self.dae.equations.len() as u32 - 1)
            })
            .collect();
        let torn = AlgebraicLoop { tearing, inner: vec![], residuals, linear };
        for blocks in [&mut self.dae.continuous, &mut self.dae.event, &mut self.dae.initial] {
            blocks.push(BltBlock::Loop(torn.clone()));
        }
    }

    fn system(self) -> ExecutableSystem {
        lower(Arc::new(self.dae), &LoweringOptions::INTERPRETED)
    }
}

/// Runs and records all variables.
fn run(system: &ExecutableSystem, settings: Settings, inputs: &[RecordedInput]) -> (RunResult, Trajectory) {
    let wanted: Vec<VarId> = (0..system.dae.variables.len() as u32).map(VarId).collect();
    let mut trajectory = Trajectory::new(signals(&system.dae, &wanted));
    let settings = Settings { wanted, ..settings };
    let run = simulate(system, &settings, inputs, None, &mut trajectory, &mut Control::default());
    (run, trajectory)
}

fn last(trajectory: &Trajectory, name: &str) -> f64 {
    *trajectory.column(name).expect("recorded").last().expect("not empty")
}
