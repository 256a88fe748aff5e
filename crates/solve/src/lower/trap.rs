//! Finding the operation that made a value that is not finite.

use super::ExecutableSystem;
use bramah_expr::eval::EvaluationCache;
use bramah_expr::function::ExternalFunction;
use bramah_expr::print::number;
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use rustc_hash::FxHashMap;

/// The first operation that made a value that is not finite.
#[derive(Clone, Debug, PartialEq)]
pub struct NonFiniteTrap {
    /// The operation with its numbers, as in `sqrt(-3.2)`.
    pub operation: String,
    /// The same operation as the user wrote it, as in `sqrt(valve.dp)`.
    pub written: String,
    /// Its value: infinite or NaN.
    pub value: f64,
    /// What a function carried out in Rust said about it.
    pub trouble: Option<String>,
}

/// Texts are cut off after about this many bytes.
const LONGEST: usize = 200;

/// The first operation in `e`, in the order of evaluation, whose arguments are finite and whose value is not; or the
/// leaf that is not finite itself.
pub fn find(system: &ExecutableSystem, e: ExprId, values: &[f64]) -> Option<NonFiniteTrap> {
    let pool = &system.dae.exprs;
    let mut leaf = |node: ExprNode| system.leaf(node, values);
    let mut evaluation = EvaluationCache::default();
    if evaluation.value(pool, e, &mut leaf).is_finite() {
        return None;
    }
    let mut at = e;
    loop {
        let needed = needed_operands(pool, at, &mut |c| evaluation.value(pool, c, &mut leaf));
        let culprit = needed.into_iter().find(|&operand| !evaluation.value(pool, operand, &mut leaf).is_finite());
        match culprit {
            Some(operand) => at = operand,
            None => break,
        }
    }
    let value = evaluation.value(pool, at, &mut leaf);
    let names = |v: VarId| system.dae.variables[v.index()].name.clone();
    let written = pool.print_short(at, &names, LONGEST);
    let operation = with_numbers(pool, at, &mut |operand| evaluation.value(pool, operand, &mut leaf));
    let trouble = match pool.node(at) {
        ExprNode::Call(function, ..) => {
            pool.functions[function.0 as usize].external().and_then(ExternalFunction::trouble)
        }
        _ => None,
    };
    Some(NonFiniteTrap { operation, written, value, trouble })
}

/// The arguments that are evaluated for this value.
fn needed_operands(pool: &Exprs, e: ExprId, value: &mut impl FnMut(ExprId) -> f64) -> Vec<ExprId> {
    match pool.node(e) {
        ExprNode::If(c, a, b) => vec![c, if value(c) == 0.0 { b } else { a }],
        ExprNode::Homotopy(a, _) | ExprNode::Delay(a, _) => vec![a],
        ExprNode::Sample(..) => Vec::new(),
        _ => pool.operands(e).as_slice().to_vec(),
    }
}

/// The operation with the values of its arguments in their place.
fn with_numbers(pool: &Exprs, e: ExprId, value: &mut impl FnMut(ExprId) -> f64) -> String {
    let mut small = Exprs::default();
    small.functions.clone_from(&pool.functions);
    let operands = pool.operands(e).as_slice().to_vec();
    // Names stand for numbers, so that nothing is folded.
    let numbers: Vec<f64> = operands.iter().map(|&operand| value(operand)).collect();
    let places: FxHashMap<ExprId, ExprId> =
        operands.iter().zip(0..).map(|(&operand, i)| (operand, small.var(VarId(i)))).collect();
    let copy = match pool.node(e) {
        ExprNode::Unary(op, a) => small.intern(ExprNode::Unary(op, places[&a])),
        ExprNode::Binary(op, a, b) => small.intern(ExprNode::Binary(op, places[&a], places[&b])),
        ExprNode::Call(function, output, args) => {
            let args: Vec<ExprId> = pool.args(args).iter().map(|arg| places[arg]).collect();
            small.call(function, output, &args)
        }
        _ => return String::new(),
    };
    let brackets = matches!(pool.node(e), ExprNode::Binary(..));
    let names = |v: VarId| {
        let value = numbers.get(v.index()).copied().unwrap_or(f64::NAN);
        let text = number(value, Some(6));
        if brackets && value.is_sign_negative() { format!("({text})") } else { text }
    };
    small.print_short(copy, &names, LONGEST)
}
