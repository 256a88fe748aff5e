//! Places of messages in the text.
//!
//! A message points into the model that the user gave. The text of a library would not help its user, so a variable of
//! a library component is reported at the component. `messages` and the later crates call these functions.

use super::draft::DaeDraft;
use crate::flat::{FlatVariable, InstanceInfo};
use bramah_expr::VarId;
use bramah_syntax::diag::Span;

/// The place of a variable for messages about the draft: see [`place_of`].
pub(super) fn own_place(draft: &DaeDraft, v: VarId) -> Span {
    place_of(&draft.variables, &draft.instances, v)
}

/// The place of a variable in the user's model.
///
/// A variable is reported where it is declared, a variable of a connector where the component with the connector is
/// declared. If that is in another file than the model, the innermost component around it that is not takes its place,
/// or else the component at the model's top level.
pub fn place_of(variables: &[FlatVariable], instances: &[InstanceInfo], v: VarId) -> Span {
    let origin = variables[v.index()].origin;
    let own_file = instances[0].span.file;
    let (mut place, mut at) = (origin.span, origin.instance);
    // A connector is recognised by its flow variable.
    if at != 0 && variables.iter().any(|v| v.flow && v.origin.instance == at) {
        let connector = &instances[at as usize];
        (place, at) = (connector.span, connector.parent);
        if at != 0 {
            let component = &instances[at as usize];
            (place, at) = (component.span, component.parent);
        }
    }
    while at != 0 && place.file != own_file {
        let holder = &instances[at as usize];
        (place, at) = (holder.span, holder.parent);
    }
    place
}

/// Whether an instance has a flow variable of its own. Linear in the number of variables.
pub fn is_connector(variables: &[FlatVariable], instance: u32) -> bool {
    variables.iter().any(|v| v.flow && v.origin.instance == instance)
}
