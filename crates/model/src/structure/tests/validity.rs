//! What must hold for every sorted system: each unknown is computed once, from what is known by then.

use super::super::{AlgebraicLoop, Alias, BltBlock, Dae, ExplicitAssignment, Unknown};
use crate::flat::{ScalarType, Variability};
use bramah_expr::{ExprId, ExprNode};
use std::collections::BTreeSet;

/// Panics where a system breaks the rules.
pub fn check(dae: &Dae) {
    let given = given(dae);
    let states: BTreeSet<Unknown> = dae.states.iter().map(|&v| Unknown::Var(v)).collect();
    let discrete: BTreeSet<Unknown> = dae.discrete.iter().map(|&v| Unknown::Var(v)).collect();
    let free: BTreeSet<Unknown> = dae.free_parameters.iter().map(|&v| Unknown::Var(v)).collect();
    let join = |sets: &[&BTreeSet<Unknown>]| sets.iter().flat_map(|s| s.iter().copied()).collect();
    let continuous = System::run(dae, join(&[&given, &states, &discrete, &free]), &dae.continuous);
    let event = System::run(dae, join(&[&given, &states, &free]), &dae.event);
    let initial = System::run(dae, given.clone(), &dae.initial);
    let mut expected: BTreeSet<Unknown> = dae.states.iter().map(|&v| Unknown::Der(v)).collect();
    expected.extend(algebraic(dae).difference(&states));
    assert_eq!(continuous, expected, "continuous unknowns");
    expected.extend(&discrete);
    assert_eq!(event, expected, "event unknowns");
    expected.extend(&states);
    expected.extend(&free);
    assert_eq!(initial, expected, "initial unknowns");
    check_aliases(dae);
}

/// Known without any system.
fn given(dae: &Dae) -> BTreeSet<Unknown> {
    let parameters = dae.parameters.iter().chain(&dae.inputs).copied();
    parameters.chain(dae.samples.iter().map(|s| s.mode)).map(Unknown::Var).collect()
}

/// Continuous variables that are no aliases.
fn algebraic(dae: &Dae) -> BTreeSet<Unknown> {
    let aliased: BTreeSet<_> = dae.aliases.iter().map(|a| a.variable).collect();
    let ids = (0..dae.variables.len() as u32).map(bramah_expr::VarId);
    let real = ids.filter(|v| {
        let variable = &dae.variables[v.index()];
        variable.ty == ScalarType::Real && variable.variability == Variability::Continuous && !variable.input
    });
    real.filter(|v| !aliased.contains(v) && !dae.discrete.contains(v)).map(Unknown::Var).collect()
}

fn check_aliases(dae: &Dae) {
    let aliased: BTreeSet<_> = dae.aliases.iter().map(|a| a.variable).collect();
    for Alias { variable, target, .. } in &dae.aliases {
        assert!(!aliased.contains(target), "{} leads to another alias", dae.name(*variable));
    }
}

struct System<'a> {
    dae: &'a Dae,
    known: BTreeSet<Unknown>,
    solved: BTreeSet<Unknown>,
}

impl System<'_> {
    fn run(dae: &Dae, known: BTreeSet<Unknown>, blocks: &[BltBlock]) -> BTreeSet<Unknown> {
        let mut system = System { dae, known, solved: BTreeSet::new() };
        blocks.iter().for_each(|b| system.block(b));
        system.solved
    }

    fn block(&mut self, block: &BltBlock) {
        match block {
            BltBlock::Assign(assign) => self.assign(assign),
            BltBlock::Loop(found) => self.torn(found),
            BltBlock::Mixed(mixed) => {
                let discrete: Vec<Unknown> = mixed.discrete.iter().map(|a| a.unknown).collect();
                self.known.extend(&discrete);
                mixed.continuous.iter().for_each(|b| self.block(b));
                for assign in &mixed.discrete {
                    self.uses(assign.value);
                    assert!(self.solved.insert(assign.unknown));
                }
            }
        }
    }

    fn torn(&mut self, found: &AlgebraicLoop) {
        assert_eq!(found.tearing.len(), found.residuals.len());
        for &unknown in &found.tearing {
            self.solve(unknown);
        }
        found.inner.iter().for_each(|a| self.assign(a));
        for &(residual, _) in &found.residuals {
            self.uses(residual);
        }
    }

    fn assign(&mut self, assign: &ExplicitAssignment) {
        self.uses(assign.value);
        self.solve(assign.unknown);
    }

    fn solve(&mut self, unknown: Unknown) {
        assert!(!self.known.contains(&unknown), "{} is known already", self.dae.unknown_name(unknown));
        self.known.insert(unknown);
        self.solved.insert(unknown);
    }

    fn uses(&self, e: ExprId) {
        for node in self.dae.exprs.reachable(&[e], |_| true) {
            let used = match self.dae.exprs.node(node) {
                ExprNode::Var(v) => Unknown::Var(v),
                ExprNode::Der(v) => Unknown::Der(v),
                ExprNode::EventRel(..) | ExprNode::EventFloor(_) | ExprNode::Sample(..) => panic!("an event is left"),
                _ => continue,
            };
            assert!(self.known.contains(&used), "{} is not known yet", self.dae.unknown_name(used));
        }
    }
}
