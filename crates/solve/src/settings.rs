//! Settings of a run, the statistics of its work, and how it ended.

use super::TangentRequest;
use super::modes::same_time;
use bramah_expr::VarId;
use bramah_model::flat::ExperimentAnnotation;

/// Default limit of event rows: some tens of megabytes with thirty variables.
pub const MOST_EVENT_ROWS: u64 = 100_000;

/// What a run shall do. Times are in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Start of the run.
    pub start_time: f64,
    /// End of the run.
    pub stop_time: f64,
    /// Distance of output rows. With 0 or less, only the first row, the last row and events are written.
    pub interval: f64,
    /// Relative tolerance. The absolute tolerance of a variable is this times its `nominal`.
    pub tolerance: f64,
    /// Longest step of the integrator; infinite for no limit.
    pub longest_step: f64,
    /// Parameters with new values, in the units of the variables. Their bindings are not used.
    pub parameters: Vec<(VarId, f64)>,
    /// The variables to record, in the order of the columns.
    pub wanted: Vec<VarId>,
    /// Whether each event has two rows of equal time, before and after it.
    pub event_rows: bool,
    /// Event rows at most, in equal parts for each interval of the grid. A model with many events cannot fill the disk.
    pub most_event_rows: u64,
    /// Number of events in a billionth of the run above which it counts as chattering.
    pub events_at_once: u32,
    /// Distance of checkpoints, at which the integrator restarts; infinite for none.
    pub checkpoint_every: f64,
    /// Sensitivities to compute. Not together with checkpoints or with states that change.
    pub tangents: Option<TangentRequest>,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            start_time: 0.0,
            stop_time: 1.0,
            interval: 0.002,
            tolerance: 1e-6,
            longest_step: f64::INFINITY,
            parameters: Vec::new(),
            wanted: Vec::new(),
            event_rows: true,
            most_event_rows: MOST_EVENT_ROWS,
            events_at_once: 200,
            checkpoint_every: f64::INFINITY,
            tangents: None,
        }
    }
}

impl Settings {
    /// The settings of a model's `experiment` annotation (MLS 18.4); 500 intervals when it gives none.
    pub fn from_experiment(experiment: &ExperimentAnnotation) -> Self {
        let standard = Settings::default();
        let start_time = experiment.start_time.unwrap_or(standard.start_time);
        let stop_time = experiment.stop_time.unwrap_or(start_time + 1.0);
        Settings {
            start_time,
            stop_time,
            interval: experiment.interval.unwrap_or((stop_time - start_time) / 500.0),
            tolerance: experiment.tolerance.unwrap_or(standard.tolerance),
            ..standard
        }
    }

    /// The time of the `number`-th checkpoint, counted from 1; the stop time when it would not come before that.
    pub(super) fn checkpoint(&self, number: u64) -> f64 {
        let due = self.start_time + number as f64 * self.checkpoint_every;
        let before_end = self.checkpoint_every > 0.0 && due < self.stop_time && !same_time(due, self.stop_time);
        if before_end { due } else { self.stop_time }
    }
}

/// The work of a run. Times are in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// From the text to the lowered system; filled by the caller.
    pub compile_s: f64,
    /// Time for initial values, including the event iteration at the start.
    pub initialize_s: f64,
    /// From the first step to the last one, with interpolation, without writing.
    pub solve_s: f64,
    /// Accepted steps of the integrator.
    pub steps: u64,
    /// Evaluations of the residual.
    pub residual_evaluations: u64,
    /// Evaluations of the Jacobian.
    pub jacobian_evaluations: u64,
    /// Factorizations of the iteration matrix.
    pub factorizations: u64,
    /// Steps that were repeated because their error was too large.
    pub error_test_failures: u64,
    /// Evaluations of the root functions.
    pub crossing_evaluations: u64,
    /// Events, including those of held inputs.
    pub events: u64,
    /// Restarts of the integrator.
    pub restarts: u64,
    /// Unknowns of the IDA system.
    pub unknowns: usize,
    /// States of the model among them.
    pub states: usize,
}

impl Statistics {
    /// Adds the work of an earlier part of the same run.
    pub fn add(&mut self, earlier: &Statistics) {
        self.compile_s += earlier.compile_s;
        self.initialize_s += earlier.initialize_s;
        self.solve_s += earlier.solve_s;
        self.steps += earlier.steps;
        self.residual_evaluations += earlier.residual_evaluations;
        self.jacobian_evaluations += earlier.jacobian_evaluations;
        self.factorizations += earlier.factorizations;
        self.error_test_failures += earlier.error_test_failures;
        self.crossing_evaluations += earlier.crossing_evaluations;
        self.events += earlier.events;
        self.restarts += earlier.restarts;
    }
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// At the stop time.
    Reached,
    /// By `terminate`, with its message, or because the caller asked.
    Terminated(String),
    /// Events followed each other without progress in time.
    Chattering,
    /// The step size collapsed, or no consistent values were found.
    StepTooSmall,
    /// An assertion failed.
    Assertion,
    /// A value was not finite.
    NonFinite,
    /// The caller or the sink stopped it, for example by Ctrl-C.
    Interrupted,
}

impl End {
    /// The word for statistics files.
    pub fn word(&self) -> &'static str {
        match self {
            End::Reached => "reached",
            End::Terminated(_) => "terminated",
            End::Chattering => "chattering",
            End::StepTooSmall => "step_too_small",
            End::Assertion => "assertion",
            End::NonFinite => "non_finite",
            End::Interrupted => "interrupted",
        }
    }

    /// Whether the run did what the model asked for.
    pub fn is_success(&self) -> bool {
        matches!(self, End::Reached | End::Terminated(_))
    }
}
