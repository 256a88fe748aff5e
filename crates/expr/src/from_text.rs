//! Builds expressions from Modelica text, for tests.
//! It knows what tests need and panics on anything else. `find` gives the variable of a name.

use super::{BinaryFunction, ExprId, Exprs, RelationalOp, UnaryFunction, VarId};
use bramah_syntax::ast::{BinaryOp, ComponentReference, Expr, ExprKind, UnaryOp};
use bramah_syntax::diag::FileId;

/// The expression of a text. The names `time` and `pi` have their meaning; `der` and `pre` apply to names.
pub fn read(pool: &mut Exprs, text: &str, find: &dyn Fn(&str) -> VarId) -> ExprId {
    let tree = bramah_syntax::parse_expression(FileId(0), text).value.unwrap_or_else(|| panic!("cannot read {text}"));
    build(pool, &tree, find)
}

/// The expression of a syntax tree.
fn build(pool: &mut Exprs, tree: &Expr, find: &dyn Fn(&str) -> VarId) -> ExprId {
    match &tree.kind {
        #[allow(clippy::cast_precision_loss, reason = "small numbers")]
        ExprKind::Integer(value) => pool.num(*value as f64),
        ExprKind::Real(value) => pool.num(*value),
        ExprKind::Boolean(value) => pool.boolean(*value),
        ExprKind::Reference(reference) => match name(reference) {
            "time" => pool.time(),
            "pi" => pool.num(std::f64::consts::PI),
            name => pool.var(find(name)),
        },
        ExprKind::Unary(op, a) => {
            let a = build(pool, a, find);
            if *op == UnaryOp::Not { pool.not(a) } else { pool.neg(a) }
        }
        ExprKind::Binary(op, a, b) => {
            let (a, b) = (build(pool, a, find), build(pool, b, find));
            binary(pool, *op, a, b)
        }
        ExprKind::If { branches, otherwise } => {
            // From the last branch backwards: each `else` is the expression built so far.
            branches.iter().rev().fold(build(pool, otherwise, find), |rest, (c, a)| {
                let (c, a) = (build(pool, c, find), build(pool, a, find));
                pool.if_(c, a, rest)
            })
        }
        ExprKind::Tuple(parts) => build(pool, parts[0].as_ref().expect("a part"), find),
        ExprKind::Call { function, args, .. } => call(pool, name(function), args, find),
        other => panic!("not in tests: {other:?}"),
    }
}

/// The first identifier of a reference. Names in tests have no dots.
/// The name of a function or variable.
fn name(reference: &ComponentReference) -> &'static str {
    reference.parts[0].name.name.as_str()
}

/// An infix operator. Relations make events, as in a model.
/// Element-wise operators are not known here.
fn binary(pool: &mut Exprs, op: BinaryOp, a: ExprId, b: ExprId) -> ExprId {
    let rel = match op {
        BinaryOp::Lt => RelationalOp::Lt,
        BinaryOp::Le => RelationalOp::Le,
        BinaryOp::Gt => RelationalOp::Gt,
        BinaryOp::Ge => RelationalOp::Ge,
        BinaryOp::Eq => RelationalOp::Eq,
        BinaryOp::Ne => RelationalOp::Ne,
        BinaryOp::Add => return pool.add(a, b),
        BinaryOp::Sub => return pool.sub(a, b),
        BinaryOp::Mul => return pool.mul(a, b),
        BinaryOp::Div => return pool.div(a, b),
        BinaryOp::Pow => return pool.pow(a, b),
        BinaryOp::And => return pool.and(a, b),
        BinaryOp::Or => return pool.or(a, b),
        other => panic!("not in tests: {other:?}"),
    };
    // All operators left are relations.
    pool.event_rel(rel, a, b)
}

/// A call of a built-in function.
/// `function` is the name before the bracket.
fn call(pool: &mut Exprs, function: &str, args: &[Expr], find: &dyn Fn(&str) -> VarId) -> ExprId {
    if let ("der" | "pre", ExprKind::Reference(reference)) = (function, &args[0].kind) {
        let v = find(name(reference));
        return if function == "der" { pool.der(v) } else { pool.pre(v) };
    }
    let args: Vec<ExprId> = args.iter().map(|arg| build(pool, arg, find)).collect();
    let op = match function {
        "min" => return pool.binary(BinaryFunction::Min, args[0], args[1]),
        "max" => return pool.binary(BinaryFunction::Max, args[0], args[1]),
        "atan2" => return pool.binary(BinaryFunction::Atan2, args[0], args[1]),
        "abs" => UnaryFunction::Abs,
        "sign" => UnaryFunction::Sign,
        "sqrt" => UnaryFunction::Sqrt,
        "exp" => UnaryFunction::Exp,
        "log" => UnaryFunction::Log,
        "log10" => UnaryFunction::Log10,
        "sin" => UnaryFunction::Sin,
        "cos" => UnaryFunction::Cos,
        "tan" => UnaryFunction::Tan,
        "asin" => UnaryFunction::Asin,
        "acos" => UnaryFunction::Acos,
        "atan" => UnaryFunction::Atan,
        "sinh" => UnaryFunction::Sinh,
        "cosh" => UnaryFunction::Cosh,
        "tanh" => UnaryFunction::Tanh,
        "floor" => UnaryFunction::Floor,
        other => panic!("not in tests: {other}"),
    };
    pool.unary(op, args[0])
}
