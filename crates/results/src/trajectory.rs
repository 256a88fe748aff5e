//! Signals over time, from a run or from a test bench. All readers make this type, and all writers take it.

/// The type of a signal's values. All are stored as `f64`: Booleans as 0 and 1, enumeration literals counted from 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// A continuous number.
    #[default]
    Real,
    /// A whole number.
    Integer,
    /// 0 for `false`, 1 for `true`.
    Boolean,
    /// The literals in order; the first has the value 1.
    Enumeration(Vec<String>),
}

impl Kind {
    /// True for signals that are constant between events. They are drawn as steps and never interpolated.
    pub fn is_discrete(&self) -> bool {
        *self != Kind::Real
    }
}

/// The description of one column of a [`Trajectory`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signal {
    /// The full dotted name, such as `pump.b.p` or `v[3].p`.
    pub name: String,
    /// The unit of the stored values. Empty if it is not known.
    pub unit: String,
    /// The unit for printing and plots. Empty if it is `unit`.
    pub display_unit: String,
    /// The description string. Empty if there is none.
    pub description: String,
    /// The type of the values.
    pub kind: Kind,
}

impl Signal {
    /// A Real signal without a unit.
    pub fn new(name: impl Into<String>) -> Self {
        Signal { name: name.into(), ..Signal::default() }
    }

    /// The signal with this unit.
    #[must_use]
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = unit.into();
        self
    }
}

/// Signals over time. Times never decrease. Two or more rows of equal time are an event, with the values before and
/// after.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// The signals of the columns. Time is not among them.
    pub signals: Vec<Signal>,
    /// The times of the rows (s).
    pub times: Vec<f64>,
    /// One column for each signal, as long as `times`. An empty cell of a recording is NaN.
    pub columns: Vec<Vec<f64>>,
}

impl Trajectory {
    /// A trajectory of these signals without rows.
    pub fn new(signals: Vec<Signal>) -> Self {
        let columns = vec![Vec::new(); signals.len()];
        Trajectory { signals, times: Vec::new(), columns }
    }

    /// Appends a row. `values` has one value for each signal, in their order.
    pub fn push(&mut self, time: f64, values: &[f64]) {
        debug_assert_eq!(values.len(), self.columns.len(), "one value a signal");
        self.times.push(time);
        for (column, &value) in self.columns.iter_mut().zip(values) {
            column.push(value);
        }
    }

    /// Keeps only the rows whose time lies in the window, ends included.
    pub fn keep(&mut self, window: std::ops::RangeInclusive<f64>) {
        let from = self.times.partition_point(|t| t < window.start());
        let to = self.times.partition_point(|t| t <= window.end()).max(from);
        for column in self.columns.iter_mut().chain([&mut self.times]) {
            column.truncate(to);
            column.drain(..from);
        }
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// True if there is no row.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// The index of the signal with this name. `None` if there is none.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.signals.iter().position(|s| s.name == name)
    }

    /// The values of the signal with this name. `None` if there is none.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.index(name).map(|i| self.columns[i].as_slice())
    }

    /// The value of column `index` at a time. At an event it is the value after the event.
    /// Between rows Real signals are interpolated linearly, and others keep their value.
    /// `None` outside the recorded interval, or if there is no such column.
    pub fn value(&self, index: usize, time: f64) -> Option<f64> {
        // All rows of an event have equal times; the last one of them is taken.
        let after = self.times.partition_point(|&t| t <= time);
        let before = after.checked_sub(1)?;
        let column = self.columns.get(index)?;
        let (t0, v0) = (self.times[before], column[before]);
        if t0 == time {
            return Some(v0);
        }
        let (&t1, &v1) = (self.times.get(after)?, column.get(after)?);
        if self.signals[index].kind.is_discrete() {
            return Some(v0);
        }
        Some(v0 + (v1 - v0) * ((time - t0) / (t1 - t0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step() -> Trajectory {
        let mut t =
            Trajectory::new(vec![Signal::new("x").unit("m"), Signal { kind: Kind::Boolean, ..Signal::new("on") }]);
        t.push(0.0, &[0.0, 0.0]);
        t.push(1.0, &[2.0, 0.0]);
        t.push(1.0, &[5.0, 1.0]);
        t.push(2.0, &[7.0, 1.0]);
        t
    }

    #[test]
    fn values_between_rows_and_at_events() {
        let t = step();
        assert_eq!(t.value(0, 0.5), Some(1.0));
        assert_eq!(t.value(0, 1.0), Some(5.0));
        assert_eq!(t.value(0, 1.5), Some(6.0));
        assert_eq!(t.value(1, 0.999), Some(0.0));
        assert_eq!(t.value(1, 2.0), Some(1.0));
        assert_eq!(t.value(0, -0.1), None);
        assert_eq!(t.value(0, 2.1), None);
    }

    #[test]
    fn a_window() {
        let mut t = step();
        t.keep(1.0..=1.5);
        assert_eq!((t.times, t.columns[0].as_slice()), (vec![1.0, 1.0], [2.0, 5.0].as_slice()));
        let mut t = step();
        t.keep(3.0..=2.0);
        assert!(t.is_empty());
    }

    #[test]
    fn by_name() {
        let t = step();
        assert_eq!(t.column("on"), Some([0.0, 0.0, 1.0, 1.0].as_slice()));
        assert_eq!(t.index("y"), None);
    }
}
