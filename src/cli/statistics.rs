//! The statistics file: what is known about a run, also when it failed.

use serde::Serialize;

/// One JSON object; what is not known is null. Times in seconds.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct StatisticsRecord {
    /// From process start to the lowered system.
    pub compile_s: Option<f64>,
    /// Finding the initial values.
    pub initialize_s: Option<f64>,
    /// From the first step to the last, interpolation included, writing excluded.
    pub solve_s: Option<f64>,
    /// Accepted steps.
    pub steps: Option<u64>,
    /// Evaluations of the equations.
    pub residual_evaluations: Option<u64>,
    /// Evaluations of the Jacobian.
    pub jacobian_evaluations: Option<u64>,
    /// Factorisations of the iteration matrix.
    pub factorizations: Option<u64>,
    /// Steps repeated because their error was too large.
    pub error_test_failures: Option<u64>,
    /// Events.
    pub events: Option<u64>,
    /// Unknowns of the system that IDA sees.
    pub unknowns: Option<usize>,
    /// Differential ones among them.
    pub states: Option<usize>,
    /// The most memory the process has held.
    pub peak_memory_bytes: Option<u64>,
    /// How the run ended; null when it did not begin.
    pub end: Option<&'static str>,
}

impl StatisticsRecord {
    /// As text.
    pub fn to_json(&self) -> String {
        let text = serde_json::to_string_pretty(self).expect("numbers and words always serialize");
        format!("{text}\n")
    }
}

/// The most memory this process has held, as Linux tells it.
pub(super) fn peak_memory() -> Option<u64> {
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
