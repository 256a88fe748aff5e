//! Signature help: the inputs of the function, or the parameters of the component, in whose brackets the cursor stands.

use super::complete::CompletionContext;
use super::{DocumentView, words};
use bramah_model::resolve::names::{self, NameTarget};
use bramah_syntax::ast::{CausalityPrefix, VariabilityPrefix};
use lsp_types::{Documentation, ParameterInformation, ParameterLabel, SignatureHelp, SignatureInformation};

/// Help for the innermost open bracket before a byte offset.
///
/// The label lists the arguments as declared; the present one is marked. Descriptions and units appear beside it.
///
/// `None`: no bracket is open, or its function or class cannot be resolved.
pub fn help(view: &mut DocumentView<'_, '_>, offset: u32) -> Option<SignatureHelp> {
    let context = CompletionContext::at(&view.text, offset);
    let call = context.calls.last()?;
    let scope = view.class_at(offset)?;
    let class = context.class_of(view.library, scope, context.calls.len())?;
    // A function shows its inputs, a component its public parameters.
    let function = words::is_function(view.library, class);
    let wanted = |m: &names::MemberComponent<'_>| match function {
        true => m.component.prefix.causality == Some(CausalityPrefix::Input),
        false => m.component.prefix.variability == Some(VariabilityPrefix::Parameter) && !m.protected,
    };
    let members: Vec<_> = names::members(view.library, class).into_iter().filter(wanted).collect();
    let mut label = format!("{}(", view.library.full_name(class));
    let mut parameters = Vec::new();
    for (i, member) in members.iter().enumerate() {
        if i > 0 {
            label.push_str(", ");
        }
        // The protocol marks a parameter by UTF-16 offsets in the label.
        let start = label.encode_utf16().count() as u32;
        label.push_str(
            // The prefixes are the same for all entries and would only lengthen the line.
            &words::declaration(view.library, member.component).replace("input ", "").replace("parameter ", ""),
        );
        let end = label.encode_utf16().count() as u32;
        let said = words::description(view.library, NameTarget::Component(*member)).unwrap_or_default();
        let unit = words::attribute(view.library, *member, "unit").map(|u| format!(", in {u}")).unwrap_or_default();
        parameters.push(ParameterInformation {
            label: ParameterLabel::LabelOffsets([start, end]),
            documentation: Some(Documentation::String(format!("{said}{unit}"))),
        });
    }
    label.push(')');
    let named = call.named.as_deref();
    // A named argument is found by its name. By position only functions can be called; modifiers are always named.
    let active = match named {
        Some(name) => members.iter().position(|m| m.component.name.name == name),
        None => function.then_some(call.commas),
    };
    Some(SignatureHelp {
        signatures: vec![SignatureInformation {
            label,
            documentation: words::description(view.library, NameTarget::Class(class))
                .map(|d| Documentation::String(d.to_owned())),
            parameters: Some(parameters),
            active_parameter: active.map(|i| i as u32),
        }],
        active_signature: Some(0),
        active_parameter: active.map(|i| i as u32),
    })
}
