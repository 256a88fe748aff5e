//! Parameters from recordings: what can be found at all, the fit, its uncertainty, and how it does on held recordings.

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

/// How parameters are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IdentifyMethod {
    /// [`IdentifyMethod::Inverse`] where it applies, else [`IdentifyMethod::Output`].
    Auto,
    /// Runs from the inputs alone against the signals.
    Output,
    /// The force that the measured motion needs against the measured force.
    Inverse,
}

/// A model, its recordings and the parameters to find.
#[derive(Clone, Debug)]
pub struct IdentificationProblem<'a> {
    /// The model.
    pub model: &'a CompiledModel,
    /// The study tied to it.
    pub bound: &'a BoundStudy,
    /// The parameters to find.
    pub free: Vec<EstimatedParameter>,
    /// Per signal the sensor's range.
    pub full_scale: Vec<f64>,
    /// Per signal the noise: as the study says, or as sixth differences show.
    pub noise: Vec<f64>,
}

/// What methods add to least squares.
trait WeightedResiduals: LeastSquares {
    fn weights(&mut self) -> &mut ResidualWeights;
    /// How many unknowns: the parameters, then initial states.
    fn unknowns(&self) -> usize;
    /// Conditions between pieces of recordings begin to count little.
    fn loosen(&mut self) {}
    /// They count more; false where they count as much as they ever do.
    fn tighten(&mut self) -> bool {
        false
    }
}

impl<'a> IdentificationProblem<'a> {
    /// Prepares an identification.
    ///
    /// # Errors
    /// [`Code::BadStudy`] when there is nothing to find, when bounds exclude a start value, or when there are fewer
    /// samples than unknowns.
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

    /// What is known beforehand, as residuals.
    fn priors(&self, z: &[f64]) -> Vec<f64> {
        self.free.iter().zip(z).filter(|(f, _)| f.prior.is_finite()).map(|(f, z)| z / f.prior).collect()
    }

    /// Their derivatives, in the rows after those of the data. There are as many rows below as initial states.
    fn prior_rows(&self, jacobian: &mut DMatrix<f64>) {
        let known = self.free.iter().filter(|f| f.prior.is_finite()).count();
        let states = jacobian.ncols() - self.free.len();
        let first = jacobian.nrows() - states - known;
        let with_prior = self.free.iter().enumerate().filter(|(_, f)| f.prior.is_finite());
        for (row, (j, free)) in with_prior.enumerate() {
            jacobian[(first + row, j)] = 1.0 / free.prior;
        }
    }

    /// Standard deviations of the signals to begin with.
    fn first_deviations(&self) -> Vec<f64> {
        self.full_scale.iter().zip(&self.noise).map(|(f, n)| n.max(1e-6 * f).max(f64::MIN_POSITIVE)).collect()
    }

    fn bounds(&self, unknowns: usize) -> VariableBounds {
        let mut bounds = VariableBounds { low: vec![f64::NEG_INFINITY; unknowns], high: vec![f64::INFINITY; unknowns] };
        for (j, free) in self.free.iter().enumerate() {
            // a logarithmic scale reaches far, but not to numbers without meaning
            let far = if free.logarithmic { 20.0 } else { f64::INFINITY };
            bounds.low[j] = free.place(free.min).max(-far);
            bounds.high[j] = free.place(free.max).min(far);
        }
        bounds
    }
}

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
    let samples: usize = train.iter().flat_map(|r| &r.signals).flatten().filter(|v| !v.is_nan()).count();
    if samples < free.len() {
        let text = format!("{} parameters are to be found from {samples} samples", free.len());
        found.push(Diagnostic::new(Code::BadStudy, text));
    }
    found
}

/// The noise of a signal: its accuracy where the study says it, else what sixth differences show.
fn noise(bound: &BoundStudy, train: &[Recording], k: usize, full_scale: f64) -> f64 {
    bound.signals[k]
        .deviation(full_scale)
        .unwrap_or_else(|| train.iter().map(|r| noise::white(&[&r.signals[k]])).fold(0.0, f64::max))
}

/// An identification under way: the method chosen, and what can be found.
pub struct Identification<'a> {
    problem: &'a IdentificationProblem<'a>,
    train: &'a [Recording],
    inverse: Option<ModelInversion>,
    /// What carries derivatives along in runs, or why there is nothing.
    exact: OnceLock<Result<Arc<ForwardSensitivityModel>, String>>,
    /// What can be found at all, judged at the start values.
    pub separation: IdentifiabilityAnalysis,
    /// Variables whose measurement would tell the members of each blind group apart, best first.
    pub advice: Vec<Vec<String>>,
    /// Warnings about columns that seem to have another sign or unit than the study says.
    pub suspicions: Vec<Diagnostic>,
}

impl<'a> Identification<'a> {
    /// Chooses the method and judges what the data can tell.
    ///
    /// # Errors
    /// [`Code::BadStudy`] when the method does not apply; [`Code::StepTooSmall`] and others when the model cannot follow
    /// the recordings with the start values.
    pub fn new(
        problem: &'a IdentificationProblem<'a>,
        train: &'a [Recording],
        method: IdentifyMethod,
    ) -> Result<Self, Diagnostic> {
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

    /// Whether the inverse model is used.
    pub fn method(&self) -> IdentifyMethod {
        if self.inverse.is_some() { IdentifyMethod::Inverse } else { IdentifyMethod::Output }
    }

    fn judge(&mut self) -> Result<(), Diagnostic> {
        let z = vec![0.0; self.problem.free.len()];
        let mut suspicions = Vec::new();
        let information = match self.inverse_model()? {
            Some(mut model) => information(&mut model, z.len()),
            None => {
                let mut model = self.output_error()?;
                if let Some(residual) = model.residual(&vec![0.0; model.unknowns()]) {
                    suspicions = foreign(self.problem, &model.trajectories(self.train, residual.as_slice()));
                }
                information(&mut model, z.len())
            }
        };
        let information = information.map_err(|broken| cannot_follow(broken.as_ref()))?;
        self.suspicions = suspicions;
        self.separation = separate(&information);
        self.advice = self.separation.blind.iter().map(|b| self.what_separates(b)).collect();
        Ok(())
    }

    fn inverse_model(&self) -> Result<Option<InverseModel<'_>>, Diagnostic> {
        let Some(inverse) = &self.inverse else { return Ok(None) };
        let model = InverseModel::new(self.problem, inverse, self.train);
        model.map(Some).ok_or_else(|| Diagnostic::new(Code::BadStudy, "a recording is too short for the inverse model"))
    }

    fn output_error(&self) -> Result<OutputError<'_>, Diagnostic> {
        let mut model = OutputError::new(self.problem, self.train, None).map_err(|b| cannot_follow(Some(&b)))?;
        let exact = self.exact.get_or_init(|| ForwardSensitivityModel::new(self.problem).map(Arc::new));
        model.differentiate_by(exact.clone());
        Ok(model)
    }

    /// Variables that move most, against their range, when the parameters of a blind group move against each other.
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
        let Ok(base) = runs.simulate(0, &z, &wanted) else { return Vec::new() };
        z.iter_mut().zip(&blind.direction).for_each(|(z, d)| *z = 0.05 * d);
        let Ok(moved) = runs.simulate(0, &z, &wanted) else { return Vec::new() };
        let mut effects: Vec<(f64, &String)> =
            base.iter().zip(&moved).zip(names).map(|((a, b), n)| (effect(a, b), n)).collect();
        effects.retain(|(e, _)| *e > 2e-3);
        effects.sort_by(|a, b| b.0.total_cmp(&a.0));
        effects.into_iter().take(3).map(|(_, n)| n.clone()).collect()
    }

    /// Searches for the parameters, from their values in the model.
    ///
    /// # Errors
    /// As [`Identification::new`].
    pub fn fit(&self) -> Result<ParameterFit, Diagnostic> {
        self.fit_from(1, 1)
    }

    /// Searches from the values in the model and from `starts - 1` places around them, drawn within bounds and tolerances
    /// and at most a factor of e away; the best end counts, and [`ParameterFit::starts`] tells where the others led. The same
    /// `seed` draws the same places.
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
                fit.converged &= fit.joints.as_ref().is_none_or(|j| j.jump <= pieces::APART);
                Ok(fit)
            }
        }
    }

    /// How the fitted model does on recordings that were not used. Initial states that no parameter decides are found
    /// from the first 5 % of each recording, at most 0.2 s, which are then not scored.
    ///
    /// # Errors
    /// When the model cannot follow them.
    pub fn judge_held(&self, fit: &ParameterFit, held: &[Recording]) -> Result<Vec<SignalFit>, Diagnostic> {
        let z: Vec<f64> = self.problem.free.iter().zip(&fit.values).map(|(f, &v)| f.place(v)).collect();
        if let Some(inverse) = &self.inverse {
            let model = InverseModel::new(self.problem, inverse, held);
            let mut model =
                model.ok_or_else(|| Diagnostic::new(Code::BadStudy, "a held recording is too short to judge by"))?;
            let residual = model.residual(&z).ok_or_else(|| cannot_follow(None))?;
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
        let whole = OutputError::new(self.problem, held, Some(&z)).map_err(|b| cannot_follow(Some(&b)))?;
        let mut scored = held.to_vec();
        let mut states = vec![0.0; whole.unknowns()];
        if whole.frees_states() {
            let mut first = whole.beginning(beginning);
            let unbounded =
                VariableBounds { low: vec![f64::NEG_INFINITY; states.len()], high: vec![f64::INFINITY; states.len()] };
            if let Some(found) = minimise(&mut first, &states, &unbounded, StoppingCriteria::default()) {
                states = found.z;
            }
            for recording in &mut scored {
                let end = recording.times[0] + beginning(&recording.times);
                let count = recording.times.partition_point(|&t| t <= end);
                recording.signals.iter_mut().for_each(|s| s[..count].fill(f64::NAN));
            }
        }
        let mut whole = OutputError::new(self.problem, &scored, Some(&z)).map_err(|b| cannot_follow(Some(&b)))?;
        let residual = whole.residual(&states).ok_or_else(|| cannot_follow(whole.broken.as_ref()))?;
        Ok(signal_fits(self.problem, whole.weights(), residual.as_slice(), &scored))
    }
}

/// How much of a recording serves to find its initial state, in seconds.
fn beginning(times: &[f64]) -> f64 {
    (0.05 * (times[times.len() - 1] - times[0])).min(0.2)
}

/// The sum of squares of the sensitivities at the start, initial states taken out.
fn information(model: &mut dyn WeightedResiduals, parameters: usize) -> Result<DMatrix<f64>, Option<RunFailure>> {
    let z = vec![0.0; model.unknowns()];
    let residual = model.residual(&z).ok_or(None)?;
    let jacobian = model.jacobian(&z, &residual).ok_or(None)?;
    let data = model.weights().series.iter().map(|s| s.rows.end).max().unwrap_or(0);
    let seen = jacobian.rows(0, data);
    // an initial state is known to about its nominal value, one between pieces is the end of another piece
    let states = all_states(&jacobian, parameters);
    let all = seen.tr_mul(&seen) + states.tr_mul(&states);
    Ok(without_rest(&all, parameters))
}

/// The rows about states: what is known about them beforehand, or where they have to be.
fn all_states(jacobian: &DMatrix<f64>, parameters: usize) -> nalgebra::DMatrixView<'_, f64> {
    let states = jacobian.ncols() - parameters;
    jacobian.rows(jacobian.nrows() - states, states)
}

/// Minimises from a place, with the deviations of the signals as they are.
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

/// Minimises, takes the deviations of the signals from the errors, and minimises again until they stay.
fn search(
    problem: &IdentificationProblem<'_>,
    model: &mut dyn WeightedResiduals,
    floor: &[f64],
    from: &[f64],
) -> Option<LeastSquaresSolution> {
    let floor = if floor.is_empty() { vec![0.0; model.weights().sigma.len()] } else { floor.to_vec() };
    let mut z = from.to_vec();
    model.loosen();
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
            // those by which the residual was divided
            model.weights().sigma = sigma;
            return Some(minimum);
        }
    }
    None
}

/// Lets a search borrow a model between two looks at its weights.
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

/// The largest change over the range of the first.
fn effect(base: &[f64], moved: &[f64]) -> f64 {
    let range =
        base.iter().copied().fold(f64::NEG_INFINITY, f64::max) - base.iter().copied().fold(f64::INFINITY, f64::min);
    let change = base.iter().zip(moved).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let size = base.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    if size > 0.0 && range > 0.0 { change / range.max(1e-3 * size) } else { 0.0 }
}

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
