//! Checkpoints: points of a run from which it continues as if it had never stopped.
//!
//! IDA's past cannot be stored exactly. A run that makes checkpoints therefore restarts IDA at each of them, using only
//! what the checkpoint holds. A run that is resumed there does the same, so the results agree to the last bit. The text
//! form stores numbers by their bits. See docs/long_runs.md.

use super::past::DelayHistory;
use super::settings::Statistics;
use super::state::State;
use bramah_expr::VarId;
use bramah_model::structure::StateChoice;
use std::fmt::Write as _;

/// Everything that a run needs to continue from a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// Values of all variables, the time, and the history of delays.
    pub state: State,
    /// Number of the checkpoint in the run, counted from 1.
    pub number: u64,
    /// Work and events so far. Seconds are not stored.
    pub statistics: Statistics,
    /// Number of rows of the grid that are written.
    pub(super) rows: u64,
    /// The states chosen during the run; `None` for the original choice.
    pub(super) choice: Option<StateChoice>,
    /// Whether no other states can be chosen any more.
    pub(super) settled: bool,
}

/// A number as its bits in hexadecimal, which keeps every digit.
fn bits(value: f64) -> String {
    format!("{:016x}", value.to_bits())
}

/// The number with these bits; `None` where the word is not hexadecimal.
fn from_bits(word: &str) -> Option<f64> {
    u64::from_str_radix(word, 16).ok().map(f64::from_bits)
}

impl Checkpoint {
    /// The checkpoint as text, for [`Checkpoint::from_text`].
    pub fn text(&self) -> String {
        let mut out = String::new();
        let (state, s) = (&self.state, &self.statistics);
        let states = self.choice.iter().flat_map(|c| &c.preferred).map(|v| format!(" {}", v.0)).collect::<String>();
        let counts = counts(s).map(|n| format!(" {n}")).concat();
        // writing to a string cannot fail
        let _ = writeln!(out, "time {} {}", bits(state.time), state.time);
        let _ = writeln!(out, "number {}\nrows {}", self.number, self.rows);
        let _ = writeln!(out, "chosen {} {}{states}", self.choice.is_some(), self.settled);
        let _ = writeln!(out, "work{counts}\nvalues {}", state.names.len());
        for ((name, value), derivative) in state.names.iter().zip(&state.values).zip(&state.derivatives) {
            let _ = writeln!(out, "{} {} {name}", bits(*value), bits(*derivative));
        }
        let past: String = state.past.numbers().into_iter().map(|n| format!(" {}", bits(n))).collect();
        let _ = writeln!(out, "past{past}\nend");
        out
    }

    /// Reads the text of [`Checkpoint::text`].
    ///
    /// # Errors
    /// The number of the line that cannot be read, counted from 1.
    pub fn from_text(text: &str) -> Result<Self, usize> {
        let mut lines = CheckpointLines { lines: text.lines(), at: 0 };
        let time = lines.field("time")?;
        let time = lines.need(time.split(' ').next().and_then(from_bits))?;
        let number = lines.whole("number")?;
        let rows = lines.whole("rows")?;
        let chosen = lines.field("chosen")?;
        let mut chosen = chosen.split(' ');
        let mut flag = || chosen.next().and_then(|word| word.parse::<bool>().ok());
        let (is_chosen, settled) = (lines.need(flag())?, lines.need(flag())?);
        let preferred: Option<Vec<VarId>> = chosen.map(|word| word.parse().ok().map(VarId)).collect();
        let choice = is_chosen.then_some(StateChoice { preferred: lines.need(preferred)? });
        let work = lines.field("work")?;
        let work: Option<Vec<u64>> = work.split(' ').map(|word| word.parse().ok()).collect();
        let work = lines.need(work.and_then(|w| <[u64; 8]>::try_from(w).ok()))?;
        let count = lines.whole("values")?;
        let (names, values, derivatives) = (Vec::new(), Vec::new(), Vec::new());
        let mut state = State { time, names, values, derivatives, past: DelayHistory::default() };
        for _ in 0..count {
            lines.value(&mut state)?;
        }
        let past = lines.field("past")?;
        let past: Option<Vec<f64>> = past.split_whitespace().map(from_bits).collect();
        state.past = lines.need(past.and_then(|numbers| DelayHistory::from_numbers(&numbers)))?;
        lines.field("end")?;
        Ok(Checkpoint { state, number, statistics: statistics(work), rows, choice, settled })
    }
}

/// The counts of the statistics in the order of the file.
fn counts(s: &Statistics) -> [u64; 8] {
    [
        s.steps,
        s.residual_evaluations,
        s.jacobian_evaluations,
        s.factorizations,
        s.error_test_failures,
        s.crossing_evaluations,
        s.events,
        s.restarts,
    ]
}

/// The statistics with these counts.
fn statistics(counts: [u64; 8]) -> Statistics {
    let [steps, residual_evaluations, jacobian_evaluations, factorizations, ..] = counts;
    let [.., error_test_failures, crossing_evaluations, events, restarts] = counts;
    Statistics {
        steps,
        residual_evaluations,
        jacobian_evaluations,
        factorizations,
        error_test_failures,
        crossing_evaluations,
        events,
        restarts,
        ..Statistics::default()
    }
}

/// The lines of a checkpoint, with the number of the present one.
struct CheckpointLines<'a> {
    /// Lines not read yet.
    lines: std::str::Lines<'a>,
    /// Number of the line read last, counted from 1.
    at: usize,
}

impl<'a> CheckpointLines<'a> {
    /// The next line; `Err` with its number at the end of the text.
    fn next(&mut self) -> Result<&'a str, usize> {
        self.at += 1;
        self.lines.next().ok_or(self.at)
    }

    /// The rest of the next line after its first word, which must be `name`.
    fn field(&mut self, name: &str) -> Result<&'a str, usize> {
        let line = self.next()?;
        let rest = line.strip_prefix(name).map(|rest| rest.strip_prefix(' ').unwrap_or(rest));
        self.need(rest)
    }

    /// An integer after the word `name`.
    fn whole(&mut self, name: &str) -> Result<u64, usize> {
        let word = self.field(name)?;
        self.need(word.parse().ok())
    }

    /// Reads value, derivative and name of a variable.
    fn value(&mut self, state: &mut State) -> Result<(), usize> {
        let line = self.next()?;
        // the name comes last, because it may contain spaces
        let mut words = line.splitn(3, ' ');
        let value = self.need(words.next().and_then(from_bits))?;
        let derivative = self.need(words.next().and_then(from_bits))?;
        state.names.push(self.need(words.next())?.to_owned());
        state.values.push(value);
        state.derivatives.push(derivative);
        Ok(())
    }

    /// Turns a missing value into the number of the present line.
    fn need<T>(&self, found: Option<T>) -> Result<T, usize> {
        found.ok_or(self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checkpoint() -> Checkpoint {
        Checkpoint {
            state: State {
                time: 0.1,
                names: vec!["x".into(), "'a b'".into()],
                values: vec![1.0 / 3.0, -0.0],
                derivatives: vec![f64::MIN_POSITIVE, f64::INFINITY],
                past: DelayHistory::default(),
            },
            number: 3,
            statistics: statistics([1, 2, 3, 4, 5, 6, 7, 8]),
            rows: 17,
            choice: Some(StateChoice { preferred: vec![VarId(4), VarId(0)] }),
            settled: true,
        }
    }

    #[test]
    fn nothing_is_lost() {
        let whole = checkpoint();
        assert_eq!(Checkpoint::from_text(&whole.text()), Ok(whole));
        let plain = Checkpoint { choice: None, settled: false, ..checkpoint() };
        assert_eq!(Checkpoint::from_text(&plain.text()), Ok(plain));
    }

    #[test]
    fn damage_is_found() {
        let text = checkpoint().text();
        assert_eq!(Checkpoint::from_text(""), Err(1));
        assert_eq!(Checkpoint::from_text(&text.replace("number 3", "number three")), Err(2));
        assert_eq!(Checkpoint::from_text(text.trim_end_matches("end\n")), Err(10));
    }
}
