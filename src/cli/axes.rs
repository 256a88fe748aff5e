//! `NAME=VALUES`: what an option says of a quantity that takes several values.

use super::CommandFailure;
use bramah_analysis::grid;
use bramah_syntax::diag::Code;

/// Such an entry of an option.
pub(super) struct AxisOption<'e> {
    option: &'static str,
    text: &'e str,
    /// The quantity.
    pub name: &'e str,
    values: &'e str,
}

impl<'e> AxisOption<'e> {
    /// Takes an entry of `option` apart.
    pub fn parse(option: &'static str, text: &'e str) -> Result<Self, CommandFailure> {
        let parts = text.split_once('=').map(|(name, values)| AxisOption { option, text, name: name.trim(), values });
        parts.ok_or_else(|| wrong(option, text, "NAME=VALUES is expected"))
    }

    /// The values in `unit`, that of the quantity.
    pub fn values(&self, unit: &str) -> Result<Vec<f64>, CommandFailure> {
        grid::values(self.values, unit).map_err(|why| self.wrong(&why))
    }

    /// What is wrong with it.
    pub fn wrong(&self, why: &str) -> CommandFailure {
        wrong(self.option, self.text, why)
    }
}

fn wrong(option: &str, text: &str, why: &str) -> CommandFailure {
    CommandFailure::new(Code::BadArgument, format!("`{option} {text}`: {why}"))
}
