//! The mutable surroundings of an evaluation.

use crate::instance::Instance;
use crate::instance::value::ModelicaValue;
use bramah_expr::ExprId;
use bramah_expr::types::ScalarType;
use bramah_syntax::diag::FileId;
use bramah_syntax::symbol::Symbol;
use rustc_hash::FxHashMap;

/// The mutable surroundings of an evaluation.
#[derive(Default)]
pub struct EvaluationState {
    /// Loop variables and the locals of functions, innermost last.
    pub locals: Vec<(Symbol, ModelicaValue)>,
    /// First local of the function being evaluated.
    pub frame: usize,
    /// How expressions are evaluated at present.
    pub mode: EvaluationMode,
    /// Sizes that `end` means, and what counts along the dimension, innermost last.
    pub ends: Vec<(usize, ScalarType)>,
    /// Depth of function calls.
    pub depth: usize,
    /// Set when a function cannot be written as an expression and must become a procedure.
    pub not_inline: bool,
    /// An assertion fails where the run may not come: the function around it must become a procedure.
    pub may_fail: bool,
    /// Statements carried out, to end what never ends.
    pub work: StatementBudget,
    /// `when`s met in an algorithm section of the model.
    pub whens: Vec<crate::instance::algorithm::AlgorithmWhen>,
    /// `assert`s and `terminate`s met there since the section, or the branch of a `when`, began.
    pub calls: Vec<crate::instance::algorithm::AlgorithmCall>,
    /// Conditions of the `if`s around the present statement of such a section.
    pub guards: Vec<ExprId>,
    /// The procedure being translated.
    pub(in crate::instance) translation: crate::instance::procedure::ProcedureDraft,
    /// The variables of the algorithm section being carried out, among the locals.
    pub section: std::ops::Range<usize>,
    /// The text of values given from outside.
    pub override_file: Option<FileId>,
    /// These values as they were given, by the names of the variables.
    pub texts: FxHashMap<String, String>,
}

/// How expressions are evaluated; [`Instance::in_mode`] changes it for a while.
#[derive(Clone, Copy, Debug, Default)]
pub struct EvaluationMode {
    /// Parameters count by their values.
    pub constant: bool,
    /// Relations make no events.
    pub no_event: bool,
    /// Inside `pre`: variables of the section mean themselves, not what the section has made of them.
    pub before: bool,
    /// A procedure is being translated.
    pub procedure: bool,
    /// What a procedure calls is being written out.
    pub under_procedure: bool,
    /// Assertions of the function being carried out are kept for the run.
    pub keep_asserts: bool,
}

impl Instance<'_, '_> {
    /// Does something in another mode.
    pub fn in_mode<T>(&mut self, change: impl FnOnce(&mut EvaluationMode), act: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.eval.mode;
        change(&mut self.eval.mode);
        let done = act(self);
        self.eval.mode = before;
        done
    }

    /// Does something in a frame of its own, as the body of a function: the locals around it are out of reach, those made in it
    /// end with it, and relations make no events.
    pub(in crate::instance) fn in_frame<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        let (frame, end) = (self.eval.frame, self.eval.locals.len());
        self.eval.frame = end;
        let done = self.in_mode(|m| m.no_event = true, act);
        self.eval.locals.truncate(end);
        self.eval.frame = frame;
        done
    }

    /// A loop variable or local of the function being evaluated.
    pub(in crate::instance) fn local(&self, name: Symbol) -> Option<usize> {
        let frame = self.eval.frame;
        let found = self.eval.locals[frame..].iter().rposition(|(n, _)| *n == name).map(|i| i + frame);
        found.filter(|i| !(self.eval.mode.before && self.eval.section.contains(i)))
    }
}

/// Statements carried out, against the most that are allowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct StatementBudget {
    /// The present function is called with known values only.
    pub known: bool,
    /// By functions that are written out, and by those that are simply carried out.
    done: [usize; 2],
    most: [usize; 2],
}

impl StatementBudget {
    /// A fresh allowance for what is written out and what is carried out.
    pub fn allowed(most: [usize; 2]) -> Self {
        StatementBudget { known: false, done: [0; 2], most }
    }

    /// Counts a statement; false when there have been too many.
    pub fn step(&mut self) -> bool {
        let of = usize::from(self.known);
        self.done[of] += 1;
        self.done[of] <= self.most[of]
    }
}
