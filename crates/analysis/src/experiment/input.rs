//! Parses which column of a recording drives which input: `F=tau_N[N]:linear`.
//!
//! Entries of `--map` and of the section `[map]` enter; [`InputMap`]s leave.

/// Interpolation of an input between the samples of its recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputHold {
    /// Each sample holds until the next one; every change is an event.
    Held,
    /// Linear interpolation.
    Linear,
}

impl InputHold {
    /// Parses `held` (or `hold`) and `linear`; `None` for other words.
    pub fn parse(text: &str) -> Option<InputHold> {
        match text.trim() {
            "held" | "hold" => Some(InputHold::Held),
            "linear" => Some(InputHold::Linear),
            _ => None,
        }
    }
}

/// An input and the column that drives it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputMap {
    /// The model's input.
    pub input: String,
    /// The recording's column.
    pub column: String,
    /// The unit of the column; `None` for that of the input.
    pub unit: Option<String>,
    /// Interpolation; `None` where the entry does not state it.
    pub hold: Option<InputHold>,
}

impl InputMap {
    /// Reads `input=column`, `input=column[unit]`, with `:held` or `:linear` behind.
    ///
    /// Brackets that hold only digits are an index and belong to the column's name.
    ///
    /// # Errors
    /// A sentence saying what is expected.
    pub fn parse(text: &str) -> Result<InputMap, String> {
        let (input, source) = text
            .split_once('=')
            .filter(|(i, s)| !i.trim().is_empty() && !s.trim().is_empty())
            .ok_or_else(|| format!("`{text}`: `INPUT=COLUMN[UNIT]` is expected"))?;
        InputMap::of(input, source)
    }

    /// Parses what follows `input=`.
    ///
    /// # Errors
    /// A sentence that says what is expected.
    pub fn of(input: &str, source: &str) -> Result<InputMap, String> {
        let (source, hold) = match source.rsplit_once(':') {
            Some((rest, word)) => match InputHold::parse(word) {
                Some(hold) => (rest, Some(hold)),
                None => return Err(format!("`{word}`: `held` or `linear` is expected after the colon")),
            },
            None => (source, None),
        };
        let source = source.trim();
        let bracket = source.strip_suffix(']').and_then(|s| s.rsplit_once('['));
        // `v[3]` is a column with an index, `tau[N]` a column with a unit.
        let is_index = |s: &str| s.chars().all(|c| c.is_ascii_digit() || c == ',' || c == ' ');
        let (column, unit) = match bracket {
            Some((column, unit)) if !is_index(unit) && !column.is_empty() => (column, Some(unit.trim().to_owned())),
            _ => (source, None),
        };
        if let Some(unit) = &unit {
            bramah_expr::units::MeasurementUnit::parse(unit).map_err(|e| e.to_string())?;
        }
        Ok(InputMap { input: input.trim().to_owned(), column: column.trim().to_owned(), unit, hold })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str) -> String {
        match InputMap::parse(text) {
            Ok(m) => format!("{} <- {} {:?} {:?}", m.input, m.column, m.unit, m.hold),
            Err(e) => e,
        }
    }

    #[test]
    fn entries() {
        let all = ["F=tau_N[N]", "u=u", "p = v[3] : linear", "p=v[3][bar]:held", "u", "u=u:cubic", "u=x[foo]", "=x"];
        insta::assert_snapshot!(all.map(shown).join("\n"), @r#"
        F <- tau_N Some("N") None
        u <- u None None
        p <- v[3] None Some(Linear)
        p <- v[3] Some("bar") Some(Held)
        `u`: `INPUT=COLUMN[UNIT]` is expected
        `cubic`: `held` or `linear` is expected after the colon
        `foo` in the unit `foo` is not known
        `=x`: `INPUT=COLUMN[UNIT]` is expected
        "#);
    }
}
