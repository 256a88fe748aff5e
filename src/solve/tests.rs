//! Systems built by hand.

use crate::diag::{FileId, Span};
use crate::flat::{Origin, OriginKind, StateSelect, Type, Variability, Variable};

/// A plain continuous variable.
pub fn variable(name: &str) -> Variable {
    Variable {
        name: name.into(),
        ty: Type::Real,
        variability: Variability::Continuous,
        input: false,
        output: false,
        flow: false,
        hidden: false,
        binding: None,
        start: None,
        fixed: false,
        min: None,
        max: None,
        nominal: None,
        unit: None,
        display_unit: None,
        description: None,
        state_select: StateSelect::Default,
        origin: Origin { span: Span { file: FileId(0), start: 0, end: 0 }, instance: 0, kind: OriginKind::Declared },
    }
}
