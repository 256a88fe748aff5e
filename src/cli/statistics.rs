//! The file of `--statistics`: counts and times of a run, as one JSON object.
//!
//! `simulate` fills the record step by step and writes it even when the run failed. A value that is not known is null.

use serde::Serialize;

/// What is known about a run. Times are in seconds.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct StatisticsRecord {
    /// Time from reading the files to machine code.
    pub compile_s: Option<f64>,
    /// Time for finding the initial values.
    pub initialize_s: Option<f64>,
    /// Time from the first step to the last. Interpolation of rows is included, writing is not.
    pub solve_s: Option<f64>,
    /// Steps that the integrator accepted.
    pub steps: Option<u64>,
    /// Evaluations of the residual of the equations.
    pub residual_evaluations: Option<u64>,
    /// Evaluations of the Jacobian.
    pub jacobian_evaluations: Option<u64>,
    /// Factorisations of the iteration matrix.
    pub factorizations: Option<u64>,
    /// Steps repeated because their error was too large.
    pub error_test_failures: Option<u64>,
    /// Events that the run handled.
    pub events: Option<u64>,
    /// Unknowns of the system that IDA integrates.
    pub unknowns: Option<usize>,
    /// Unknowns whose derivatives appear in the system.
    pub states: Option<usize>,
    /// The largest resident memory of the process in bytes. Null where the system does not report it.
    pub peak_memory_bytes: Option<u64>,
    /// How the run ended, as one word. Null when it did not begin.
    pub end: Option<&'static str>,
}

impl StatisticsRecord {
    /// The record as indented JSON.
    pub fn to_json(&self) -> String {
        let text = serde_json::to_string_pretty(self).expect("numbers and words always serialize");
        format!("{text}\n")
    }
}

/// The largest resident memory of this process in bytes. `None` on systems other than Linux.
pub(super) fn peak_memory() -> Option<u64> {
    // The kernel keeps this maximum itself, so the end of the run is early enough to ask for it.
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_keys_are_there() {
        let value: serde_json::Value = serde_json::from_str(&StatisticsRecord::default().to_json()).unwrap();
        let keys: Vec<&String> = value.as_object().unwrap().keys().collect();
        assert_eq!(keys.len(), 13);
        assert_eq!((keys[0].as_str(), keys[12].as_str()), ("compile_s", "end"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_is_measured() {
        assert!(peak_memory().unwrap() > 100_000);
    }
}
