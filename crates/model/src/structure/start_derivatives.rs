//! Derivatives that only initial equations contain, as `der(y) = 0` of a `y` that is no state.
//!
//! Such a derivative is an unknown of the start. It is determined by the time derivative of the equation that
//! determines its variable; that may need further derivatives. Enters: the running system. Leaves: a copy with these
//! unknowns and equations, for the initial system only; the run does not compute them. `analysis` calls [`add`] before
//! `initial`.

use super::draft::{DaeDraft, EquationRole, SystemRole};
use super::incidence::{IncidenceScanner, NONE};
use super::sorting::{EquationSystem, SystemRow, UnknownColumns};
use super::{Unknown, messages};
use crate::flat::{ElementOrigin, FlatEquation, OriginKind, ScalarType};
use bramah_expr::differentiate::{DerivativeLeaf, TimeDerivative};
use bramah_expr::{ExprId, Exprs, VarId};
use bramah_syntax::diag::Diagnostic;
use rustc_hash::FxHashMap;

/// The running system with the derivatives that initial equations ask for. `None` where they ask for none. The initial
/// equations are rewritten in terms of the new variables.
///
/// For `der(y) = 0` with `y = f(x, z)` it adds `der(y) = df/dx*der(x) + df/dz*der(z)`, where `der(x)` of a state is
/// known already and `der(z)` needs an equation of its own.
pub(super) fn add(
    draft: &mut DaeDraft,
    running: &EquationSystem,
    states: &[VarId],
) -> Result<Option<EquationSystem>, Diagnostic> {
    let asked = asked_for(draft, states);
    if asked.is_empty() {
        return Ok(None);
    }
    let mut derivatives = StartDerivatives::new(running, draft.variables.len());
    for &v in &asked {
        derivatives.of(draft, Unknown::Var(v));
    }
    // The list only grows by unknowns without a derivative, and each gets one at most, so this ends.
    while let Some(unknown) = derivatives.open.pop() {
        derivatives.determine(draft, unknown)?;
    }
    let mut replaced: Vec<(ExprId, ExprId)> = Vec::new();
    for v in asked {
        if let Some(&d) = derivatives.made.get(&Unknown::Var(v)) {
            replaced.push((draft.exprs.der(v), draft.exprs.var(d)));
        }
    }
    for equation in &mut draft.initial_equations {
        equation.lhs = draft.exprs.substitute(equation.lhs, &replaced);
        equation.rhs = draft.exprs.substitute(equation.rhs, &replaced);
    }
    Ok(Some(derivatives.extended(draft)))
}

/// Continuous unknowns that are no states and whose derivatives occur in initial equations.
/// The derivatives of states are unknowns of the running system already.
fn asked_for(draft: &DaeDraft, states: &[VarId]) -> Vec<VarId> {
    let sides = draft.initial_equations.iter().flat_map(|e| [e.lhs, e.rhs]).collect::<Vec<_>>();
    let asked = draft.exprs.dependencies(&sides).ders;
    asked.into_iter().filter(|v| draft.role(*v) == SystemRole::Continuous && states.binary_search(v).is_err()).collect()
}

/// The derivatives made so far.
/// Every unknown gets at most one variable for its derivative.
struct StartDerivatives<'a> {
    /// The system that determines the unknowns.
    running: &'a EquationSystem,
    /// The columns of that system.
    columns: UnknownColumns,
    /// By unknown: the variable that is its time derivative.
    made: FxHashMap<Unknown, VarId>,
    /// Unknowns whose derivatives have a variable but no equation yet.
    open: Vec<Unknown>,
    /// The differentiator.
    time_derivative: TimeDerivative,
    /// The new equations, each with the variable that it determines.
    rows: Vec<(SystemRow, VarId)>,
}

impl<'a> StartDerivatives<'a> {
    /// Nothing asked for yet.
    fn new(running: &'a EquationSystem, variables: usize) -> Self {
        StartDerivatives {
            running,
            columns: UnknownColumns::new(&running.columns, variables),
            made: FxHashMap::default(),
            open: Vec::new(),
            time_derivative: TimeDerivative::default(),
            rows: Vec::new(),
        }
    }

    /// Makes a variable for the derivative of an unknown, if the unknown belongs to the running system and has none
    /// yet.
    /// The name of the variable is `der(v)`, or `der(der(v))` for the derivative of a state.
    fn of(&mut self, draft: &mut DaeDraft, unknown: Unknown) {
        if self.columns.of(unknown).is_none() || self.made.contains_key(&unknown) {
            return;
        }
        let (v, name) = match unknown {
            Unknown::Var(v) => (v, format!("der({})", draft.variables[v.index()].name)),
            Unknown::Der(v) => (v, format!("der(der({}))", draft.variables[v.index()].name)),
        };
        let origin = ElementOrigin { kind: OriginKind::Differentiated, ..draft.variables[v.index()].origin };
        let made = draft.make_variable(name, ScalarType::Real, SystemRole::Continuous, origin);
        self.made.insert(unknown, made);
        self.open.push(unknown);
    }

    /// Differentiates the equation that determines an unknown, and asks for all derivatives that the result contains.
    /// `Err` where the equation reads an input (E304).
    fn determine(&mut self, draft: &mut DaeDraft, unknown: Unknown) -> Result<(), Diagnostic> {
        let column = self.columns.of(unknown).expect("only unknowns of the running system are asked for");
        let row = self.running.matching.row_of[column as usize];
        let equation = self.running.rows[row as usize].equation;
        let used = draft.exprs.dependencies(&[equation.lhs, equation.rhs]);
        for v in used.vars {
            if draft.role(v) == SystemRole::Input {
                return Err(messages::not_differentiable(draft, &equation, v));
            }
            self.of(draft, Unknown::Var(v));
        }
        for v in used.ders {
            self.of(draft, Unknown::Der(v));
        }
        let (lhs, rhs) = (self.differentiated(draft, equation.lhs), self.differentiated(draft, equation.rhs));
        let origin = ElementOrigin { kind: OriginKind::Differentiated, ..equation.origin };
        let equation = FlatEquation { lhs, rhs, origin };
        draft.add_equation(equation, EquationRole::Continuous);
        let index = draft.equations.len() as u32 - 1;
        self.rows.push((SystemRow { equation, index, discrete: false }, self.made[&unknown]));
        Ok(())
    }

    /// The time derivative of an expression in terms of the new variables.
    /// Leaves without a variable are states, constants or discrete quantities.
    fn differentiated(&mut self, draft: &mut DaeDraft, e: ExprId) -> ExprId {
        let (made, columns, links) = (&self.made, &self.columns, &draft.derivative);
        let mut leaf = |pool: &mut Exprs, leaf: DerivativeLeaf| {
            let unknown = match leaf {
                DerivativeLeaf::Var(v) => Unknown::Var(v),
                DerivativeLeaf::Der(v) => Unknown::Der(v),
            };
            Some(match (made.get(&unknown), leaf) {
                (Some(d), _) => pool.var(*d),
                // The derivative of a state is an unknown of the running system.
                (None, DerivativeLeaf::Var(v)) if columns.of(Unknown::Der(v)).is_some() => pool.der(v),
                // A state with a variable as its derivative, or what is constant: a parameter or a discrete variable.
                (None, DerivativeLeaf::Var(v)) => links[v.index()].map_or(Exprs::ZERO, |w| w.expression(pool)),
                (None, DerivativeLeaf::Der(_)) => Exprs::ZERO,
            })
        };
        self.time_derivative.derive(&mut draft.exprs, e, &mut leaf).expect("every leaf has an answer")
    }

    /// A copy of the running system with the new rows and columns, matched with each other.
    /// The rows come in the order in which they were made.
    fn extended(self, draft: &DaeDraft) -> EquationSystem {
        let mut system = self.running.clone();
        system.columns.extend(self.rows.iter().map(|(_, v)| Unknown::Var(*v)));
        system.matching.row_of.resize(system.columns.len(), NONE);
        let columns = UnknownColumns::new(&system.columns, draft.variables.len());
        let discrete = |c: u32| match system.columns[c as usize] {
            Unknown::Var(v) => draft.role(v) == SystemRole::Discrete,
            Unknown::Der(_) => false,
        };
        let mut scanner = IncidenceScanner::default();
        for (row, _) in &self.rows {
            let sides = [row.equation.lhs, row.equation.rhs];
            scanner.push(&draft.exprs, sides, |node| columns.of_node(node), |c| !discrete(c), &mut system.incidence);
        }
        for (column, (row, _)) in (self.running.columns.len() as u32..).zip(self.rows) {
            system.rows.push(row);
            system.matching.column_of.push(NONE);
            system.matching.join(system.rows.len() as u32 - 1, column);
        }
        system
    }
}
