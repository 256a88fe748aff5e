//! Overconstrained components that are equal by the constraint of their type (MLS 9.4).

use super::equations::assert_of;
use super::numbers::ComponentNumbers;
use super::{ElementOrigin, FlatEquation, FlatModel, OriginKind};
use crate::instance::Instance;
use crate::network::Network;
use bramah_expr::Exprs;

/// The equations of connections that the connection graph breaks.
pub(super) fn equations(
    instance: &mut Instance<'_, '_>,
    network: &Network,
    numbers: &ComponentNumbers,
    flat: &mut FlatModel,
) {
    for link in &network.constrained {
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
