//! Attributes of scalar variables that the instance and the flat model share: type, variability, `stateSelect`.
//! Also pieces of messages with values in them, as `assert` has.

use crate::ExprId;

/// The type of a scalar variable. All values are stored as `f64`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarType {
    /// Real.
    Real,
    /// Integer.
    Integer,
    /// Boolean, with the values 0 and 1.
    Boolean,
    /// An enumeration, by its index in `FlatModel::enumerations`. Its literals count from 1.
    Enumeration(u32),
}

/// When a variable may change, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variability {
    /// Never. Its value was used to build the model: a constant, or a parameter that determines the structure.
    Constant,
    /// Not during a run. It may be set before one.
    Parameter,
    /// At events only.
    Discrete,
    /// At any time.
    Continuous,
}

/// The attribute `stateSelect` of Modelica, from the least to the most preferred as a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
#[allow(missing_docs, reason = "the Modelica literals")]
pub enum StateSelect {
    Never,
    Avoid,
    #[default]
    Default,
    Prefer,
    Always,
}

/// A piece of a message with values in it.
#[derive(Clone, Debug, PartialEq)]
pub enum MessagePart {
    /// A fixed text.
    Text(String),
    /// A value, and the type by which it is printed.
    Value(ExprId, ScalarType),
}
