//! The state of an evaluation: locals, the frame that limits them, and the mode.
//!
//! There is one [`EvaluationState`] in each instance. Evaluation changes it and restores it afterwards.
//! [`Instance::in_mode`] and `in_frame` do that; code that changes fields directly restores them itself.

use crate::instance::Instance;
use crate::instance::value::ModelicaValue;
use bramah_expr::ExprId;
use bramah_expr::types::ScalarType;
use bramah_syntax::diag::FileId;
use bramah_syntax::symbol::Symbol;
use rustc_hash::FxHashMap;

/// What an evaluation depends on besides the expression and its place.
#[derive(Default)]
pub struct EvaluationState {
    /// Loop variables, and inputs, outputs and protected variables of functions, innermost last.
    pub locals: Vec<(Symbol, ModelicaValue)>,
    /// Index of the first local of the function that is being evaluated. Locals before it are not visible.
    pub frame: usize,
    /// How expressions are evaluated at present.
    pub mode: EvaluationMode,
    /// What `end` means in the subscripts around, innermost last: the size of the dimension and its index type.
    pub ends: Vec<(usize, ScalarType)>,
    /// The number of function calls around the present expression.
    pub depth: usize,
    /// Set when a function cannot be evaluated to an expression. Its caller then makes a procedure of it.
    pub not_inline: bool,
    /// Set when an assertion fails in a branch that the run may never take.
    /// The function then becomes a procedure, which checks the assertion when it gets there.
    pub may_fail: bool,
    /// Statements executed so far against their limit, to stop functions that never end.
    pub work: StatementBudget,
    /// The `when` statements of the algorithm section that is being executed.
    pub whens: Vec<crate::instance::algorithm::AlgorithmWhen>,
    /// The `assert` and `terminate` calls since the section, or the branch of its `when`, began.
    pub calls: Vec<crate::instance::algorithm::AlgorithmCall>,
    /// Conditions of the `if`s around the present statement or expression. All of them must hold there.
    pub guards: Vec<ExprId>,
    /// The procedure that is being translated.
    pub(in crate::instance) translation: crate::instance::procedure::ProcedureDraft,
    /// The locals that stand for variables assigned by the algorithm section of a model.
    pub section: std::ops::Range<usize>,
    /// The file that holds the text of values given from outside.
    pub override_file: Option<FileId>,
    /// Values given from outside as they were written, by the names of the variables.
    pub texts: FxHashMap<String, String>,
}

/// How expressions are evaluated. [`Instance::in_mode`] changes it for the time of a call.
#[derive(Clone, Copy, Debug, Default)]
pub struct EvaluationMode {
    /// Parameters are replaced by their values. Reading a variable is an error.
    pub constant: bool,
    /// Relations raise no events, as inside `noEvent`.
    pub no_event: bool,
    /// Inside `pre(...)`: variables of the algorithm section mean the variables, not their values so far in the
    /// section.
    pub before: bool,
    /// A procedure is being translated: values that are not known become slots.
    pub procedure: bool,
    /// A function called by a procedure is being evaluated to expressions.
    pub under_procedure: bool,
    /// Assertions of the called function are kept and checked during the run.
    pub keep_asserts: bool,
}

impl Instance<'_, '_> {
    /// Runs `act` in a mode that `change` derives from the present one, and restores the mode afterwards.
    pub fn in_mode<T>(&mut self, change: impl FnOnce(&mut EvaluationMode), act: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.eval.mode;
        change(&mut self.eval.mode);
        let done = act(self);
        self.eval.mode = before;
        done
    }

    /// Runs `act` in a frame of its own, as for the body of a function.
    /// Locals around it are not visible, locals made in it are removed at its end, and relations raise no events.
    /// It serves the bodies of functions, and the binding of arguments before them.
    pub(in crate::instance) fn in_frame<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        let (frame, end) = (self.eval.frame, self.eval.locals.len());
        self.eval.frame = end;
        let done = self.in_mode(|m| m.no_event = true, act);
        self.eval.locals.truncate(end);
        self.eval.frame = frame;
        done
    }

    /// The index of a local that is visible by its name, the innermost one first. `None` if there is none.
    pub(in crate::instance) fn local(&self, name: Symbol) -> Option<usize> {
        let frame = self.eval.frame;
        let found = self.eval.locals[frame..].iter().rposition(|(n, _)| *n == name).map(|i| i + frame);
        // Inside `pre` the variables of the section are looked up as components, so they are skipped here.
        found.filter(|i| !(self.eval.mode.before && self.eval.section.contains(i)))
    }
}

/// The number of statements executed and its limit. Two kinds of calls are counted apart.
#[derive(Clone, Copy, Debug, Default)]
pub struct StatementBudget {
    /// The present function is called with known values only, so it is just computed.
    pub known: bool,
    /// Statements so far: of calls with symbolic arguments, and of calls with known ones.
    done: [usize; 2],
    /// The limits, in the same order.
    most: [usize; 2],
}

impl StatementBudget {
    /// A new budget with the given limits: for calls with symbolic arguments, and for calls with known ones.
    pub fn allowed(most: [usize; 2]) -> Self {
        StatementBudget { known: false, done: [0; 2], most }
    }

    /// Counts a statement. False if the limit is passed.
    pub fn step(&mut self) -> bool {
        let of = usize::from(self.known);
        self.done[of] += 1;
        self.done[of] <= self.most[of]
    }
}
