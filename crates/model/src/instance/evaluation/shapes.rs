//! Sizes of expressions whose values may change.

use crate::instance::evaluation::references::ReferenceTarget;
use crate::instance::lookup::LookupResult;
use crate::instance::{Evaluator, LookupContext};
use bramah_syntax::ast::{Expr, ExprKind};

impl<'a> Evaluator<'_, 'a, '_> {
    /// Sizes of what a reference to components of the model selects: they are known where the values are not. `None` where
    /// it is anything else.
    pub(in crate::instance) fn declared_dims(&mut self, e: &'a Expr, view: LookupContext) -> Option<Vec<usize>> {
        let ExprKind::Reference(r) = &e.kind else { return None };
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

    /// Sizes of an expression whose value may change, where its form tells them.
    pub(in crate::instance) fn shape(&mut self, e: &'a Expr, view: LookupContext) -> Option<Vec<usize>> {
        self.instance.in_mode(|m| m.constant = true, |s| s.evaluator().shape_inside(e, view))
    }

    pub(in crate::instance) fn shape_inside(&mut self, e: &'a Expr, view: LookupContext) -> Option<Vec<usize>> {
        use bramah_syntax::ast::BinaryOp as B;
        match &e.kind {
            ExprKind::Reference(r) if r.parts.len() == 1 && r.parts[0].name.name == "time" => Some(Vec::new()),
            ExprKind::Reference(_) => self.declared_dims(e, view),
            ExprKind::Integer(_) | ExprKind::Real(_) | ExprKind::Boolean(_) => Some(Vec::new()),
            ExprKind::Unary(_, a) => self.shape_inside(a, view),
            ExprKind::Binary(op, a, b) => {
                let (a, b) = (self.shape_inside(a, view)?, self.shape_inside(b, view)?);
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
