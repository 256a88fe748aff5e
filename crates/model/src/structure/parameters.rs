//! Parameters: the order in which bindings are evaluated, their values, and what follows for expressions of them.

use super::draft::{Draft, Role};
use super::{ActionKind, blt, messages};
use crate::flat::Equation;
use crate::flat::{OriginKind, Type, Variability, Variable};
use bramah_expr::{ExprId, Exprs, Node, VarId};
use bramah_syntax::diag::{Code, Diagnostic};

/// Sorts the parameters so that each binding refers to earlier ones only, after moving those that depend on free
/// parameters to the free ones: their bindings become initial equations. The error is a circle of bindings that no
/// condition opens.
pub(super) fn order(draft: &mut Draft) -> Result<Vec<VarId>, Diagnostic> {
    loop {
        match sorted_parameters(draft) {
            Ok((uses, order)) => return Ok(without_free(draft, &uses, order)),
            Err(Circle { before, members }) => {
                if !decide_conditions(draft, &before, &members) {
                    return Err(messages::cyclic_parameters(draft, &members));
                }
            }
        }
    }
}

/// Parameters whose bindings use each other, and those that come before them.
struct Circle {
    before: Vec<VarId>,
    members: Vec<VarId>,
}

/// `T = if useT then T0 else f(h)` and `h = if useT then g(T) else h0` use each other on paper only: conditions that are known
/// decide now, and what they read is fixed with the model. False where no binding has such a condition.
fn decide_conditions(draft: &mut Draft, before: &[VarId], members: &[VarId]) -> bool {
    let values = values(draft, before);
    let mut decided = false;
    for &v in members {
        let Some(binding) = draft.variables[v.index()].binding else { continue };
        let mut chosen = Vec::new();
        for e in draft.exprs.reachable(&[binding], |_| true) {
            let Node::If(condition, yes, no) = draft.exprs.node(e) else { continue };
            let found = draft.exprs.dependencies(&[condition]);
            if found.time || !found.ders.is_empty() || !found.pres.is_empty() {
                continue;
            }
            if !found.vars.iter().all(|u| !values[u.index()].is_nan()) {
                continue;
            }
            let holds = draft.exprs.eval(condition, &mut |node| match node {
                Node::Var(u) => values[u.index()],
                _ => f64::NAN,
            });
            if holds.is_finite() {
                chosen.push((e, if holds == 0.0 { no } else { yes }));
                fix(draft, &found.vars);
            }
        }
        // one at a time, from outside: what is chosen may hold further ones
        if let Some(&first) = chosen.iter().find(|(e, _)| *e == binding).or(chosen.last()) {
            draft.variables[v.index()].binding = Some(draft.exprs.substitute(binding, &[first]));
            decided = true;
        }
    }
    decided
}

fn sorted_parameters(draft: &Draft) -> Result<(Uses, Vec<VarId>), Circle> {
    let bound = draft.with_role(Role::Parameter);
    let mut position = vec![u32::MAX; draft.variables.len()];
    for (i, v) in bound.iter().enumerate() {
        position[v.index()] = i as u32;
    }
    let uses = Uses::of(draft);
    let sorted = blt::components(bound.len(), |node, out| {
        let used = uses.of_variable(bound[node as usize]).iter();
        out.extend(used.map(|u| position[u.index()]).filter(|&p| p != u32::MAX));
    });
    let mut before = Vec::with_capacity(bound.len());
    for members in sorted.iter() {
        let first = bound[members[0] as usize];
        if members.len() > 1 || uses.of_variable(first).contains(&first) {
            return Err(Circle { before, members: members.iter().map(|&m| bound[m as usize]).collect() });
        }
        before.push(first);
    }
    Ok((uses, before))
}

/// Moves dependents of free parameters to the free ones.
fn without_free(draft: &mut Draft, uses: &Uses, order: Vec<VarId>) -> Vec<VarId> {
    let mut kept = Vec::with_capacity(order.len());
    for v in order {
        if !uses.of_variable(v).iter().any(|u| draft.role(*u) == Role::FreeParameter) {
            kept.push(v);
            continue;
        }
        draft.roles[v.index()] = Role::FreeParameter;
        if let Some(binding) = draft.variables[v.index()].binding.take() {
            let lhs = draft.exprs.var(v);
            let origin = crate::flat::Origin { kind: OriginKind::Binding, ..draft.variables[v.index()].origin };
            draft.initial_equations.push(Equation { lhs, rhs: binding, origin });
        }
    }
    kept
}

/// The variables that each binding uses.
struct Uses {
    starts: Vec<u32>,
    used: Vec<VarId>,
}

impl Uses {
    fn of(draft: &Draft) -> Self {
        let mut found = Uses { starts: Vec::with_capacity(draft.variables.len() + 1), used: Vec::new() };
        let mut walk = bramah_expr::visit::Walk::default();
        for (v, role) in draft.variables.iter().zip(&draft.roles) {
            found.starts.push(found.used.len() as u32);
            if let (Some(binding), Role::Parameter) = (v.binding, role) {
                walk.each(&draft.exprs, &[binding], |_, node| {
                    if let Node::Var(u) = node {
                        found.used.push(u);
                    }
                    true
                });
            }
        }
        found.starts.push(found.used.len() as u32);
        found
    }

    fn of_variable(&self, v: VarId) -> &[VarId] {
        &self.used[self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize]
    }
}

/// Fixes parameters with the structure, and all that they are computed from.
pub(super) fn fix(draft: &mut Draft, parameters: &[VarId]) {
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

/// The values of all parameters as they stand in the model; 0 where there is none (flatten has reported that).
pub(super) fn values(draft: &Draft, order: &[VarId]) -> Vec<f64> {
    let mut values = vec![f64::NAN; draft.variables.len()];
    let mut evaluation = bramah_expr::eval::Evaluation::default();
    for &v in order {
        let variable = &draft.variables[v.index()];
        let given = variable.binding.or(variable.start);
        values[v.index()] = match given {
            Some(e) => evaluation.value(&draft.exprs, e, &mut |node| match node {
                Node::Var(u) => values[u.index()],
                _ => f64::NAN,
            }),
            None => default_start(variable.ty),
        };
    }
    values
}

/// Parameters whose value is no number (E217) or lies outside their range (E215); a value that is only passed on is reported
/// where it comes from.
pub(super) fn check(draft: &Draft, order: &[VarId], values: &[f64]) -> Vec<Diagnostic> {
    let mut wrong = vec![false; draft.variables.len()];
    let mut reported = Vec::new();
    for &v in order {
        let source = draft.variables[v.index()].binding.map(|b| draft.exprs.node(b));
        if let Some(Node::Var(u)) = source
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

/// A value below `min` or above `max`, without its place.
pub fn out_of_range(variable: &Variable, value: f64, low: Option<f64>, high: Option<f64>) -> Option<Diagnostic> {
    let bound = match (low, high) {
        (Some(low), _) if value < low => format!("less than its `min`, {low}"),
        (_, Some(high)) if value > high => format!("more than its `max`, {high}"),
        _ => return None,
    };
    let unit = variable.unit.as_deref().filter(|u| *u != "1").map(|u| format!(" {u}")).unwrap_or_default();
    Some(Diagnostic::new(Code::OutOfRange, format!("`{}` is {value}{unit}, {bound}{unit}", variable.name)))
}

fn check_one(draft: &Draft, v: VarId, values: &[f64]) -> Option<Diagnostic> {
    let variable = &draft.variables[v.index()];
    let value = values[v.index()];
    let known = |e: ExprId| {
        if let Some(number) = draft.exprs.as_num(e) {
            return Some(number);
        }
        let used = draft.exprs.dependencies(&[e]).vars;
        used.iter().all(|u| values[u.index()].is_finite()).then(|| {
            draft.exprs.eval(e, &mut |node| match node {
                Node::Var(u) => values[u.index()],
                _ => f64::NAN,
            })
        })
    };
    if !value.is_finite() {
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
        // the component of the model that was given: what holds the value may stand in the library
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

/// The start value of a type when none is given.
pub(super) fn default_start(ty: Type) -> f64 {
    if matches!(ty, Type::Enumeration(_)) { 1.0 } else { 0.0 }
}

/// What is known about the value of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    Unknown,
    Positive,
    Negative,
    NotNegative,
    NotPositive,
    NotZero,
}

/// Signs and parameter values of all nodes of a growing pool.
#[derive(Clone, Debug, Default)]
pub(super) struct Known {
    variables: Vec<f64>,
    /// Signs of variables that have no known value.
    signs_of: Vec<Sign>,
    values: Vec<f64>,
    signs: Vec<Sign>,
}

impl Known {
    /// From the parameters' values; NaN for all other variables.
    pub fn new(draft: &Draft, variables: Vec<f64>) -> Self {
        let signs_of = variable_signs(draft, &variables);
        Known { variables, signs_of, ..Known::default() }
    }

    /// The value of an expression of parameters.
    pub fn value(&mut self, pool: &Exprs, e: ExprId) -> Option<f64> {
        self.extend(pool);
        Some(self.values[e.index()]).filter(|v| !v.is_nan())
    }

    /// The value of a parameter.
    pub fn value_of(&self, v: VarId) -> Option<f64> {
        self.variables.get(v.index()).copied().filter(|value| !value.is_nan())
    }

    /// True when an expression cannot vanish, whatever variables and time are, with the parameters as they are.
    pub fn is_nonzero(&mut self, pool: &Exprs, e: ExprId) -> bool {
        self.extend(pool);
        matches!(self.signs[e.index()], Sign::Positive | Sign::Negative | Sign::NotZero)
    }

    fn extend(&mut self, pool: &Exprs) {
        for i in self.values.len()..pool.len() {
            let e = ExprId(i as u32);
            let value = self.node_value(pool, e);
            let sign = if value.is_finite() { sign_of(value) } else { self.node_sign(pool, e) };
            self.values.push(value);
            self.signs.push(sign);
        }
    }

    fn node_value(&self, pool: &Exprs, e: ExprId) -> f64 {
        let node = pool.node(e);
        let operands = pool.operands(e);
        let known =
            !operands.as_slice().is_empty() && operands.as_slice().iter().all(|a| !self.values[a.index()].is_nan());
        match node {
            Node::Num(bits) => f64::from_bits(bits),
            Node::Var(v) => self.variables.get(v.index()).copied().unwrap_or(f64::NAN),
            Node::If(c, a, b) if !self.values[c.index()].is_nan() => {
                self.values[if self.values[c.index()] == 0.0 { b } else { a }.index()]
            }
            Node::Sample(..) => f64::NAN,
            Node::Delay(a, _) => self.values[a.index()],
            _ if known => self.combined(pool, e),
            _ => f64::NAN,
        }
    }

    /// The value of a node of which all arguments are known.
    fn combined(&self, pool: &Exprs, e: ExprId) -> f64 {
        let leaf = |node: Node| match node {
            Node::Var(v) => self.variables.get(v.index()).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        };
        match pool.node(e) {
            Node::Unary(op, a) => bramah_expr::math::unary(op, self.values[a.index()]),
            Node::Binary(op, a, b) => bramah_expr::math::binary(op, self.values[a.index()], self.values[b.index()]),
            _ => pool.eval(e, &mut { leaf }),
        }
    }

    fn node_sign(&self, pool: &Exprs, e: ExprId) -> Sign {
        use bramah_expr::{Binary, Unary};
        let of = |a: ExprId| self.signs[a.index()];
        match pool.node(e) {
            Node::Unary(op, a) => match op {
                Unary::Neg => opposite(of(a)),
                Unary::Exp | Unary::Cosh => Sign::Positive,
                Unary::Abs if nonzero(of(a)) => Sign::Positive,
                Unary::Sqrt if of(a) == Sign::Positive => Sign::Positive,
                Unary::Log => self.logarithm(pool, a),
                Unary::Abs | Unary::Sqrt | Unary::Not => Sign::NotNegative,
                Unary::Sinh | Unary::Tanh | Unary::Atan | Unary::Sign => of(a),
                _ => Sign::Unknown,
            },
            Node::Binary(op, a, b) => match op {
                Binary::Add => sum(of(a), of(b)),
                Binary::Sub => sum(of(a), opposite(of(b))),
                Binary::Mul if a == b => {
                    if nonzero(of(a)) {
                        Sign::Positive
                    } else {
                        Sign::NotNegative
                    }
                }
                // A quotient of something that is not 0 is not 0 either, unless it overflows.
                // what is divided by Modelica.Constants.inf is nothing
                Binary::Div if self.values[b.index()].abs() >= INFINITE => Sign::NotNegative,
                Binary::Mul | Binary::Div => product(of(a), of(b)),
                Binary::Pow => self.power(of(a), b),
                Binary::Max if of(a) == Sign::Positive || of(b) == Sign::Positive => Sign::Positive,
                Binary::Max if not_negative(of(a)) || not_negative(of(b)) => Sign::NotNegative,
                Binary::Min if of(a) == Sign::Negative || of(b) == Sign::Negative => Sign::Negative,
                Binary::Min | Binary::Max => either(of(a), of(b)),
                _ => Sign::Unknown,
            },
            Node::If(_, a, b) | Node::Homotopy(a, b) => either(of(a), of(b)),
            Node::Rel(..) => Sign::NotNegative,
            Node::Var(v) => self.signs_of.get(v.index()).copied().unwrap_or(Sign::Unknown),
            _ => Sign::Unknown,
        }
    }

    /// log(1 + something that is not negative), as in a softplus.
    fn logarithm(&self, pool: &Exprs, e: ExprId) -> Sign {
        let Node::Binary(bramah_expr::Binary::Add, a, b) = pool.node(e) else { return Sign::Unknown };
        let beyond = |one: ExprId, rest: ExprId| match self.signs[rest.index()] {
            sign @ (Sign::Positive | Sign::NotNegative) if self.values[one.index()] >= 1.0 => sign,
            _ => Sign::Unknown,
        };
        if beyond(a, b) == Sign::Unknown { beyond(b, a) } else { beyond(a, b) }
    }

    fn power(&self, base: Sign, exponent: ExprId) -> Sign {
        let even = self.values[exponent.index()] % 2.0 == 0.0;
        match base {
            Sign::Positive => Sign::Positive,
            _ if even && nonzero(base) => Sign::Positive,
            _ if even => Sign::NotNegative,
            Sign::NotNegative => Sign::NotNegative,
            _ => Sign::Unknown,
        }
    }
}

/// Modelica.Constants.inf.
const INFINITE: f64 = 1e60;

/// Variables are followed through so many definitions.
const DEPTH: usize = 4;

/// Signs of variables: of those that stand still, and of those that an equation sets equal to something of known sign.
fn variable_signs(draft: &Draft, values: &[f64]) -> Vec<Sign> {
    let mut known = Known { variables: values.to_vec(), ..Known::default() };
    let mut signs = vec![Sign::Unknown; draft.variables.len()];
    let mut definitions = Vec::new();
    for equation in &draft.equations {
        match draft.exprs.node(equation.lhs) {
            Node::Var(v) => definitions.push((v, equation.rhs)),
            Node::Der(v) if equation.rhs == Exprs::ZERO => {
                if let Some(value) = steady_value(draft, v, &mut known) {
                    signs[v.index()] = sign_of(value);
                }
            }
            _ => {}
        }
    }
    for _ in 0..DEPTH {
        known = Known { variables: known.variables, signs_of: signs.clone(), ..Known::default() };
        known.extend(&draft.exprs);
        for &(v, value) in &definitions {
            if signs[v.index()] == Sign::Unknown {
                signs[v.index()] = known.signs[value.index()];
            }
        }
        if signs == known.signs_of {
            break;
        }
    }
    signs
}

/// The value of a variable with derivative 0 that starts from a fixed value, is never reinitialized, and is not 0: that
/// may be another one in the next run, but hardly of another sign.
fn steady_value(draft: &Draft, v: VarId, known: &mut Known) -> Option<f64> {
    let variable = &draft.variables[v.index()];
    let reinitialized = || draft.actions.iter().any(|a| matches!(a.kind, ActionKind::Reinit(w, _) if w == v));
    let start = variable.start.filter(|_| variable.fixed && !reinitialized())?;
    known.value(&draft.exprs, start).filter(|value| *value != 0.0)
}

fn sign_of(value: f64) -> Sign {
    if value > 0.0 {
        Sign::Positive
    } else if value < 0.0 {
        Sign::Negative
    } else {
        Sign::NotNegative
    }
}

fn nonzero(s: Sign) -> bool {
    matches!(s, Sign::Positive | Sign::Negative | Sign::NotZero)
}

fn not_negative(s: Sign) -> bool {
    matches!(s, Sign::Positive | Sign::NotNegative)
}

fn not_positive(s: Sign) -> bool {
    matches!(s, Sign::Negative | Sign::NotPositive)
}

fn opposite(s: Sign) -> Sign {
    match s {
        Sign::Positive => Sign::Negative,
        Sign::Negative => Sign::Positive,
        Sign::NotNegative => Sign::NotPositive,
        Sign::NotPositive => Sign::NotNegative,
        other => other,
    }
}

fn sum(a: Sign, b: Sign) -> Sign {
    let strict = nonzero(a) || nonzero(b);
    if not_negative(a) && not_negative(b) {
        if strict { Sign::Positive } else { Sign::NotNegative }
    } else if not_positive(a) && not_positive(b) {
        if strict { Sign::Negative } else { Sign::NotPositive }
    } else {
        Sign::Unknown
    }
}

fn product(a: Sign, b: Sign) -> Sign {
    let same = not_negative(a) && not_negative(b) || not_positive(a) && not_positive(b);
    let other = not_negative(a) && not_positive(b) || not_positive(a) && not_negative(b);
    match (nonzero(a) && nonzero(b), same, other) {
        (true, true, _) => Sign::Positive,
        (true, _, true) => Sign::Negative,
        (true, ..) => Sign::NotZero,
        (false, true, _) => Sign::NotNegative,
        (false, _, true) => Sign::NotPositive,
        _ => Sign::Unknown,
    }
}

fn either(a: Sign, b: Sign) -> Sign {
    if a == b {
        a
    } else if nonzero(a) && nonzero(b) {
        Sign::NotZero
    } else if not_negative(a) && not_negative(b) {
        Sign::NotNegative
    } else if not_positive(a) && not_positive(b) {
        Sign::NotPositive
    } else {
        Sign::Unknown
    }
}
