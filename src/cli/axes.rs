//! Options of the form `NAME=VALUES`, which give several values to a quantity: `u=0:8:17` or `p=10,20bar`.
//!
//! The text of an option enters; the name and the values in the quantity's unit leave. Used by `linearize --grid`,
//! `steady --over` and `partition --speed` and `--load`.

use super::CommandFailure;
use bramah_analysis::grid;
use bramah_syntax::diag::Code;

/// One entry of such an option. It borrows the text of the command line.
pub(super) struct AxisOption<'e> {
    /// The option's name with its dashes, for messages.
    option: &'static str,
    /// The entire entry, for messages.
    text: &'e str,
    /// The name of the quantity.
    pub name: &'e str,
    /// The values as written: a list or a range, with or without unit.
    values: &'e str,
}

impl<'e> AxisOption<'e> {
    /// Splits an entry of `option` at `=`. `Err`: there is no `=`.
    ///
    /// The values stay text: their unit is known only when the quantity has been found in the model.
    pub fn parse(option: &'static str, text: &'e str) -> Result<Self, CommandFailure> {
        let parts = text.split_once('=').map(|(name, values)| AxisOption { option, text, name: name.trim(), values });
        parts.ok_or_else(|| wrong(option, text, "NAME=VALUES is expected"))
    }

    /// The values converted to `unit`, the unit of the quantity in the model. `Err`: they are no numbers, or of another
    /// unit.
    pub fn values(&self, unit: &str) -> Result<Vec<f64>, CommandFailure> {
        grid::values(self.values, unit).map_err(|why| self.wrong(&why))
    }

    /// A failure that quotes the entry and says what is wrong.
    pub fn wrong(&self, why: &str) -> CommandFailure {
        wrong(self.option, self.text, why)
    }
}

/// The failure for an entry of `option`.
fn wrong(option: &str, text: &str, why: &str) -> CommandFailure {
    CommandFailure::new(Code::BadArgument, format!("`{option} {text}`: {why}"))
}
