//! What classes hold: inherited elements, the modifiers that reach them, and what names mean.

pub mod lookup;
pub mod modifiers;
pub mod template;
