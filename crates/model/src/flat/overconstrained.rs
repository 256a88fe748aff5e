//! Equations of overconstrained connections that the connection graph breaks (MLS 9.4).
//!
//! Such a connection states equality by the function `equalityConstraint` of its type, which has fewer results than the
//! type has components. `network` decides which connections these are; `flatten` calls [`equations`].

use super::equations::assert_of;
use super::numbers::ComponentNumbers;
use super::{ElementOrigin, FlatEquation, FlatModel, OriginKind};
use crate::instance::Instance;
use crate::network::Network;
use bramah_expr::Exprs;

/// Appends an equation `residue = 0` for each constraint of each broken connection, and the assertions of the
/// functions.
pub(super) fn equations(
    instance: &mut Instance<'_, '_>,
    network: &Network,
    numbers: &ComponentNumbers,
    flat: &mut FlatModel,
) {
    for link in &network.constrained {
        // `None` after a message.
        let Some(residue) = instance.builder().constraint_residue(link.a, link.b, link.span) else { continue };
        let origin =
            ElementOrigin { span: link.span, instance: numbers.of(link.scope), kind: OriginKind::ConnectPotential };
        for value in residue.values {
            flat.equations.push(FlatEquation { lhs: value, rhs: Exprs::ZERO, origin });
        }
        for call in residue.asserts {
            flat.asserts.extend(assert_of(instance, call, origin));
        }
    }
}
