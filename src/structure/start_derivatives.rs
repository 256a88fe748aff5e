//! Derivatives that only initial equations ask for, as `der(y) = 0` of a `y` that is no state: unknowns of the start, each
//! determined by the derivative of the equation that determines its variable. The running system does without them.

use super::draft::{Draft, Role, RowKind};
use super::incidence::{NONE, Scanner};
use super::sorting::{System, SystemRow};
use super::{Unknown, messages};
use crate::diag::Diagnostic;
use crate::expr::differentiate::{Leaf, TimeDerivative};
use crate::expr::{ExprId, Exprs, Node, VarId};
use crate::flat::{Equation, Origin, OriginKind, Type};
use rustc_hash::FxHashMap;

/// The running system with these derivatives; nothing where there are none. Initial equations refer to them afterwards.
///
/// # Errors
/// What cannot be differentiated (E304).
pub(super) fn add(draft: &mut Draft, running: &System, states: &[VarId]) -> Result<Option<System>, Diagnostic> {
    let mut derivatives = Derivatives::new(running);
    for v in asked_for(draft, states) {
        derivatives.of(draft, Unknown::Var(v));
    }
    if derivatives.made.is_empty() {
        return Ok(None);
    }
    while let Some(unknown) = derivatives.open.pop() {
        derivatives.determine(draft, unknown)?;
    }
    let made = &derivatives.made;
    let replaced: Vec<(ExprId, ExprId)> = made
        .iter()
        .filter_map(|(unknown, d)| match unknown {
            Unknown::Var(v) => Some((draft.exprs.der(*v), draft.exprs.var(*d))),
            Unknown::Der(_) => None,
        })
        .collect();
    for equation in &mut draft.initial_equations {
        equation.lhs = draft.exprs.substitute(equation.lhs, &replaced);
        equation.rhs = draft.exprs.substitute(equation.rhs, &replaced);
    }
    Ok(Some(derivatives.extended(draft)))
}

/// Unknowns that are no states and whose derivatives stand in initial equations.
fn asked_for(draft: &Draft, states: &[VarId]) -> Vec<VarId> {
    let sides = draft.initial_equations.iter().flat_map(|e| [e.lhs, e.rhs]).collect::<Vec<_>>();
    let asked = draft.exprs.dependencies(&sides).ders;
    asked.into_iter().filter(|v| draft.role(*v) == Role::Continuous && states.binary_search(v).is_err()).collect()
}

struct Derivatives<'a> {
    running: &'a System,
    column: FxHashMap<Unknown, u32>,
    /// The derivatives of unknowns, as variables.
    made: FxHashMap<Unknown, VarId>,
    /// Unknowns whose derivatives are not determined yet.
    open: Vec<Unknown>,
    time_derivative: TimeDerivative,
    /// The rows, with the variables that they determine.
    rows: Vec<(SystemRow, VarId)>,
}

impl<'a> Derivatives<'a> {
    fn new(running: &'a System) -> Self {
        Derivatives {
            running,
            column: running.columns.iter().zip(0..).map(|(unknown, i)| (*unknown, i)).collect(),
            made: FxHashMap::default(),
            open: Vec::new(),
            time_derivative: TimeDerivative::default(),
            rows: Vec::new(),
        }
    }

    /// The derivative of an unknown of the running system.
    fn of(&mut self, draft: &mut Draft, unknown: Unknown) {
        if !self.column.contains_key(&unknown) || self.made.contains_key(&unknown) {
            return;
        }
        let (v, name) = match unknown {
            Unknown::Var(v) => (v, format!("der({})", draft.variables[v.index()].name)),
            Unknown::Der(v) => (v, format!("der(der({}))", draft.variables[v.index()].name)),
        };
        let origin = Origin { kind: OriginKind::Differentiated, ..draft.variables[v.index()].origin };
        let made = draft.make_variable(name, Type::Real, Role::Continuous, origin);
        self.made.insert(unknown, made);
        self.open.push(unknown);
    }

    /// Differentiates the equation that determines an unknown.
    fn determine(&mut self, draft: &mut Draft, unknown: Unknown) -> Result<(), Diagnostic> {
        let row = self.running.matching.row_of[self.column[&unknown] as usize];
        let equation = self.running.rows[row as usize].equation;
        let used = draft.exprs.dependencies(&[equation.lhs, equation.rhs]);
        for v in used.vars {
            if draft.role(v) == Role::Input {
                return Err(messages::not_differentiable(draft, &equation, v));
            }
            self.of(draft, Unknown::Var(v));
        }
        for v in used.ders {
            self.of(draft, Unknown::Der(v));
        }
        let (lhs, rhs) = (self.differentiated(draft, equation.lhs), self.differentiated(draft, equation.rhs));
        let origin = Origin { kind: OriginKind::Differentiated, ..equation.origin };
        let equation = Equation { lhs, rhs, origin };
        draft.add_equation(equation, RowKind::Continuous);
        let index = draft.equations.len() as u32 - 1;
        self.rows.push((SystemRow { equation, index, discrete: false }, self.made[&unknown]));
        Ok(())
    }

    fn differentiated(&mut self, draft: &mut Draft, e: ExprId) -> ExprId {
        let (made, column, links) = (&self.made, &self.column, &draft.derivative);
        let mut leaf = |pool: &mut Exprs, leaf: Leaf| {
            let unknown = match leaf {
                Leaf::Var(v) => Unknown::Var(v),
                Leaf::Der(v) => Unknown::Der(v),
            };
            Some(match (made.get(&unknown), leaf) {
                (Some(d), _) => pool.var(*d),
                (None, Leaf::Var(v)) if column.contains_key(&Unknown::Der(v)) => pool.der(v),
                (None, Leaf::Var(v)) => match links[v.index()] {
                    Some(w) => {
                        let e = pool.var(w.variable);
                        if w.negated { pool.neg(e) } else { e }
                    }
                    None => Exprs::ZERO,
                },
                (None, Leaf::Der(_)) => Exprs::ZERO,
            })
        };
        self.time_derivative.derive(&mut draft.exprs, e, &mut leaf).expect("every leaf has an answer")
    }

    /// The running system with the rows made.
    fn extended(self, draft: &Draft) -> System {
        let mut system = self.running.clone();
        let mut column = self.column;
        for (_, v) in &self.rows {
            column.insert(Unknown::Var(*v), system.columns.len() as u32);
            system.columns.push(Unknown::Var(*v));
            system.matching.row_of.push(NONE);
        }
        let discrete = |c: u32| match system.columns[c as usize] {
            Unknown::Var(v) => draft.role(v) == Role::Discrete,
            Unknown::Der(_) => false,
        };
        let of_node = |node: Node| match node {
            Node::Var(v) => column.get(&Unknown::Var(v)).copied(),
            Node::Der(v) => column.get(&Unknown::Der(v)).copied(),
            _ => None,
        };
        let mut scanner = Scanner::default();
        for (row, _) in &self.rows {
            let sides = [row.equation.lhs, row.equation.rhs];
            scanner.push(&draft.exprs, sides, of_node, |c| !discrete(c), &mut system.incidence);
        }
        for (row, v) in self.rows {
            system.rows.push(row);
            system.matching.column_of.push(NONE);
            system.matching.join(system.rows.len() as u32 - 1, column[&Unknown::Var(v)]);
        }
        system
    }
}
