//! The flat model as text, close to flat Modelica, for `check --emit flat` and for tests.
//!
//! The text is for readers and is not parsed anywhere. Names of variables keep their dots and indices.

use super::{
    FlatEquation, FlatModel, FlatVariable, MessagePart, MessageTemplate, ScalarType, Variability, WhenAction,
    WhenClause,
};
use bramah_expr::{ExprId, Exprs, VarId};
use std::fmt::Write;

impl FlatModel {
    /// The model as text: variables, equations, `when` clauses, assertions, conserved quantities and initial equations,
    /// each in the order of the model.
    ///
    /// `when` conditions are always printed as arrays, and names are not quoted.
    pub fn text(&self) -> String {
        let mut out = format!("model '{}'\n", self.class);
        for variable in &self.variables {
            let _ = writeln!(out, "  {}", self.declaration(variable));
        }
        self.section(&mut out, "equation", &self.equations);
        for when in &self.whens {
            self.when(&mut out, when);
        }
        for assert in &self.asserts {
            let _ = writeln!(out, "  assert({}, {});", self.expr(assert.condition), self.message(&assert.message));
        }
        for c in &self.conserved {
            let [quantity, rate, state] = [c.quantity, c.rate, c.state].map(|e| self.expr(e));
            let _ = writeln!(out, "  Connections.conserved({quantity}, {rate}, {state});");
        }
        if !self.initial_equations.is_empty() {
            self.section(&mut out, "initial equation", &self.initial_equations);
        }
        let _ = writeln!(out, "end '{}';", self.class);
        out
    }

    /// An expression with the names of variables.
    fn expr(&self, e: ExprId) -> String {
        self.exprs.print(e, &|v| self.name(v))
    }

    /// The name of a variable.
    fn name(&self, v: VarId) -> String {
        self.variables[v.index()].name.clone()
    }

    /// Appends a section with its title and its equations.
    /// An equation takes one line.
    fn section(&self, out: &mut String, title: &str, equations: &[FlatEquation]) {
        let _ = writeln!(out, "{title}");
        for e in equations {
            let _ = writeln!(out, "  {} = {};", self.expr(e.lhs), self.expr(e.rhs));
        }
    }

    /// The declaration of a variable: prefixes, type, name, modifiers, binding, description.
    /// An example is `parameter Real tank.V(unit = "m3") = 0.1 "volume";`.
    fn declaration(&self, v: &FlatVariable) -> String {
        let mut text = String::new();
        for (holds, word) in [(v.hidden, "protected "), (v.flow, "flow "), (v.input, "input "), (v.output, "output ")] {
            text.push_str(if holds { word } else { "" });
        }
        text.push_str(match (v.variability, v.ty) {
            (Variability::Constant, _) => "constant ",
            (Variability::Parameter, _) => "parameter ",
            (Variability::Discrete, ScalarType::Real) => "discrete ",
            _ => "",
        });
        text.push_str(match v.ty {
            ScalarType::Real => "Real",
            ScalarType::Integer => "Integer",
            ScalarType::Boolean => "Boolean",
            ScalarType::Enumeration(e) => self.enumerations.get(e as usize).map_or("enumeration", |e| e.0.as_str()),
        });
        let _ = write!(text, " {}", v.name);
        let modifiers = self.modifiers(v);
        if !modifiers.is_empty() {
            let _ = write!(text, "({})", modifiers.join(", "));
        }
        if let Some(binding) = v.binding {
            let _ = write!(text, " = {}", self.expr(binding));
        }
        if let Some(description) = &v.description {
            let _ = write!(text, " {description:?}");
        }
        text + ";"
    }

    /// The attributes of a variable that differ from their defaults.
    /// Each is printed as `name = value`; texts are quoted.
    fn modifiers(&self, v: &FlatVariable) -> Vec<String> {
        let quoted = |name: &str, text: &Option<Box<str>>| text.as_ref().map(|t| format!("{name} = {t:?}"));
        let value = |name: &str, e: Option<ExprId>| e.map(|e| format!("{name} = {}", self.expr(e)));
        let all = [
            quoted("unit", &v.unit),
            quoted("displayUnit", &v.display_unit),
            value("min", v.min),
            value("max", v.max),
            value("nominal", v.nominal),
            value("start", v.start),
            // `fixed = true` is the default of parameters.
            (v.fixed && v.variability > Variability::Parameter).then(|| "fixed = true".to_owned()),
        ];
        all.into_iter().flatten().collect()
    }

    /// Appends a `when` clause. Each branch lists its conditions as an array, as the flat model has it.
    /// The first branch begins with `when`, the others with `elsewhen`.
    fn when(&self, out: &mut String, when: &WhenClause) {
        for (i, branch) in when.branches.iter().enumerate() {
            let conditions: Vec<String> = branch.conditions.iter().map(|&c| self.expr(c)).collect();
            let word = if i == 0 { "when" } else { "elsewhen" };
            let _ = writeln!(out, "  {word} {{{}}} then", conditions.join(", "));
            for action in &branch.actions {
                let _ = writeln!(out, "    {};", self.action(action));
            }
        }
        out.push_str("  end when;\n");
    }

    /// A statement of a `when` as text.
    /// A guard is printed as an `if` around the statement.
    fn action(&self, action: &WhenAction) -> String {
        match action {
            WhenAction::Assign { variable, value, .. } => format!("{} = {}", self.name(*variable), self.expr(*value)),
            WhenAction::Reinit { variable, value, guard, .. } => {
                self.guarded(*guard, format!("reinit({}, {})", self.name(*variable), self.expr(*value)))
            }
            WhenAction::Assert(a) => format!("assert({}, {})", self.expr(a.condition), self.message(&a.message)),
            WhenAction::Terminate { message, guard, .. } => {
                self.guarded(*guard, format!("terminate({})", self.message(message)))
            }
        }
    }

    /// A statement inside `if`, unless its guard always holds.
    fn guarded(&self, guard: ExprId, action: String) -> String {
        if guard == Exprs::ONE { action } else { format!("if {} then {action}; end if", self.expr(guard)) }
    }

    /// A message as a concatenation of texts and values.
    /// Values are printed as `String(value)`.
    fn message(&self, message: &MessageTemplate) -> String {
        let part = |part: &MessagePart| match part {
            MessagePart::Text(text) => format!("{text:?}"),
            MessagePart::Value(e, _) => format!("String({})", self.expr(*e)),
        };
        message.parts.iter().map(part).collect::<Vec<_>>().join(" + ")
    }
}
