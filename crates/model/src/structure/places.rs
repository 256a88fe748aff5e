//! Places of messages: in the model that was given, where a library's own text would tell its user nothing.

use super::draft::DaeDraft;
use crate::flat::{FlatVariable, InstanceInfo};
use bramah_expr::VarId;
use bramah_syntax::diag::Span;

/// Where a variable is declared; of a connector's, where the component with the connector is. If that stands in another
/// file than the model, the innermost component around it that does not, or else the one at the model's top level.
pub(super) fn own_place(draft: &DaeDraft, v: VarId) -> Span {
    place_of(&draft.variables, &draft.instances, v)
}

/// `own_place`, from the lists of variables and instances.
pub fn place_of(variables: &[FlatVariable], instances: &[InstanceInfo], v: VarId) -> Span {
    let origin = variables[v.index()].origin;
    let own_file = instances[0].span.file;
    let (mut place, mut at) = (origin.span, origin.instance);
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

/// Whether an instance has a flow variable of its own.
pub fn is_connector(variables: &[FlatVariable], instance: u32) -> bool {
    variables.iter().any(|v| v.flow && v.origin.instance == instance)
}
