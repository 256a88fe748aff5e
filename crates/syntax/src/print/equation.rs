//! The text of equations and statements, as methods of [`SyntaxPrinter`].
//! The caller has written the indentation and will write the semicolon. Blocks write the lines between, with their
//! items one level deeper.

use super::SyntaxPrinter;
use crate::ast::{Equation, EquationKind, Expr, ForIndex, Statement, StatementKind};

/// Writers of equations and statements.
impl SyntaxPrinter {
    /// An equation and its description, without its semicolon.
    pub(super) fn equation(&mut self, equation: &Equation) {
        match &equation.kind {
            EquationKind::Equal(left, right) => {
                self.simple_expression(left);
                self.word(" = ");
                self.expression(right);
            }
            EquationKind::Connect(a, b) => {
                self.word("connect(");
                self.expression(a);
                self.word(", ");
                self.expression(b);
                self.word(")");
            }
            EquationKind::Call(call) => self.expression(call),
            EquationKind::If { branches, otherwise } => {
                self.branches(["if ", "elseif "], branches, Self::equation);
                self.otherwise(otherwise, Self::equation);
            }
            EquationKind::For { iterators, body } => self.for_block(iterators, body, Self::equation),
            EquationKind::When(branches) => {
                self.branches(["when ", "elsewhen "], branches, Self::equation);
                self.close("end when");
            }
        }
        self.description(equation.description.as_deref());
    }

    /// A statement, without its semicolon.
    pub(super) fn statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Assign(target, value) => {
                self.simple_expression(target);
                self.word(" := ");
                self.expression(value);
            }
            StatementKind::AssignTuple(targets, value) => {
                self.tuple(targets);
                self.word(" := ");
                self.expression(value);
            }
            StatementKind::Call(call) => self.expression(call),
            StatementKind::If { branches, otherwise } => {
                self.branches(["if ", "elseif "], branches, Self::statement);
                self.otherwise(otherwise, Self::statement);
            }
            StatementKind::For { iterators, body } => self.for_block(iterators, body, Self::statement),
            StatementKind::While(condition, body) => {
                self.word("while ");
                self.expression(condition);
                self.end(" loop");
                self.lines(body, Self::statement);
                self.close("end while");
            }
            StatementKind::When(branches) => {
                self.branches(["when ", "elsewhen "], branches, Self::statement);
                self.close("end when");
            }
            StatementKind::Break => self.word("break"),
            StatementKind::Return => self.word("return"),
        }
    }

    /// Items one level deeper, each on its own line with a semicolon. `item` writes one without them.
    /// The order is that of the tree.
    pub(super) fn lines<T>(&mut self, items: &[T], item: fn(&mut Self, &T)) {
        self.depth += 1;
        for x in items {
            self.begin();
            item(self, x);
            self.end(";");
        }
        self.depth -= 1;
    }

    /// The branches of a block. `keywords` are those of the first and of the further branches.
    /// Each branch is the line of its condition and its items. `end` is left to the caller.
    fn branches<T>(&mut self, keywords: [&str; 2], branches: &[(Expr, Vec<T>)], item: fn(&mut Self, &T)) {
        for (i, (condition, body)) in branches.iter().enumerate() {
            // The caller has indented the first line.
            if i > 0 {
                self.begin();
            }
            self.word(keywords[i.min(1)]);
            self.expression(condition);
            self.end(" then");
            self.lines(body, item);
        }
    }

    /// The `else` branch, unless it is empty, and `end if`.
    /// A branch without items is not written, because it has no effect.
    fn otherwise<T>(&mut self, body: &[T], item: fn(&mut Self, &T)) {
        // An empty branch is left out with its keyword.
        if !body.is_empty() {
            self.line("else");
            self.lines(body, item);
        }
        self.close("end if");
    }

    /// A for-loop with its items.
    fn for_block<T>(&mut self, iterators: &[ForIndex], body: &[T], item: fn(&mut Self, &T)) {
        self.word("for ");
        self.iterators(iterators);
        self.end(" loop");
        self.lines(body, item);
        self.close("end for");
    }

    /// The last line of a block, which the caller ends with a semicolon.
    fn close(&mut self, text: &str) {
        self.begin();
        self.word(text);
    }
}
