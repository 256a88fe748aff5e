//! Checks the unit of a column against the unit that the reader states, for example a study.

use super::recording::unit_place;
use bramah_expr::units::MeasurementUnit;
use bramah_syntax::diag::{Code, Diagnostic, FileId, Sources};

/// An error if the file gives a column another unit than `said`, the one that the reader states.
/// It points to the place in the file; the caller adds the place of its own statement.
///
/// Two notations of one unit agree. `None` also if one of them cannot be read as a unit.
pub fn contradiction(sources: &Sources, file: FileId, column: &str, said: &str) -> Option<Diagnostic> {
    let (own, place) = unit_place(sources, file, column)?;
    let (a, b) = (MeasurementUnit::parse(&own).ok()?, MeasurementUnit::parse(said).ok()?);
    if agree(&a, &b) {
        return None;
    }
    let message = format!("the unit of the column `{column}` is `{own}` in its file, but `{said}` is said of it");
    Some(Diagnostic::new(Code::UnitsDiffer, message).at(place, "the file's own unit"))
}

/// True if both units give a value the same meaning.
fn agree(own: &MeasurementUnit, said: &MeasurementUnit) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
    if *own == MeasurementUnit::ONE && !said.dimension.is_none() {
        // Data loggers write `1` if they know no unit.
        return true;
    }
    let same = near(own.factor(), said.factor()) && own.offset == said.offset;
    // `1/min` for a speed counts revolutions.
    let turns = own.angle == 0 && said.angle != 0 && near(said.factor(), std::f64::consts::TAU * own.factor());
    own.dimension == said.dimension && (same || turns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_agree_and_units_do_not() {
        let said = |own: &str, said: &str| {
            let mut sources = Sources::default();
            let file = sources.add("a.csv", format!("t;x\ns;{own}\n0;1\n"));
            contradiction(&sources, file, "x", said).is_some()
        };
        let same =
            [("1/min", "rev/min"), ("1/min", "1/min"), ("N/m2", "Pa"), ("Nm", "N.m"), ("lpm", "l/min"), ("1", "bar")];
        for (own, reader) in same.into_iter().chain([("U/min", "rev/min"), ("-", "bar"), ("rpm", "r/min")]) {
            assert!(!said(own, reader), "{own} {reader}");
        }
        for (own, reader) in
            [("psi", "bar"), ("mA", "bar"), ("degC", "K"), ("1/s", "rev/min"), ("%", "1"), ("deg", "rad")]
        {
            assert!(said(own, reader), "{own} {reader}");
        }
    }
}
