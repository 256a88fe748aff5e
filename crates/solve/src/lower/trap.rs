//! Search for the operation that made a value that is not finite, for error messages.
//!
//! An expression and the array of values enter. The search goes from the result to the first operand that is not
//! finite, until an operation has only finite operands. It uses the reference interpreter of `bramah_expr`.

use super::ExecutableSystem;
use bramah_expr::eval::EvaluationCache;
use bramah_expr::function::ExternalFunction;
use bramah_expr::print::number;
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use rustc_hash::FxHashMap;

/// The first operation that made a value that is not finite.
#[derive(Clone, Debug, PartialEq)]
pub struct NonFiniteTrap {
    /// The operation with the values of its operands, as in `sqrt(-3.2)`.
    pub operation: String,
    /// The same operation with the names of the model, as in `sqrt(valve.dp)`.
    pub written: String,
    /// Its value: infinite or NaN.
    pub value: f64,
    /// The message of an external function for its failure; `None` where there is none.
    pub trouble: Option<String>,
}

/// Texts are cut off after about this many bytes.
const LONGEST: usize = 200;

/// The first operation in `e`, in the order of evaluation, whose operands are finite and whose value is not.
///
/// It may also be a leaf that is not finite. `None` when the value of `e` is finite.
pub fn find(system: &ExecutableSystem, e: ExprId, values: &[f64]) -> Option<NonFiniteTrap> {
    let pool = &system.dae.exprs;
    let mut leaf = |node: ExprNode| system.leaf(node, values);
    let mut evaluation = EvaluationCache::default();
    if evaluation.value(pool, e, &mut leaf).is_finite() {
        return None;
    }
    let mut at = e;
    loop {
        // an operand that does not enter the value, as the other branch of an `if`, is not to blame
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

/// The operands that are evaluated for the value of a node.
fn needed_operands(pool: &Exprs, e: ExprId, value: &mut impl FnMut(ExprId) -> f64) -> Vec<ExprId> {
    match pool.node(e) {
        ExprNode::If(c, a, b) => vec![c, if value(c) == 0.0 { b } else { a }],
        ExprNode::Homotopy(a, _) | ExprNode::Delay(a, _) => vec![a],
        ExprNode::Sample(..) => Vec::new(),
        _ => pool.operands(e).as_slice().to_vec(),
    }
}

/// The operation with the values of its operands in their place; empty for other nodes.
fn with_numbers(pool: &Exprs, e: ExprId, value: &mut impl FnMut(ExprId) -> f64) -> String {
    let mut small = Exprs::default();
    small.functions.clone_from(&pool.functions);
    let operands = pool.operands(e).as_slice().to_vec();
    // operands become variables named by their values: numbers would be folded away
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
