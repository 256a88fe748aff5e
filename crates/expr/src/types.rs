//! What scalar variables are: their types, when they change, how gladly they are states; and pieces of texts with values in
//! them. Instances and the flat model speak of both.

use crate::ExprId;

/// The type of a scalar variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarType {
    /// Real
    Real,
    /// Integer
    Integer,
    /// Boolean
    Boolean,
    /// An enumeration: index into `FlatModel::enumerations`. Values count from 1.
    Enumeration(u32),
}

/// When a variable may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variability {
    /// Never; its value was used to build the model (constants, structural parameters).
    Constant,
    /// Not during a run; may be set before one.
    Parameter,
    /// At events only.
    Discrete,
    /// At any time.
    Continuous,
}

/// `stateSelect`
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

/// A piece of a text with values in it.
#[derive(Clone, Debug, PartialEq)]
pub enum MessagePart {
    /// Words.
    Text(String),
    /// A value and how it is printed.
    Value(ExprId, ScalarType),
}
