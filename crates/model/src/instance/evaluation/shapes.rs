//! Sizes of expressions whose values may change during the run.
//!
//! `size(x, 1)` and the dimension `:` need sizes only. Values of variables are not known when the model is built, but
//! sizes are, so they are derived from the form of the expression.

use crate::instance::evaluation::references::ReferenceTarget;
use crate::instance::lookup::LookupResult;
use crate::instance::{Evaluator, LookupContext};
use bramah_syntax::ast::{Expr, ExprKind};

impl<'a> Evaluator<'_, 'a, '_> {
    /// The sizes of the components that a reference names. They are known even if the values are not.
    /// `None` if the expression is no reference to components of the model, or outside the mode `constant`.
    ///
    /// ```text
    /// Real x[n] = f(u);    // size(x, 1) is n, even if f(u) is not known
    /// ```
    pub(in crate::instance) fn declared_dims(&mut self, e: &'a Expr, view: LookupContext) -> Option<Vec<usize>> {
        let ExprKind::Reference(r) = &e.kind else { return None };
        // A local is no component: its sizes are those of its value.
        if !self.instance.eval.mode.constant || !r.global && self.instance.local(r.parts[0].name.name).is_some() {
            return None;
        }
        let from = if r.global { crate::instance::ROOT } else { view };
        let LookupResult::Component(scope, index) = self.instance.names().lookup(from, r.parts[0].name.name)? else {
            return None;
        };
        let node = self.instance.builder().component(scope, index)?;
        let mut at = self.selection(node);
        for (i, p) in r.parts.iter().enumerate() {
            if i > 0 {
                let ReferenceTarget::Nodes(next) = self.descend(&at, p) else { return None };
                at = next;
            }
            if !p.subscripts.is_empty() {
                at = self.subscript_selection(&at, p, view, r.span)?.ok()?;
            }
        }
        Some(at.dims)
    }

    /// The sizes of an expression, as far as its form determines them. Empty for scalars.
    /// `None` if its value must be computed to find them.
    pub(in crate::instance) fn shape(&mut self, e: &'a Expr, view: LookupContext) -> Option<Vec<usize>> {
        self.instance.in_mode(|m| m.constant = true, |s| s.evaluator().shape_inside(e, view))
    }

    /// Like [`Self::shape`], already in the mode `constant`. Sizes of operands are not checked against each other here.
    ///
    /// - References have the sizes of what they name, literals are scalars.
    /// - Operators follow the shapes of their operands.
    /// - Array constructors have the number of their elements in front, matrices join the sizes of their entries.
    /// - `if` has the shape of the first branch that is not excluded.
    /// - `fill` and elementwise functions are known; all other calls give `None`.
    ///
    /// An `if` whose condition is not known takes the shape of that branch.
    pub(in crate::instance) fn shape_inside(&mut self, e: &'a Expr, view: LookupContext) -> Option<Vec<usize>> {
        use bramah_syntax::ast::BinaryOp as B;
        match &e.kind {
            ExprKind::Reference(r) if r.parts.len() == 1 && r.parts[0].name.name == "time" => Some(Vec::new()),
            ExprKind::Reference(_) => self.declared_dims(e, view),
            ExprKind::Integer(_) | ExprKind::Real(_) | ExprKind::Boolean(_) => Some(Vec::new()),
            ExprKind::Unary(_, a) => self.shape_inside(a, view),
            ExprKind::Binary(op, a, b) => {
                let (a, b) = (self.shape_inside(a, view)?, self.shape_inside(b, view)?);
                // A scalar operand takes the shape of the other one; `*` of arrays follows linear algebra (MLS 10.6).
                match (op, a.len(), b.len()) {
                    (_, 0, 0) | (B::Pow, ..) => Some(a),
                    (_, 0, _) => Some(b),
                    (_, _, 0) => Some(a),
                    (B::Mul, 2, 2) => Some(vec![a[0], b[1]]),
                    (B::Mul, 2, 1) => Some(vec![a[0]]),
                    (B::Mul, 1, 2) => Some(vec![b[1]]),
                    (B::Mul, 1, 1) => Some(Vec::new()),
                    _ => Some(a),
                }
            }
            ExprKind::Array(items) => {
                let inner = items.iter().find_map(|e| self.shape_inside(e, view))?;
                Some(std::iter::once(items.len()).chain(inner).collect())
            }
            ExprKind::Matrix(rows) => {
                let mut all = [0, 0];
                for row in rows {
                    let mut width = 0;
                    let mut height = 1;
                    // Columns add up within a row, rows add up below each other. Vectors and scalars count as columns.
                    for e in row {
                        let part = self.shape_inside(e, view)?;
                        height = part.first().copied().unwrap_or(1);
                        width += part.get(1).copied().unwrap_or(1);
                    }
                    all = [all[0] + height, width];
                }
                Some(all.to_vec())
            }
            ExprKind::If { branches, otherwise } => {
                // The first branch that may be taken gives the shape: all branches must have the same one (MLS 3.6.5).
                for (condition, value) in branches {
                    let (known, _) = self.instance.attempt(|i| i.evaluator().constant_boolean(condition, view));
                    if known != Some(false) {
                        return self.shape_inside(value, view);
                    }
                }
                self.shape_inside(otherwise, view)
            }
            ExprKind::Call { function, args, .. } if function.parts.len() == 1 => {
                match function.parts[0].name.name.as_str() {
                    "fill" => {
                        let inner = self.shape_inside(args.first()?, view)?;
                        let (outer, _) = self.instance.attempt(|i| {
                            let sizes = args[1..].iter().map(|e| i.evaluator().dimension(e, view));
                            sizes.collect::<Option<Vec<usize>>>()
                        });
                        Some(outer?.into_iter().chain(inner).collect())
                    }
                    // These functions keep the shape of their argument.
                    "noEvent" | "pre" | "der" | "abs" | "sqrt" | "sin" | "cos" | "exp" => {
                        self.shape_inside(args.first()?, view)
                    }
                    _ => None,
                }
            }
            _ => None,
        }
    }
}
