//! Assertions about parameters alone. They are reported before the model is run, because no run can make them hold.
//!
//! Enters: the draft with its parameter values. Leaves: one diagnostic for each contradicted assertion. `analysis`
//! calls [`check`] once, after the ranges of parameters have been checked.

use super::draft::DaeDraft;
use super::parameters::SignAnalysis;
use crate::flat::{FlatAssertion, MessagePart, MessageTemplate, ScalarType};
use bramah_expr::Exprs;
use bramah_syntax::diag::{Code, Diagnostic};

/// Assertions that the parameters as they stand in the model contradict (E503). Assertions with
/// `AssertionLevel.warning` are left to the run. A condition whose value depends on anything but parameters is unknown
/// here and left to the run too.
pub(super) fn check(draft: &DaeDraft, known: &mut SignAnalysis) -> Vec<Diagnostic> {
    let broken = |a: &&FlatAssertion| !a.warning && known.value(&draft.exprs, a.condition) == Some(0.0);
    let broken: Vec<&FlatAssertion> = draft.asserts.iter().filter(broken).collect();
    broken.into_iter().map(|assert| complaint(draft, known, assert)).collect()
}

/// The message about one contradicted assertion: its text, the component that states it, and the values of the
/// parameters in its condition.
fn complaint(draft: &DaeDraft, known: &mut SignAnalysis, assert: &FlatAssertion) -> Diagnostic {
    let text = words(&draft.exprs, known, &assert.message);
    let mut made = Diagnostic::new(Code::AssertionFailed, text);
    let holder = &draft.instances[assert.origin.instance as usize];
    // Instance 0 is the model itself, which needs no place of its own.
    if assert.origin.instance != 0 {
        made = made.at(holder.span, "in this component").instance(holder.name.clone()).class(holder.class.clone());
    }
    made = made.at(assert.origin.span, "does not hold").help("change the parameters that it speaks of");
    let used = draft.exprs.dependencies(&[assert.condition]).vars;
    let values = used.iter().filter_map(|u| {
        let value = known.value_of(*u)?;
        Some(format!("`{}` is {value}", draft.variables[u.index()].name))
    });
    let values: Vec<String> = values.collect();
    if values.is_empty() { made } else { made.note(values.join(", ")) }
}

/// The text of a message with the values that are known. A Boolean prints as `true` or `false`; an unknown number
/// prints as `?`.
fn words(pool: &Exprs, known: &mut SignAnalysis, message: &MessageTemplate) -> String {
    let piece = |part: &MessagePart| match part {
        MessagePart::Text(words) => words.clone(),
        MessagePart::Value(e, ScalarType::Boolean) => {
            known.value(pool, *e).map(|v| (v != 0.0).to_string()).unwrap_or_default()
        }
        MessagePart::Value(e, _) => known.value(pool, *e).map_or_else(|| "?".into(), |v| v.to_string()),
    };
    message.parts.iter().map(piece).collect()
}
