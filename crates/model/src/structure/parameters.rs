//! Parameters: the order in which bindings are evaluated, their values, and the signs of expressions that follow.
//!
//! `order` sorts the bindings, `values` evaluates them, `check` reports values out of range. `SignAnalysis` then
//! answers two questions for the other steps: the value of an expression of parameters, and whether an expression can
//! vanish. `analysis` calls them in this order. Later crates use `out_of_range` for values that are set before a run.

use super::draft::{DaeDraft, SystemRole};
use super::{EventActionKind, blt, messages};
use crate::flat::FlatEquation;
use crate::flat::{FlatVariable, OriginKind, ScalarType, Variability};
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use bramah_syntax::diag::{Code, Diagnostic};

/// Sorts the parameters so that each binding refers to earlier ones only.
///
/// Parameters that depend on free parameters become free themselves; their bindings become initial equations. Where
/// bindings use each other, conditions that are known already are decided first. `Err` is a circle of bindings that no
/// condition opens.
///
/// The sort is topological: strongly connected components of the graph of bindings, dependencies first. Each round of
/// the loop removes at least one `if`, so it ends.
pub(super) fn order(draft: &mut DaeDraft) -> Result<Vec<VarId>, Diagnostic> {
    loop {
        match sorted_parameters(draft) {
            Ok((uses, order)) => return Ok(without_free(draft, &uses, order)),
            Err(BindingCycle { before, members }) => {
                if !decide_conditions(draft, &before, &members) {
                    return Err(messages::cyclic_parameters(draft, &members));
                }
            }
        }
    }
}

/// A circle of parameters.
struct BindingCycle {
    /// Parameters that are sorted before the circle; their values are known.
    before: Vec<VarId>,
    /// Parameters whose bindings use each other.
    members: Vec<VarId>,
}

/// Replaces `if` expressions with known conditions in the bindings of a circle by the chosen branch.
///
/// `T = if useT then T0 else f(h)` and `h = if useT then g(T) else h0` use each other only on paper. Parameters in a
/// decided condition are fixed with the structure. False where no binding has such a condition.
///
/// In each binding one `if` is replaced per call; the caller sorts again and calls this function if a circle remains.
fn decide_conditions(draft: &mut DaeDraft, before: &[VarId], members: &[VarId]) -> bool {
    let values = values(draft, before);
    let mut decided = false;
    for &v in members {
        let Some(binding) = draft.variables[v.index()].binding else { continue };
        let mut chosen = Vec::new();
        for e in draft.exprs.reachable(&[binding], |_| true) {
            let ExprNode::If(condition, yes, no) = draft.exprs.node(e) else { continue };
            let found = draft.exprs.dependencies(&[condition]);
            if found.time || !found.ders.is_empty() || !found.pres.is_empty() {
                continue;
            }
            // NaN marks what the circle itself determines.
            if !found.vars.iter().all(|u| !values[u.index()].is_nan()) {
                continue;
            }
            let holds = draft.exprs.eval(condition, &mut |node| match node {
                ExprNode::Var(u) => values[u.index()],
                _ => f64::NAN,
            });
            if holds.is_finite() {
                chosen.push((e, if holds == 0.0 { no } else { yes }));
                fix(draft, &found.vars);
            }
        }
        // One `if` at a time, from outside: the branch that is dropped may contain others that do not matter any more.
        if let Some(&first) = chosen.iter().find(|(e, _)| *e == binding).or(chosen.last()) {
            draft.variables[v.index()].binding = Some(draft.exprs.substitute(binding, &[first]));
            decided = true;
        }
    }
    decided
}

/// The bound parameters in order of evaluation, with what their bindings use. `Err` is the first circle.
/// A binding that uses its own parameter is a circle of one.
fn sorted_parameters(draft: &DaeDraft) -> Result<(BindingUses, Vec<VarId>), BindingCycle> {
    let bound = draft.with_role(SystemRole::Parameter);
    let mut position = vec![u32::MAX; draft.variables.len()];
    for (i, v) in bound.iter().enumerate() {
        position[v.index()] = i as u32;
    }
    let uses = BindingUses::of(draft);
    let sorted = blt::components(bound.len(), |node, out| {
        let used = uses.of_variable(bound[node as usize]).iter();
        out.extend(used.map(|u| position[u.index()]).filter(|&p| p != u32::MAX));
    });
    let mut before = Vec::with_capacity(bound.len());
    for members in sorted.iter() {
        let first = bound[members[0] as usize];
        if members.len() > 1 || uses.of_variable(first).contains(&first) {
            return Err(BindingCycle { before, members: members.iter().map(|&m| bound[m as usize]).collect() });
        }
        before.push(first);
    }
    Ok((uses, before))
}

/// Removes from the order the parameters that depend on free ones and makes them free, with their bindings as initial
/// equations.
/// A binding over free parameters has no value before the start.
fn without_free(draft: &mut DaeDraft, uses: &BindingUses, order: Vec<VarId>) -> Vec<VarId> {
    let mut kept = Vec::with_capacity(order.len());
    for v in order {
        // The order makes this transitive: what a binding uses has been decided before.
        if !uses.of_variable(v).iter().any(|u| draft.role(*u) == SystemRole::FreeParameter) {
            kept.push(v);
            continue;
        }
        draft.roles[v.index()] = SystemRole::FreeParameter;
        if let Some(binding) = draft.variables[v.index()].binding.take() {
            let lhs = draft.exprs.var(v);
            let origin = crate::flat::ElementOrigin { kind: OriginKind::Binding, ..draft.variables[v.index()].origin };
            draft.initial_equations.push(FlatEquation { lhs, rhs: binding, origin });
        }
    }
    kept
}

/// The variables that each binding uses, by variable.
struct BindingUses {
    /// Where the entries of each variable begin in `used`, and one more for the end.
    starts: Vec<u32>,
    /// The variables used, one binding after the other.
    used: Vec<VarId>,
}

impl BindingUses {
    /// Collects the uses of all bound parameters.
    fn of(draft: &DaeDraft) -> Self {
        let mut found = BindingUses { starts: Vec::with_capacity(draft.variables.len() + 1), used: Vec::new() };
        let mut walk = bramah_expr::visit::NodeTraversal::default();
        for (v, role) in draft.variables.iter().zip(&draft.roles) {
            found.starts.push(found.used.len() as u32);
            if let (Some(binding), SystemRole::Parameter) = (v.binding, role) {
                walk.each(&draft.exprs, &[binding], |_, node| {
                    if let ExprNode::Var(u) = node {
                        found.used.push(u);
                    }
                    true
                });
            }
        }
        found.starts.push(found.used.len() as u32);
        found
    }

    /// What the binding of a variable uses; empty for what is no bound parameter.
    fn of_variable(&self, v: VarId) -> &[VarId] {
        &self.used[self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize]
    }
}

/// Fixes parameters with the structure, and everything that they are computed from: they become constants, so that a
/// run cannot change them.
/// The structure is valid only with these values.
pub(super) fn fix(draft: &mut DaeDraft, parameters: &[VarId]) {
    let mut open = parameters.to_vec();
    while let Some(v) = open.pop() {
        let variable = &mut draft.variables[v.index()];
        if std::mem::replace(&mut variable.variability, Variability::Constant) != Variability::Constant
            && let Some(binding) = variable.binding
        {
            open.extend(draft.exprs.dependencies(&[binding]).vars);
        }
    }
}

/// By variable: the value of a parameter as it stands in the model, NaN for other variables. A parameter without
/// binding and start has the default of its type; the flattening has reported that. `order` is that of [`order`].
/// Each binding is evaluated once.
pub(super) fn values(draft: &DaeDraft, order: &[VarId]) -> Vec<f64> {
    let mut values = vec![f64::NAN; draft.variables.len()];
    let mut evaluation = bramah_expr::eval::EvaluationCache::default();
    for &v in order {
        let variable = &draft.variables[v.index()];
        let given = variable.binding.or(variable.start);
        values[v.index()] = match given {
            Some(e) => evaluation.value(&draft.exprs, e, &mut |node| match node {
                ExprNode::Var(u) => values[u.index()],
                _ => f64::NAN,
            }),
            None => default_start(variable.ty),
        };
    }
    values
}

/// Parameters whose value is no finite number (E217) or lies outside their range (E215). A wrong value that other
/// parameters only pass on is reported once, where it comes from.
pub(super) fn check(draft: &DaeDraft, order: &[VarId], values: &[f64]) -> Vec<Diagnostic> {
    let mut wrong = vec![false; draft.variables.len()];
    let mut reported = Vec::new();
    for &v in order {
        let source = draft.variables[v.index()].binding.map(|b| draft.exprs.node(b));
        if let Some(ExprNode::Var(u)) = source
            && wrong[u.index()]
        {
            wrong[v.index()] = true;
        } else if let Some(diagnostic) = check_one(draft, v, values) {
            wrong[v.index()] = true;
            reported.push(diagnostic);
        }
    }
    reported
}

/// The message about a value below `low` or above `high`, without its place. `None` where the value is in range or the
/// bounds are not known.
/// It prints the value with the unit of the variable, as in "`V` is -1 m3, less than its `min`, 0 m3".
pub fn out_of_range(variable: &FlatVariable, value: f64, low: Option<f64>, high: Option<f64>) -> Option<Diagnostic> {
    let bound = match (low, high) {
        (Some(low), _) if value < low => format!("less than its `min`, {low}"),
        (_, Some(high)) if value > high => format!("more than its `max`, {high}"),
        _ => return None,
    };
    let unit = variable.unit.as_deref().filter(|u| *u != "1").map(|u| format!(" {u}")).unwrap_or_default();
    Some(Diagnostic::new(Code::OutOfRange, format!("`{}` is {value}{unit}, {bound}{unit}", variable.name)))
}

/// The diagnostic about one parameter, if its value is wrong.
/// The bounds may depend on other parameters; a bound that is not known is not checked.
fn check_one(draft: &DaeDraft, v: VarId, values: &[f64]) -> Option<Diagnostic> {
    let variable = &draft.variables[v.index()];
    let value = values[v.index()];
    // The value of a bound or binding, if all parameters in it are finite.
    let known = |e: ExprId| {
        if let Some(number) = draft.exprs.as_num(e) {
            return Some(number);
        }
        let used = draft.exprs.dependencies(&[e]).vars;
        used.iter().all(|u| values[u.index()].is_finite()).then(|| {
            draft.exprs.eval(e, &mut |node| match node {
                ExprNode::Var(u) => values[u.index()],
                _ => f64::NAN,
            })
        })
    };
    if !value.is_finite() {
        // Where the binding reads a parameter that is not finite, that one is reported instead.
        let binding = variable.binding.filter(|&b| known(b).is_some_and(|x| !x.is_finite()))?;
        let message = format!("`{}` = `{}` is not a finite number", variable.name, draft.text(binding));
        let used: Vec<String> = draft
            .exprs
            .dependencies(&[binding])
            .vars
            .iter()
            .map(|u| format!("`{}` is {}", draft.variables[u.index()].name, values[u.index()]))
            .collect();
        let made = Diagnostic::new(Code::Evaluation, message)
            .at(variable.origin.span, "its value cannot be computed")
            .instance(draft.instances[variable.origin.instance as usize].name.clone())
            .help(
                "check the numbers it is computed from: a division by zero, the root or logarithm of a negative number",
            );
        return Some(if used.is_empty() { made } else { made.note(used.join(", ")) });
    }
    let bound = |e: Option<ExprId>| e.and_then(known);
    let (low, high) = (bound(variable.min), bound(variable.max));
    let mut made = out_of_range(variable, value, low, high)?;
    let holder = &draft.instances[variable.origin.instance as usize];
    if variable.origin.instance != 0 {
        // Point at the component in the user's model: the one with the value may be inside a library.
        let mut outermost = holder;
        while outermost.parent != 0 {
            outermost = &draft.instances[outermost.parent as usize];
        }
        made = made.at(outermost.span, "in this component").instance(holder.name.clone()).class(holder.class.clone());
    }
    Some(
        made.at(variable.origin.span, "declared here")
            .help("check the unit: a value in a model's text is in the unit of the variable, here without conversion"),
    )
}

/// The start value of a type when none is given: the first literal (numbered 1) of an enumeration, else 0.
pub(super) fn default_start(ty: ScalarType) -> f64 {
    if matches!(ty, ScalarType::Enumeration(_)) { 1.0 } else { 0.0 }
}

/// What is known about the sign of an expression, for all values of the unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ValueSign {
    /// Nothing.
    Unknown,
    /// Greater than 0.
    Positive,
    /// Less than 0.
    Negative,
    /// 0 or greater.
    NotNegative,
    /// 0 or less.
    NotPositive,
    /// Of either sign, but not 0.
    NotZero,
}

/// Signs and parameter values of all nodes of a pool. The pool may grow: new nodes are evaluated when they are asked
/// for.
/// Both hold with the parameters as they are in the model.
#[derive(Clone, Debug, Default)]
pub(super) struct SignAnalysis {
    /// By variable: the value of a parameter, else NaN.
    variables: Vec<f64>,
    /// By variable: the sign where the value is not known.
    signs_of: Vec<ValueSign>,
    /// By node: its value, or NaN where it depends on more than parameters.
    values: Vec<f64>,
    /// By node: its sign.
    signs: Vec<ValueSign>,
}

impl SignAnalysis {
    /// Starts from the parameters' values; NaN for all other variables. Signs of variables are derived from their
    /// equations.
    pub fn new(draft: &DaeDraft, variables: Vec<f64>) -> Self {
        let signs_of = variable_signs(draft, &variables);
        SignAnalysis { variables, signs_of, ..SignAnalysis::default() }
    }

    /// The value of an expression of parameters; `None` where it is not known before the run.
    pub fn value(&mut self, pool: &Exprs, e: ExprId) -> Option<f64> {
        self.extend(pool);
        Some(self.values[e.index()]).filter(|v| !v.is_nan())
    }

    /// The value of a parameter; `None` for other variables.
    pub fn value_of(&self, v: VarId) -> Option<f64> {
        self.variables.get(v.index()).copied().filter(|value| !value.is_nan())
    }

    /// True when an expression cannot vanish, whatever variables and time are, with the parameters as they are. False
    /// means that it may vanish.
    /// Pivots are chosen by this answer, so it must never be true by accident.
    pub fn is_nonzero(&mut self, pool: &Exprs, e: ExprId) -> bool {
        self.extend(pool);
        matches!(self.signs[e.index()], ValueSign::Positive | ValueSign::Negative | ValueSign::NotZero)
    }

    /// Evaluates the nodes that were added to the pool since the last call.
    /// Ids ascend from arguments to nodes, so one pass suffices.
    fn extend(&mut self, pool: &Exprs) {
        for i in self.values.len()..pool.len() {
            let e = ExprId(i as u32);
            let value = self.node_value(pool, e);
            let sign = if value.is_finite() { sign_of(value) } else { self.node_sign(pool, e) };
            self.values.push(value);
            self.signs.push(sign);
        }
    }

    /// The value of a node from those of its arguments; NaN where it is not known.
    /// `sample` has no value before the run.
    fn node_value(&self, pool: &Exprs, e: ExprId) -> f64 {
        let node = pool.node(e);
        let operands = pool.operands(e);
        let known =
            !operands.as_slice().is_empty() && operands.as_slice().iter().all(|a| !self.values[a.index()].is_nan());
        match node {
            ExprNode::Num(bits) => f64::from_bits(bits),
            ExprNode::Var(v) => self.variables.get(v.index()).copied().unwrap_or(f64::NAN),
            // With a known condition the other branch need not be known.
            ExprNode::If(c, a, b) if !self.values[c.index()].is_nan() => {
                self.values[if self.values[c.index()] == 0.0 { b } else { a }.index()]
            }
            ExprNode::Sample(..) => f64::NAN,
            // A delayed constant is the constant.
            ExprNode::Delay(a, _) => self.values[a.index()],
            _ if known => self.combined(pool, e),
            _ => f64::NAN,
        }
    }

    /// The value of a node whose arguments are all known.
    fn combined(&self, pool: &Exprs, e: ExprId) -> f64 {
        let leaf = |node: ExprNode| match node {
            ExprNode::Var(v) => self.variables.get(v.index()).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        };
        match pool.node(e) {
            ExprNode::Unary(op, a) => bramah_expr::math::unary(op, self.values[a.index()]),
            ExprNode::Binary(op, a, b) => bramah_expr::math::binary(op, self.values[a.index()], self.values[b.index()]),
            _ => pool.eval(e, &mut { leaf }),
        }
    }

    /// The sign of a node whose value is not known, from the signs of its arguments.
    fn node_sign(&self, pool: &Exprs, e: ExprId) -> ValueSign {
        use bramah_expr::{BinaryFunction, UnaryFunction};
        let of = |a: ExprId| self.signs[a.index()];
        match pool.node(e) {
            ExprNode::Unary(op, a) => match op {
                UnaryFunction::Neg => opposite(of(a)),
                UnaryFunction::Exp | UnaryFunction::Cosh => ValueSign::Positive,
                UnaryFunction::Abs if nonzero(of(a)) => ValueSign::Positive,
                UnaryFunction::Sqrt if of(a) == ValueSign::Positive => ValueSign::Positive,
                UnaryFunction::Log => self.logarithm(pool, a),
                UnaryFunction::Abs | UnaryFunction::Sqrt | UnaryFunction::Not => ValueSign::NotNegative,
                UnaryFunction::Sinh | UnaryFunction::Tanh | UnaryFunction::Atan | UnaryFunction::Sign => of(a),
                _ => ValueSign::Unknown,
            },
            ExprNode::Binary(op, a, b) => match op {
                BinaryFunction::Add => sum(of(a), of(b)),
                BinaryFunction::Sub => sum(of(a), opposite(of(b))),
                // A square, even of something of unknown sign.
                BinaryFunction::Mul if a == b => {
                    if nonzero(of(a)) {
                        ValueSign::Positive
                    } else {
                        ValueSign::NotNegative
                    }
                }
                // A quotient by `Modelica.Constants.inf` counts as 0. Any other quotient of something that is not 0 is
                // not 0 either, unless it underflows.
                BinaryFunction::Div if self.values[b.index()].abs() >= INFINITE => ValueSign::NotNegative,
                BinaryFunction::Mul | BinaryFunction::Div => product(of(a), of(b)),
                BinaryFunction::Pow => self.power(of(a), b),
                BinaryFunction::Max if of(a) == ValueSign::Positive || of(b) == ValueSign::Positive => {
                    ValueSign::Positive
                }
                BinaryFunction::Max if not_negative(of(a)) || not_negative(of(b)) => ValueSign::NotNegative,
                BinaryFunction::Min if of(a) == ValueSign::Negative || of(b) == ValueSign::Negative => {
                    ValueSign::Negative
                }
                BinaryFunction::Min | BinaryFunction::Max => either(of(a), of(b)),
                _ => ValueSign::Unknown,
            },
            ExprNode::If(_, a, b) | ExprNode::Homotopy(a, b) => either(of(a), of(b)),
            ExprNode::Rel(..) => ValueSign::NotNegative,
            ExprNode::Var(v) => self.signs_of.get(v.index()).copied().unwrap_or(ValueSign::Unknown),
            _ => ValueSign::Unknown,
        }
    }

    /// The sign of a logarithm of the form `log(1 + x)` with `x` not negative, as in a softplus function.
    /// One of the two terms must be a known number of at least 1.
    fn logarithm(&self, pool: &Exprs, e: ExprId) -> ValueSign {
        let ExprNode::Binary(bramah_expr::BinaryFunction::Add, a, b) = pool.node(e) else { return ValueSign::Unknown };
        let beyond = |one: ExprId, rest: ExprId| match self.signs[rest.index()] {
            sign @ (ValueSign::Positive | ValueSign::NotNegative) if self.values[one.index()] >= 1.0 => sign,
            _ => ValueSign::Unknown,
        };
        if beyond(a, b) == ValueSign::Unknown { beyond(b, a) } else { beyond(a, b) }
    }

    /// The sign of a power. A known even exponent makes any base but 0 positive.
    /// Without a known exponent only a positive base is certain to give a positive power.
    fn power(&self, base: ValueSign, exponent: ExprId) -> ValueSign {
        let even = self.values[exponent.index()] % 2.0 == 0.0;
        match base {
            ValueSign::Positive => ValueSign::Positive,
            _ if even && nonzero(base) => ValueSign::Positive,
            _ if even => ValueSign::NotNegative,
            ValueSign::NotNegative => ValueSign::NotNegative,
            _ => ValueSign::Unknown,
        }
    }
}

/// The value of `Modelica.Constants.inf`. Divisors of this size or more count as infinite.
const INFINITE: f64 = 1e60;

/// How many definitions are followed to find the sign of a variable.
const DEPTH: usize = 4;

/// By variable: the sign of variables that stay constant, and of variables that an equation sets equal to an expression
/// of known sign.
/// A variable with several definitions gets the first sign that is found.
fn variable_signs(draft: &DaeDraft, values: &[f64]) -> Vec<ValueSign> {
    let mut known = SignAnalysis { variables: values.to_vec(), ..SignAnalysis::default() };
    let mut signs = vec![ValueSign::Unknown; draft.variables.len()];
    let mut definitions = Vec::new();
    for equation in &draft.equations {
        match draft.exprs.node(equation.lhs) {
            ExprNode::Var(v) => definitions.push((v, equation.rhs)),
            ExprNode::Der(v) if equation.rhs == Exprs::ZERO => {
                if let Some(value) = steady_value(draft, v, &mut known) {
                    signs[v.index()] = sign_of(value);
                }
            }
            _ => {}
        }
    }
    // Each round carries signs through one more definition.
    for _ in 0..DEPTH {
        known = SignAnalysis { variables: known.variables, signs_of: signs.clone(), ..SignAnalysis::default() };
        known.extend(&draft.exprs);
        for &(v, value) in &definitions {
            if signs[v.index()] == ValueSign::Unknown {
                signs[v.index()] = known.signs[value.index()];
            }
        }
        if signs == known.signs_of {
            break;
        }
    }
    signs
}

/// The value of a variable with derivative 0 that starts from a fixed value and is never reinitialized. `None` for
/// others, and for 0. Another run may give it another value, but hardly one of another sign.
fn steady_value(draft: &DaeDraft, v: VarId, known: &mut SignAnalysis) -> Option<f64> {
    let variable = &draft.variables[v.index()];
    let reinitialized = || draft.actions.iter().any(|a| matches!(a.kind, EventActionKind::Reinit(w, _) if w == v));
    let start = variable.start.filter(|_| variable.fixed && !reinitialized())?;
    known.value(&draft.exprs, start).filter(|value| *value != 0.0)
}

/// The sign of a number. 0 counts as not negative.
fn sign_of(value: f64) -> ValueSign {
    if value > 0.0 {
        ValueSign::Positive
    } else if value < 0.0 {
        ValueSign::Negative
    } else {
        ValueSign::NotNegative
    }
}

/// Whether a sign excludes 0.
fn nonzero(s: ValueSign) -> bool {
    matches!(s, ValueSign::Positive | ValueSign::Negative | ValueSign::NotZero)
}

/// Whether a sign excludes negative values.
fn not_negative(s: ValueSign) -> bool {
    matches!(s, ValueSign::Positive | ValueSign::NotNegative)
}

/// Whether a sign excludes positive values.
fn not_positive(s: ValueSign) -> bool {
    matches!(s, ValueSign::Negative | ValueSign::NotPositive)
}

/// The sign of the negative.
/// `NotZero` and `Unknown` stay what they are.
fn opposite(s: ValueSign) -> ValueSign {
    match s {
        ValueSign::Positive => ValueSign::Negative,
        ValueSign::Negative => ValueSign::Positive,
        ValueSign::NotNegative => ValueSign::NotPositive,
        ValueSign::NotPositive => ValueSign::NotNegative,
        other => other,
    }
}

/// The sign of a sum.
/// Two terms of the same sign keep it; the sum excludes 0 if one of them does.
fn sum(a: ValueSign, b: ValueSign) -> ValueSign {
    let strict = nonzero(a) || nonzero(b);
    if not_negative(a) && not_negative(b) {
        if strict { ValueSign::Positive } else { ValueSign::NotNegative }
    } else if not_positive(a) && not_positive(b) {
        if strict { ValueSign::Negative } else { ValueSign::NotPositive }
    } else {
        ValueSign::Unknown
    }
}

/// The sign of a product or quotient.
/// The product excludes 0 if both factors do.
fn product(a: ValueSign, b: ValueSign) -> ValueSign {
    let same = not_negative(a) && not_negative(b) || not_positive(a) && not_positive(b);
    let other = not_negative(a) && not_positive(b) || not_positive(a) && not_negative(b);
    match (nonzero(a) && nonzero(b), same, other) {
        (true, true, _) => ValueSign::Positive,
        (true, _, true) => ValueSign::Negative,
        (true, ..) => ValueSign::NotZero,
        (false, true, _) => ValueSign::NotNegative,
        (false, _, true) => ValueSign::NotPositive,
        _ => ValueSign::Unknown,
    }
}

/// The sign of an expression that has one of two values.
/// This serves `if`, `min`, `max` and `homotopy`.
fn either(a: ValueSign, b: ValueSign) -> ValueSign {
    if a == b {
        a
    } else if nonzero(a) && nonzero(b) {
        ValueSign::NotZero
    } else if not_negative(a) && not_negative(b) {
        ValueSign::NotNegative
    } else if not_positive(a) && not_positive(b) {
        ValueSign::NotPositive
    } else {
        ValueSign::Unknown
    }
}
