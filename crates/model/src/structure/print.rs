//! The sorted systems as text, for `check --emit` and for tests.
//!
//! The text uses the names of variables as the user wrote them. It is for readers and is not parsed anywhere.

use super::{AlgebraicLoop, BltBlock, Dae, ExplicitAssignment, Unknown};
use bramah_expr::{ExprId, VarId};
use std::fmt::Write;

impl Dae {
    /// The name of a variable.
    pub fn name(&self, v: VarId) -> &str {
        &self.variables[v.index()].name
    }

    /// An unknown as the user would write it: a name, or `der(name)`.
    pub fn unknown_name(&self, unknown: Unknown) -> String {
        match unknown {
            Unknown::Var(v) => self.name(v).to_owned(),
            Unknown::Der(v) => format!("der({})", self.name(v)),
        }
    }

    /// An expression with the names of variables.
    pub fn text(&self, e: ExprId) -> String {
        self.exprs.print(e, &|v| self.name(v).to_owned())
    }

    /// One of the sorted systems: a line for each assignment, with the parts of loops indented.
    /// A loop begins with a line such as `linear loop for a, b`; a mixed loop with `mixed`.
    pub fn blocks_text(&self, blocks: &[BltBlock]) -> String {
        let mut out = String::new();
        self.write_blocks(blocks, 0, &mut out);
        out
    }

    /// States, aliases and the continuous system: the block lower triangular form.
    /// `check --emit` prints it.
    pub fn blt_text(&self) -> String {
        let mut out = String::new();
        let names: Vec<&str> = self.states.iter().map(|&v| self.name(v)).collect();
        line(&mut out, 0, &format!("states: {}", names.join(", ")));
        for alias in &self.aliases {
            let sign = if alias.negated { "-" } else { "" };
            line(&mut out, 0, &format!("{} = {sign}{}", self.name(alias.variable), self.name(alias.target)));
        }
        line(&mut out, 0, "continuous:");
        self.write_blocks(&self.continuous, 1, &mut out);
        out
    }

    /// All of it: [`Dae::blt_text`], then the event and the initial system.
    pub fn dae_text(&self) -> String {
        let mut out = self.blt_text();
        line(&mut out, 0, "event:");
        self.write_blocks(&self.event, 1, &mut out);
        line(&mut out, 0, "initial:");
        self.write_blocks(&self.initial, 1, &mut out);
        out
    }

    /// Appends blocks at an indentation of `depth` levels.
    fn write_blocks(&self, blocks: &[BltBlock], depth: usize, out: &mut String) {
        for block in blocks {
            match block {
                BltBlock::Assign(assign) => self.write_assign(assign, depth, out),
                BltBlock::Loop(found) => self.write_loop(found, depth, out),
                BltBlock::Mixed(mixed) => {
                    line(out, depth, "mixed");
                    self.write_blocks(&mixed.continuous, depth + 1, out);
                    for assign in &mixed.discrete {
                        self.write_assign(assign, depth + 1, out);
                    }
                }
            }
        }
    }

    /// Appends one assignment.
    fn write_assign(&self, assign: &ExplicitAssignment, depth: usize, out: &mut String) {
        line(out, depth, &format!("{} := {}", self.unknown_name(assign.unknown), self.text(assign.value)));
    }

    /// Appends a loop: its tearing variables, then its assignments, then its residuals.
    fn write_loop(&self, found: &AlgebraicLoop, depth: usize, out: &mut String) {
        let names: Vec<String> = found.tearing.iter().map(|&u| self.unknown_name(u)).collect();
        // Linear means that the residuals are affine in the tearing variables.
        let kind = if found.linear { "linear" } else { "nonlinear" };
        line(out, depth, &format!("{kind} loop for {}", names.join(", ")));
        for assign in &found.inner {
            self.write_assign(assign, depth + 1, out);
        }
        for &(residual, _) in &found.residuals {
            line(out, depth + 1, &format!("0 = {}", self.text(residual)));
        }
    }
}

/// Appends a line with an indentation of two spaces for each level.
fn line(out: &mut String, depth: usize, text: &str) {
    writeln!(out, "{:1$}{text}", "", 2 * depth).expect("writing to a string works");
}
