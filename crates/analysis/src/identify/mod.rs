//! Parameter identification: estimates parameters of a model from the recordings of a study.
//!
//! A compiled model, a bound study and its recordings enter; a [`ParameterFit`] with standard deviations, correlations
//! and residual tests leaves. The command `bramah identify` calls [`Identification`] directly, libraries call
//! [`identify`]. The steps are:
//! 1. [`IdentificationProblem::new`] collects the unknowns, their scales, bounds and priors.
//! 2. [`Identification::new`] chooses the method and checks which parameters the data can determine (`separate`).
//! 3. [`Identification::fit`] minimises weighted least squares (`least_squares`) of output errors (`output_error`) or
//!    of force errors of the inverse model (`inverse`), and estimates the uncertainty (`fit`).
//! 4. [`Identification::judge_held`] scores the fitted model on recordings that the fit did not use.
//!
//! The search works on scaled unknowns z: parameters first, then initial states; z = 0 is the model as it is written.
//! The user's page is `docs/identify.md`.

mod chance;
mod doubts;
mod exact;
mod filter;
mod fit;
mod free;
mod inverse;
mod least_squares;
mod output_error;
mod picture;
mod pieces;
mod profile;
mod report;
mod residuals;
pub mod runs;
mod separate;
mod starts;
mod study;
mod weights;

pub use doubts::doubts;
pub use fit::{ParameterFit, SignalFit, SignalTrajectory};
pub use free::EstimatedParameter;
pub use least_squares::{LeastSquares, LeastSquaresSolution, StoppingCriteria, VariableBounds, minimise};
pub use picture::picture;
pub use pieces::ContinuityDefects;
pub use profile::ProfileLikelihood;
pub use report::{IdentificationReport, fit_words, profile_words, separation_words};
pub use residuals::{InputCrossCorrelation, ResidualTest};
pub use runs::RunFailure;
pub use separate::{IdentifiabilityAnalysis, UnidentifiableDirection};
pub use starts::MultistartSummary;
pub use study::{Identified, IdentifyOptions, identify, identify_as};

use crate::noise;
use crate::study::{BoundStudy, Recording, full_scales};
use bramah_circuit::compiled::CompiledModel;
use bramah_syntax::diag::{Code, Diagnostic};
use doubts::foreign;
use exact::ForwardSensitivityModel;
use fit::signal_fits;
use inverse::{InverseModel, ModelInversion};
use nalgebra::{DMatrix, DVector};
use output_error::OutputError;
use separate::{separate, without_rest};
use starts::search_several;
use std::sync::{Arc, OnceLock};
use weights::ResidualWeights;

/// The residual that the search minimises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IdentifyMethod {
    /// [`IdentifyMethod::Inverse`] where the model can be inverted with this study, else [`IdentifyMethod::Output`].
    Auto,
    /// Output error: runs from the inputs alone, compared with the measured signals.
    Output,
    /// Inverse model: the force that the measured motion needs, compared with the measured force.
    Inverse,
}

/// A model, its study and the parameters to estimate.
#[derive(Clone, Debug)]
pub struct IdentificationProblem<'a> {
    /// The compiled model.
    pub model: &'a CompiledModel,
    /// The study, with its names bound to variables of the model.
    pub bound: &'a BoundStudy,
    /// The parameters to estimate, in the order of the study, without exact ones.
    pub free: Vec<EstimatedParameter>,
    /// The range of each signal's sensor, in the unit of the signal's variable.
    pub full_scale: Vec<f64>,
    /// One standard deviation of each signal's noise, in the unit of its variable: the `accuracy` of the study, else
    /// estimated from sixth differences of the train recordings.
    pub noise: Vec<f64>,
}

/// A least-squares problem whose rows carry weights and whose recordings may be cut into pieces.
///
/// [`OutputError`] and [`InverseModel`] implement it. The rows of the residual are ordered: data, priors of the
/// parameters, then one row for each initial state or joint of pieces (output error only).
trait WeightedResiduals: LeastSquares {
    /// The weights of the rows that come from data.
    fn weights(&mut self) -> &mut ResidualWeights;
    /// The length of z: parameters plus free states.
    fn unknowns(&self) -> usize;
    /// Gives the joints between pieces of recordings their smallest weight, before a search begins.
    fn loosen(&mut self) {}
    /// Gives the joints a larger weight. Returns false when they already have the largest one, or when no recording is
    /// cut.
    fn tighten(&mut self) -> bool {
        false
    }
}

impl<'a> IdentificationProblem<'a> {
    /// Collects the parameters to estimate, with start values, bounds and scales from the model and the study.
    ///
    /// # Errors
    /// [`Code::BadStudy`] when the study lists no parameter to estimate, when bounds exclude a start value, or when
    /// there are fewer samples than parameters.
    pub fn new(
        model: &'a CompiledModel,
        bound: &'a BoundStudy,
        train: &[Recording],
    ) -> Result<IdentificationProblem<'a>, Vec<Diagnostic>> {
        let system = &model.system;
        let mut values = system.layout.values();
        system.evaluate_parameters(&mut values, &[]);
        let free: Vec<EstimatedParameter> = bound
            .parameters
            .iter()
            .filter_map(|p| {
                let v = p.variable;
                let start = values[system.layout.var(v)];
                let min = system.min(v, &values).unwrap_or(f64::NEG_INFINITY);
                let max = system.max(v, &values).unwrap_or(f64::INFINITY);
                EstimatedParameter::new(p, start, min, max, system.nominal(v, &values))
            })
            .collect();
        let mistakes = mistakes(bound, &free, train);
        if !mistakes.is_empty() {
            return Err(mistakes);
        }
        let full_scale = full_scales(bound, train);
        let noise = (0..bound.signals.len()).map(|k| noise(bound, train, k, full_scale[k])).collect();
        Ok(IdentificationProblem { model, bound, free, full_scale, noise })
    }

    /// One residual z/sigma for each parameter with a prior. The prior's mean is z = 0, the value in the model.
    fn priors(&self, z: &[f64]) -> Vec<f64> {
        self.free.iter().zip(z).filter(|(f, _)| f.prior.is_finite()).map(|(f, z)| z / f.prior).collect()
    }

    /// Writes the derivatives of [`IdentificationProblem::priors`] into their rows of `jacobian`.
    ///
    /// These rows stand after the data and before the last rows, of which there is one for each unknown that is no
    /// parameter.
    fn prior_rows(&self, jacobian: &mut DMatrix<f64>) {
        let known = self.free.iter().filter(|f| f.prior.is_finite()).count();
        let states = jacobian.ncols() - self.free.len();
        let first = jacobian.nrows() - states - known;
        let with_prior = self.free.iter().enumerate().filter(|(_, f)| f.prior.is_finite());
        for (row, (j, free)) in with_prior.enumerate() {
            jacobian[(first + row, j)] = 1.0 / free.prior;
        }
    }

    /// First standard deviations of the signals, in their units, until errors of a run replace them.
    fn first_deviations(&self) -> Vec<f64> {
        // A signal without visible noise would get an infinite weight; a millionth of its range limits the weight.
        self.full_scale.iter().zip(&self.noise).map(|(f, n)| n.max(1e-6 * f).max(f64::MIN_POSITIVE)).collect()
    }

    /// Bounds of all unknowns in z. Free states have none.
    fn bounds(&self, unknowns: usize) -> VariableBounds {
        let mut bounds = VariableBounds { low: vec![f64::NEG_INFINITY; unknowns], high: vec![f64::INFINITY; unknowns] };
        for (j, free) in self.free.iter().enumerate() {
            // exp(20) is 5e8: a factor beyond it has no physical meaning.
            let far = if free.logarithmic { 20.0 } else { f64::INFINITY };
            bounds.low[j] = free.place(free.min).max(-far);
            bounds.high[j] = free.place(free.max).min(far);
        }
        bounds
    }
}

/// Messages about a problem that cannot be solved: no parameters, a start outside the bounds, too few samples.
fn mistakes(bound: &BoundStudy, free: &[EstimatedParameter], train: &[Recording]) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    if free.is_empty() {
        let d = Diagnostic::new(Code::BadStudy, "the study has no parameters to find");
        found.push(d.help("list them below `[parameters]`, with `sigma`, or with `min` and `max`"));
    }
    for f in free.iter().filter(|f| f.start < f.min || f.start > f.max) {
        let number = bramah_results::number::text;
        let text = format!("the bounds of `{}` exclude its value in the model, {}", f.name, number(f.start));
        let span = bound.parameters.iter().find(|p| p.variable == f.variable).map(|p| p.span);
        let d = Diagnostic::new(Code::BadStudy, text);
        let d = match span {
            Some(span) => d.at(span, format!("{} to {}", number(f.min), number(f.max))),
            None => d,
        };
        found.push(d.help("change the value in the model, or the bounds"));
    }
    // Empty cells are NaN and no samples.
    let samples: usize = train.iter().flat_map(|r| &r.signals).flatten().filter(|v| !v.is_nan()).count();
    if samples < free.len() {
        let text = format!("{} parameters are to be found from {samples} samples", free.len());
        found.push(Diagnostic::new(Code::BadStudy, text));
    }
    found
}

/// The noise of signal `k`: its `accuracy` from the study, else the largest estimate over the train recordings.
fn noise(bound: &BoundStudy, train: &[Recording], k: usize, full_scale: f64) -> f64 {
    bound.signals[k]
        .deviation(full_scale)
        .unwrap_or_else(|| train.iter().map(|r| noise::white(&[&r.signals[k]])).fold(0.0, f64::max))
}

/// An identification with its method chosen and its parameters checked for identifiability; ready to fit.
pub struct Identification<'a> {
    /// The model, the study and the parameters.
    problem: &'a IdentificationProblem<'a>,
    /// The recordings to fit to.
    train: &'a [Recording],
    /// How to invert the model; `None` where the output error is used.
    inverse: Option<ModelInversion>,
    /// The model that integrates its own sensitivities, or the reason why there is none. Built at the first use.
    exact: OnceLock<Result<Arc<ForwardSensitivityModel>, String>>,
    /// Which parameters the data can determine, computed at the start values.
    pub separation: IdentifiabilityAnalysis,
    /// For each entry of `separation.blind`, up to three variables whose measurement would separate its parameters,
    /// best first.
    pub advice: Vec<Vec<String>>,
    /// Warnings about columns that seem to have another sign or unit than the study states.
    pub suspicions: Vec<Diagnostic>,
}

impl<'a> Identification<'a> {
    /// Chooses the method and checks which parameters the data can determine.
    ///
    /// # Errors
    /// [`Code::BadStudy`] when `method` does not apply; [`Code::StepTooSmall`] and others when the model cannot follow
    /// the recordings with the start values.
    pub fn new(
        problem: &'a IdentificationProblem<'a>,
        train: &'a [Recording],
        method: IdentifyMethod,
    ) -> Result<Self, Diagnostic> {
        // `ModelInversion::new` returns `None` for models that cannot be inverted, which decides `Auto` too.
        let inverse = if method == IdentifyMethod::Output { None } else { ModelInversion::new(problem) };
        if inverse.is_none() && method == IdentifyMethod::Inverse {
            let d = Diagnostic::new(Code::BadStudy, "the model cannot be inverted with this study");
            return Err(d
                .note("the inputs must be measured forces or torques (N, N.m), one for each degree of freedom")
                .note("each state must be a signal, or the derivative of one"));
        }
        let mut found = Identification {
            problem,
            train,
            inverse,
            exact: OnceLock::new(),
            separation: IdentifiabilityAnalysis { rank: 0, condition: 1.0, blind: Vec::new(), deviation: Vec::new() },
            advice: Vec::new(),
            suspicions: Vec::new(),
        };
        found.judge()?;
        Ok(found)
    }

    /// The method in use, never [`IdentifyMethod::Auto`].
    pub fn method(&self) -> IdentifyMethod {
        if self.inverse.is_some() { IdentifyMethod::Inverse } else { IdentifyMethod::Output }
    }

    /// Computes `separation`, `advice` and `suspicions` from residual and sensitivities at the start values.
    fn judge(&mut self) -> Result<(), Diagnostic> {
        let z = vec![0.0; self.problem.free.len()];
        let mut suspicions = Vec::new();
        let information = match self.inverse_model()? {
            Some(mut model) => information(&mut model, z.len()),
            None => {
                let mut model = self.output_error()?;
                // z = 0 is the model as written, so this run shows columns of a foreign sign or unit before any fit.
                if let Some(residual) = model.residual(&vec![0.0; model.unknowns()]) {
                    suspicions = foreign(self.problem, &model.trajectories(self.train, residual.as_slice()));
                }
                information(&mut model, z.len())
            }
        };
        // The run failed with the values of the model itself, so a search has no place to start.
        let information = information.map_err(|broken| cannot_follow(broken.as_ref()))?;
        self.suspicions = suspicions;
        self.separation = separate(&information);
        self.advice = self.separation.blind.iter().map(|b| self.what_separates(b)).collect();
        Ok(())
    }

    /// The residual of the inverse model; `None` where the output error is used.
    ///
    /// # Errors
    /// [`Code::BadStudy`] when a recording is too short to filter.
    fn inverse_model(&self) -> Result<Option<InverseModel<'_>>, Diagnostic> {
        let Some(inverse) = &self.inverse else { return Ok(None) };
        let model = InverseModel::new(self.problem, inverse, self.train);
        model.map(Some).ok_or_else(|| Diagnostic::new(Code::BadStudy, "a recording is too short for the inverse model"))
    }

    /// The output-error residual over the train recordings.
    ///
    /// # Errors
    /// When the model cannot start with the values that it has.
    fn output_error(&self) -> Result<OutputError<'_>, Diagnostic> {
        let mut model = OutputError::new(self.problem, self.train, None).map_err(|b| cannot_follow(Some(&b)))?;
        let exact = self.exact.get_or_init(|| ForwardSensitivityModel::new(self.problem).map(Arc::new));
        model.differentiate_by(exact.clone());
        Ok(model)
    }

    /// Up to three unmeasured variables that would separate the parameters of a blind direction, best first.
    ///
    /// The model runs along the first recording with its own values, then with the parameters moved along the
    /// direction. The variables that change most, relative to their ranges, come first. Empty when a run fails or
    /// nothing changes.
    fn what_separates(&self, blind: &UnidentifiableDirection) -> Vec<String> {
        let Ok(runs) = OutputError::new(self.problem, &self.train[..1], None) else { return Vec::new() };
        let flat = &self.problem.model.flat;
        let shown = (0..).map(bramah_expr::VarId).zip(&flat.variables).filter(|(_, v)| {
            !v.hidden
                && v.ty == bramah_model::flat::ScalarType::Real
                && v.variability == bramah_model::flat::Variability::Continuous
        });
        let measured = |v: &bramah_expr::VarId| self.problem.bound.signals.iter().any(|s| s.variable == *v);
        let shown = shown.filter(|(v, _)| !measured(v));
        let (wanted, names): (Vec<_>, Vec<_>) = shown.map(|(v, variable)| (v, &variable.name)).unzip();
        let mut z = vec![0.0; runs.unknowns()];
        // A small step: large enough to stand out of the error of the runs, small enough for parameters of any kind.
        let Ok(base) = runs.simulate(0, &z, &wanted) else { return Vec::new() };
        // 0.05 in z is about 5 % of a parameter's usual value.
        z.iter_mut().zip(&blind.direction).for_each(|(z, d)| *z = 0.05 * d);
        let Ok(moved) = runs.simulate(0, &z, &wanted) else { return Vec::new() };
        let mut effects: Vec<(f64, &String)> =
            base.iter().zip(&moved).zip(names).map(|((a, b), n)| (effect(a, b), n)).collect();
        // Changes below 0.2 % of a variable's range count as none.
        effects.retain(|(e, _)| *e > 2e-3);
        effects.sort_by(|a, b| b.0.total_cmp(&a.0));
        effects.into_iter().take(3).map(|(_, n)| n.clone()).collect()
    }

    /// Estimates the parameters, starting from their values in the model.
    ///
    /// # Errors
    /// As [`Identification::new`].
    pub fn fit(&self) -> Result<ParameterFit, Diagnostic> {
        self.fit_from(1, 1)
    }

    /// Estimates the parameters from `starts` places: the values in the model, and `starts - 1` random places within
    /// bounds and tolerances, at most a factor of e away.
    ///
    /// The end with the smallest sum of squares counts; [`ParameterFit::starts`] counts the ends of all searches. The
    /// same `seed` draws the same places.
    ///
    /// # Errors
    /// As [`Identification::new`].
    pub fn fit_from(&self, starts: usize, seed: u64) -> Result<ParameterFit, Diagnostic> {
        match self.inverse_model()? {
            Some(mut model) => {
                let found = search_several(self.problem, &mut model, &[], starts, seed);
                let (minimum, starts) = found.ok_or_else(|| cannot_follow(None))?;
                let train = self.force_fits(&mut model, &minimum);
                let trajectories = model.trajectories(minimum.residual.as_slice());
                let mut fit = self.estimate(&mut model, &minimum, train, trajectories);
                fit.residuals = self.judge_residuals(&fit, minimum.residual.as_slice());
                fit.differences = Some("of the inverse model".to_owned());
                fit.starts = starts;
                Ok(fit)
            }
            None => {
                let mut model = self.output_error()?;
                // Standard deviations are not learned below a millionth of the range: a perfect fit would divide by
                // zero.
                let floor: Vec<f64> = self.problem.full_scale.iter().map(|f| 1e-6 * f).collect();
                let found = search_several(self.problem, &mut model, &floor, starts, seed);
                let (minimum, starts) = found.ok_or_else(|| cannot_follow(model.broken.as_ref()))?;
                let residual = minimum.residual.as_slice();
                let train = signal_fits(self.problem, model.weights(), residual, self.train);
                let trajectories = model.trajectories(self.train, residual);
                let mut fit = self.estimate(&mut model, &minimum, train, trajectories);
                fit.residuals = self.judge_residuals(&fit, residual);
                fit.differences = model.differences().map(str::to_owned);
                fit.starts = starts;
                fit.joints = model.joints(residual);
                // A minimum whose pieces do not join is no trajectory of the model.
                fit.converged &= fit.joints.as_ref().is_none_or(|j| j.jump <= pieces::APART);
                Ok(fit)
            }
        }
    }

    /// Scores the fitted model on recordings that the fit did not use; one entry for each signal (or input, for the
    /// inverse model).
    ///
    /// Initial states that no parameter decides are estimated from the first 5 % of each recording, at most 0.2 s.
    /// These samples are not scored.
    ///
    /// # Errors
    /// When the model cannot follow them, or when one is too short for the inverse model.
    pub fn judge_held(&self, fit: &ParameterFit, held: &[Recording]) -> Result<Vec<SignalFit>, Diagnostic> {
        let z: Vec<f64> = self.problem.free.iter().zip(&fit.values).map(|(f, &v)| f.place(v)).collect();
        if let Some(inverse) = &self.inverse {
            let model = InverseModel::new(self.problem, inverse, held);
            let mut model =
                model.ok_or_else(|| Diagnostic::new(Code::BadStudy, "a held recording is too short to judge by"))?;
            let residual = model.residual(&z).ok_or_else(|| cannot_follow(None))?;
            // `force_fits` reads only the residual; the rest of the solution is filled with neutral values.
            let minimum = LeastSquaresSolution {
                jacobian: DMatrix::zeros(residual.len(), z.len()),
                residual,
                converged: true,
                iterations: 0,
                at_bound: Vec::new(),
                z,
            };
            return Ok(self.force_fits(&mut model, &minimum));
        }
        // Parameters stand still here; only initial states are free.
        let whole = OutputError::new(self.problem, held, Some(&z)).map_err(|b| cannot_follow(Some(&b)))?;
        let mut scored = held.to_vec();
        let mut states = vec![0.0; whole.unknowns()];
        if whole.frees_states() {
            let mut first = whole.beginning(beginning);
            let unbounded =
                VariableBounds { low: vec![f64::NEG_INFINITY; states.len()], high: vec![f64::INFINITY; states.len()] };
            // When the search fails, the start values of the model (z = 0) stay.
            if let Some(found) = minimise(&mut first, &states, &unbounded, StoppingCriteria::default()) {
                states = found.z;
            }
            for recording in &mut scored {
                let end = recording.times[0] + beginning(&recording.times);
                let count = recording.times.partition_point(|&t| t <= end);
                // NaN marks a cell without a measurement, so these samples drop out of the score.
                recording.signals.iter_mut().for_each(|s| s[..count].fill(f64::NAN));
            }
        }
        // Built again, because the rows of the residual follow from the cells that are not NaN.
        let mut whole = OutputError::new(self.problem, &scored, Some(&z)).map_err(|b| cannot_follow(Some(&b)))?;
        let residual = whole.residual(&states).ok_or_else(|| cannot_follow(whole.broken.as_ref()))?;
        Ok(signal_fits(self.problem, whole.weights(), residual.as_slice(), &scored))
    }
}

/// How much of a recording estimates its initial state, in seconds from its first sample.
fn beginning(times: &[f64]) -> f64 {
    (0.05 * (times[times.len() - 1] - times[0])).min(0.2)
}

/// The Fisher information J'J of the parameters at z = 0, with initial states eliminated; p by p for p parameters.
///
/// Priors of parameters are left out: the result says what the data alone determine. `Err` holds the failure of the
/// run, where one is known.
fn information(model: &mut dyn WeightedResiduals, parameters: usize) -> Result<DMatrix<f64>, Option<RunFailure>> {
    let z = vec![0.0; model.unknowns()];
    let residual = model.residual(&z).ok_or(None)?;
    let jacobian = model.jacobian(&z, &residual).ok_or(None)?;
    // Rows of data end where the last series ends; prior rows follow.
    let data = model.weights().series.iter().map(|s| s.rows.end).max().unwrap_or(0);
    let seen = jacobian.rows(0, data);
    // an initial state is known to about its nominal value, one between pieces is the end of another piece
    let states = all_states(&jacobian, parameters);
    let all = seen.tr_mul(&seen) + states.tr_mul(&states);
    Ok(without_rest(&all, parameters))
}

/// The last rows of the Jacobian, one for each state among the unknowns: priors of initial states, and joints.
fn all_states(jacobian: &DMatrix<f64>, parameters: usize) -> nalgebra::DMatrixView<'_, f64> {
    let states = jacobian.ncols() - parameters;
    jacobian.rows(jacobian.nrows() - states, states)
}

/// Minimises from a place with the weights of the signals as they are; joints get stricter from round to round.
///
/// `None` when the model cannot run at `from`. The iterations of all rounds add up.
fn search_once(
    problem: &IdentificationProblem<'_>,
    model: &mut dyn WeightedResiduals,
    from: &[f64],
) -> Option<LeastSquaresSolution> {
    let bounds = problem.bounds(model.unknowns());
    let mut minimum = minimise(&mut BorrowedResiduals(model), from, &bounds, StoppingCriteria::default())?;
    while model.tighten() {
        let iterations = minimum.iterations;
        minimum = minimise(&mut BorrowedResiduals(model), &minimum.z, &bounds, StoppingCriteria::default())?;
        minimum.iterations += iterations;
    }
    Some(minimum)
}

/// Iteratively reweighted least squares: minimises, takes the signals' deviations from the errors, and repeats.
///
/// It ends when the deviations change by less than 2 %, or after five rounds. `floor` holds the smallest deviation of
/// each signal; an empty one stands for zeros. `None` when the model cannot run at `from`.
fn search(
    problem: &IdentificationProblem<'_>,
    model: &mut dyn WeightedResiduals,
    floor: &[f64],
    from: &[f64],
) -> Option<LeastSquaresSolution> {
    let floor = if floor.is_empty() { vec![0.0; model.weights().sigma.len()] } else { floor.to_vec() };
    let mut z = from.to_vec();
    model.loosen();
    // The first weights come from the errors at the start, which are mostly those of wrong parameters. A signal that
    // the model misses far at first thus does not dominate the first round.
    let start = BorrowedResiduals(model).residual(&z)?;
    model.weights().learn(start.as_slice(), &floor);
    let mut iterations = 0;
    for round in 0..5 {
        let mut minimum = search_once(problem, model, &z)?;
        iterations += minimum.iterations;
        minimum.iterations = iterations;
        z.clone_from(&minimum.z);
        let sigma = model.weights().sigma.clone();
        let change = model.weights().learn(minimum.residual.as_slice(), &floor);
        if change < 0.02 || round == 4 {
            // The residual of `minimum` is divided by the old deviations, and both must belong together.
            model.weights().sigma = sigma;
            return Some(minimum);
        }
    }
    None
}

/// Passes a borrowed model to [`minimise`], so that its weights can be changed between two searches.
struct BorrowedResiduals<'a>(&'a mut dyn WeightedResiduals);

impl LeastSquares for BorrowedResiduals<'_> {
    fn residual(&mut self, z: &[f64]) -> Option<DVector<f64>> {
        self.0.residual(z)
    }

    fn jacobian(&mut self, z: &[f64], residual: &DVector<f64>) -> Option<DMatrix<f64>> {
        self.0.jacobian(z, residual)
    }

    fn conditions(&self) -> usize {
        self.0.conditions()
    }
}

/// The largest change of a variable between two runs, relative to its range in the first; 0 for a variable that
/// stands still.
fn effect(base: &[f64], moved: &[f64]) -> f64 {
    let range =
        base.iter().copied().fold(f64::NEG_INFINITY, f64::max) - base.iter().copied().fold(f64::INFINITY, f64::min);
    let change = base.iter().zip(moved).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let size = base.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    // The range is floored at a thousandth of the size: the change of a nearly constant variable is no good signal.
    if size > 0.0 && range > 0.0 { change / range.max(1e-3 * size) } else { 0.0 }
}

/// The message for a model that fails at its start values, with the time and the text of the failed run.
fn cannot_follow(broken: Option<&RunFailure>) -> Diagnostic {
    let d = Diagnostic::new(Code::StepTooSmall, "the model cannot follow the recording with its start values");
    match broken {
        Some(b) if b.time.is_finite() => {
            d.note(format!("at {} s: {}", bramah_results::number::text(b.time), b.message))
        }
        Some(b) => d.note(b.message.clone()),
        None => d,
    }
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod pieces_tests;
