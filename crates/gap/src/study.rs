//! From a study file and its recordings to a [`DiagnosisProblem`].
//!
//! Enters: a `Study` (read by `bramah_analysis::study`) and a `World`. Leaves: a [`DiagnosisStudy`], or the diagnostics
//! of what is wrong. It compiles the nominal model, binds the study to it, loads recordings, and fits the hypotheses'
//! grids to them. Called by `diagnose`, by the command for plans (`planned`) and for lists of hypotheses
//! ([`proposed`]).

use super::capacity;
use super::circuit::{self, CircuitTopology};
use super::data::RecordingData;
use super::effects::{self, EffectModel};
use super::hypotheses::{self, Hypothesis, SensorSignal, UncertainParameter};
use super::mistakes::mistakes;
use super::problem::{DiagnosisProblem, SignalDisplayUnit, ToleranceParameter};
use super::shapes;
use bramah_analysis::noise;
use bramah_analysis::study::{BoundSignal, BoundStudy, DataSheetTolerance, RecordingRole, Study, full_scales};
use bramah_expr::VarId;
use bramah_expr::units::MeasurementUnit;
use bramah_model::flat::{FlatModel, ScalarType, Variability};
use bramah_solve::Interpolation;
use bramah_solve::lower::{LoweringOptions, lower};
use bramah_syntax::diag::{Code, Diagnostic, Sources};
use bramah_syntax::world::World;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Standard deviation assumed for parameters if the study states no tolerance, as part of their value.
pub const ASSUMED: f64 = 0.05;

/// Noise of a sensor without a stated accuracy, as part of its range, in a plan.
const ACCURACY: f64 = 3e-3;

/// Message for a model that samples: the diagnosis evaluates it point by point between the samples of a recording, so
/// its clocks would never tick.
const SAMPLED: &str = "the diagnosis cannot follow a model that samples";

/// A study with its problem.
pub struct DiagnosisStudy<'a> {
    /// What is diagnosed.
    pub problem: DiagnosisProblem<'a>,
    /// The study bound to the variables of the model.
    pub bound: BoundStudy,
    /// The nominal model, flattened.
    flat: FlatModel,
    /// Warnings.
    pub diagnostics: Vec<Diagnostic>,
}

/// Recordings that take no part in fitting.
pub struct HoldoutData {
    /// Their files, for messages.
    pub files: Vec<String>,
    /// The recordings.
    pub recordings: Vec<RecordingData>,
}

/// Why a study cannot be used.
pub struct StudyError {
    /// What is wrong.
    pub diagnostics: Vec<Diagnostic>,
    /// Texts of the model, if the diagnostics point into them; `None` if they point into the study.
    pub sources: Option<Sources>,
    /// The nominal model is wrong, not the study.
    pub model: bool,
}

impl StudyError {
    /// An error of the study.
    fn study(diagnostics: Vec<Diagnostic>) -> Self {
        StudyError { diagnostics, sources: None, model: false }
    }

    /// An error of the nominal model, from a failed compilation.
    fn model<T>(outcome: bramah_model::compile::CompileOutcome<T>) -> Self {
        StudyError { diagnostics: outcome.diagnostics, sources: Some(outcome.sources), model: true }
    }
}

/// Builds the problem: places, hypotheses with fitted grids, tolerances, noise.
/// Errors of recordings are added last, since they have nothing that could be fitted to the recordings.
pub fn question<'a>(
    world: &'a dyn World,
    study: &Study,
    data: Option<&Path>,
    sources: &mut Sources,
) -> Result<DiagnosisStudy<'a>, StudyError> {
    let nominal = NominalModel::read(world, study)?;
    let (train, warnings) = nominal.train(world, data, sources)?;
    nominal.question(world, study, train, warnings)
}

/// The same before anything was measured: recordings have inputs only, and the signals are those of the nominal model.
/// Noise is the sensors' accuracy, or a part of their range if the study states none.
///
/// # Errors
/// [`StudyError`].
pub fn planned<'a>(
    world: &'a dyn World,
    study: &Study,
    data: Option<&Path>,
    sources: &mut Sources,
) -> Result<DiagnosisStudy<'a>, StudyError> {
    let mut nominal = NominalModel::read(world, study)?;
    // without signals, recordings need no columns for them
    let signals = std::mem::take(&mut nominal.bound.signals);
    let (train, warnings) = nominal.train(world, data, sources)?;
    nominal.bound.signals = signals;
    let train = nominal.shown(world, study, train)?;
    let mut question = nominal.question(world, study, train, warnings)?;
    let problem = &mut question.problem;
    // the columns are simulated, so they cannot have a wrong sign or unit
    problem.hypotheses.retain(|h| !h.is_recording_error());
    let accuracy = |(s, &scale): (&BoundSignal, &f64)| s.deviation(scale).unwrap_or(ACCURACY * scale);
    let floor = question.bound.signals.iter().zip(&problem.full_scale).map(accuracy);
    // a floor of rounding, so that no weight is infinite
    problem.noise_floor = floor.zip(&problem.full_scale).map(|(n, f)| n.max(1e-9 * f.abs())).collect();
    Ok(question)
}

/// The nominal model of a study, with the study bound to it.
struct NominalModel {
    /// Flat equations.
    flat: FlatModel,
    /// Sorted equations, for values of parameters.
    dae: bramah_model::structure::Dae,
    /// The study bound to the variables of the model.
    bound: BoundStudy,
    /// Request that compiles the model.
    request: bramah_model::compile::Request,
}

impl NominalModel {
    /// Compiles the model and binds the study.
    ///
    /// # Errors
    /// [`StudyError`]; also for a model that samples.
    fn read(world: &dyn World, study: &Study) -> Result<Self, StudyError> {
        let request = study.request();
        let outcome = bramah_model::compile::sort(world, &request);
        let Some((flat, _, dae)) = outcome.value else { return Err(StudyError::model(outcome)) };
        if let Some(sample) = dae.samples.first() {
            let place = bramah_solve::at_origin(&dae, Code::BadStudy, SAMPLED, sample.origin, "reads at its own times");
            let help = "record what the controller commands and make that an input of the model; `bramah identify` follows samples";
            let (diagnostics, sources) = (vec![place.help(help)], Some(outcome.sources));
            return Err(StudyError { diagnostics, sources, model: true });
        }
        let checked = study.bind(&flat);
        let Some(bound) = checked.value else { return Err(StudyError::study(checked.diagnostics)) };
        Ok(NominalModel { flat, dae, bound, request })
    }

    /// Loads the train recordings; the second value has warnings.
    fn train(
        &self,
        world: &dyn World,
        data: Option<&Path>,
        sources: &mut Sources,
    ) -> Result<(Vec<bramah_analysis::study::Recording>, Vec<Diagnostic>), StudyError> {
        let checked = self.bound.load(world, data, RecordingRole::Train, sources);
        match checked.value {
            Some(train) => Ok((train, checked.diagnostics)),
            None => Err(StudyError::study(checked.diagnostics)),
        }
    }

    /// Recordings of inputs, completed by the signals of the nominal model.
    fn shown(
        &self,
        world: &dyn World,
        study: &Study,
        mut train: Vec<bramah_analysis::study::Recording>,
    ) -> Result<Vec<bramah_analysis::study::Recording>, StudyError> {
        // scales do not matter here: nothing is fitted
        let signals = signals(&self.flat, &self.bound, &vec![1.0; self.bound.signals.len()]);
        let offer = offer(world, study, &signals, &[])?;
        let mut problem = DiagnosisProblem {
            world,
            request: self.request.clone(),
            folder: None,
            circuit: offer.circuit,
            hypotheses: Vec::new(),
            disturbances: Vec::new(),
            noise_floor: vec![1.0; signals.len()],
            full_scale: vec![1.0; signals.len()],
            shown: self.bound.signals.iter().map(shown).collect(),
            signals,
            tolerances: Vec::new(),
            files: Vec::new(),
            train: train.iter().map(|r| recording(&self.flat, &self.bound, r.clone())).collect(),
            travel: BTreeMap::new(),
        };
        if problem.show().is_none() {
            let text = "the nominal model does not reach the end of the planned recordings";
            let help = "try `bramah simulate` with these inputs";
            return Err(StudyError::study(vec![Diagnostic::new(Code::BadData, text.to_string()).help(help)]));
        }
        for (own, shown) in train.iter_mut().zip(&problem.train) {
            own.signals = shown.signals.iter().map(|s| s.to_vec()).collect();
        }
        Ok(train)
    }

    /// Builds the problem: places, hypotheses with fitted grids, tolerances, noise.
    fn question<'a>(
        self,
        world: &'a dyn World,
        study: &Study,
        train: Vec<bramah_analysis::study::Recording>,
        mut diagnostics: Vec<Diagnostic>,
    ) -> Result<DiagnosisStudy<'a>, StudyError> {
        let NominalModel { flat, dae, bound, request } = self;
        let full_scale = full_scales(&bound, &train);
        let signals = signals(&flat, &bound, &full_scale);
        let tolerances = tolerances(&flat, &bound, &parameter_values(dae));
        let offer = offer(world, study, &signals, &free(&tolerances))?;
        diagnostics.extend(offer.diagnostics);
        let mut disturbances = hypotheses::hypotheses(&offer.circuit, &offer.sources, &signals, &[]);
        // sources with shared coefficients are not needed
        disturbances.retain(|d| d.attachments.len() == 1);
        let shown = bound.signals.iter().map(shown).collect();
        let files = train.iter().map(|r| r.file.clone()).collect();
        let train: Vec<RecordingData> = train.into_iter().map(|r| recording(&flat, &bound, r)).collect();
        let noise_floor = full_scale.iter().enumerate().map(|(i, scale)| floor(&train, i, *scale)).collect();
        let mut problem = DiagnosisProblem {
            world,
            request,
            folder: offer.folder,
            circuit: offer.circuit,
            hypotheses: offer.hypotheses,
            disturbances,
            signals,
            full_scale,
            shown,
            noise_floor,
            tolerances,
            files,
            train,
            travel: BTreeMap::new(),
        };
        // the travel of the states sets their sizes in all later simulations, so it is found first
        problem.explore();
        shapes::fit(&mut problem);
        capacity::bound(&mut problem);
        let mistakes = mistakes(&problem, &offer.effects);
        problem.hypotheses.extend(mistakes);
        Ok(DiagnosisStudy { problem, bound, flat, diagnostics })
    }
}

/// All hypotheses that a study allows, with warnings, without reading recordings. Sensors without a stated range count
/// with a range of 1.
///
/// # Errors
/// [`StudyError`].
pub fn proposed(world: &dyn World, study: &Study) -> Result<(Vec<Hypothesis>, Vec<Diagnostic>), StudyError> {
    let outcome = bramah_model::compile::flatten(world, &study.request());
    let Some(f) = outcome.value else { return Err(StudyError::model(outcome)) };
    let checked = study.bind(&f.flat);
    let Some(bound) = checked.value else { return Err(StudyError::study(checked.diagnostics)) };
    let ranges: Vec<f64> = bound.signals.iter().map(|s| s.full_scale.unwrap_or(1.0)).collect();
    let written = |v: VarId| f.flat.variables[v.index()].binding.and_then(|b| f.flat.exprs.as_num(b)).unwrap_or(0.0);
    let free = free(&stated(&f.flat, &bound, &written));
    let offer = offer(world, study, &signals(&f.flat, &bound, &ranges), &free)?;
    Ok((offer.hypotheses, offer.diagnostics))
}

/// What the network of a study's model offers.
struct HypothesisSpace {
    /// Topology of the model.
    circuit: CircuitTopology,
    /// Folder with the user's own effects.
    folder: Option<PathBuf>,
    /// All hypotheses that the study allows.
    hypotheses: Vec<Hypothesis>,
    /// The complete library.
    effects: Vec<Arc<EffectModel>>,
    /// Disturbance sources, not yet attached.
    sources: Vec<Arc<EffectModel>>,
    /// Warnings about effects.
    diagnostics: Vec<Diagnostic>,
}

/// Reads topology and library, and puts the effects at their places.
/// The study's choice of effects and its measured inputs already apply.
fn offer(
    world: &dyn World,
    study: &Study,
    signals: &[SensorSignal],
    free: &[UncertainParameter],
) -> Result<HypothesisSpace, StudyError> {
    let outcome = circuit::circuit(world, &study.request());
    let Some(circuit) = outcome.value else { return Err(StudyError::model(outcome)) };
    let folder = study.effects.folder.as_ref().map(|f| study.folder.join(f));
    let read = effects::catalogue(world, folder.as_deref());
    let Some(catalogue) = read.value else { return Err(StudyError::model(read)) };
    let mut hypotheses = hypotheses::hypotheses(&circuit, &catalogue.effects, signals, free);
    hypotheses::narrow(&mut hypotheses, &study.effects);
    let measured = study.inputs.iter().filter(|i| i.measured).map(|i| i.name.as_str()).collect::<Vec<_>>();
    hypotheses::without_commands(&mut hypotheses, &circuit, &measured);
    let (effects, sources) = (catalogue.effects, catalogue.disturbances);
    Ok(HypothesisSpace { circuit, folder, hypotheses, effects, sources, diagnostics: read.diagnostics })
}

/// The study's signals with their full scales.
fn signals(flat: &FlatModel, bound: &BoundStudy, ranges: &[f64]) -> Vec<SensorSignal> {
    let name = |v: VarId| flat.variables[v.index()].name.clone();
    let signal =
        |(s, &scale): (&BoundSignal, &f64)| SensorSignal { name: s.name.clone(), variable: name(s.variable), scale };
    bound.signals.iter().zip(ranges).map(signal).collect()
}

/// Display unit of a signal: that of its column. The factor is for differences, so that the zero of a temperature does
/// not matter.
fn shown(signal: &BoundSignal) -> SignalDisplayUnit {
    let own = SignalDisplayUnit { unit: signal.unit.clone(), factor: 1.0 };
    let Some(unit) = &signal.entry.unit else { return own };
    let (Ok(from), Ok(to)) = (MeasurementUnit::parse(&signal.unit), MeasurementUnit::parse(unit)) else { return own };
    match (from.convert(1.0, &to), from.convert(0.0, &to)) {
        (Some(one), Some(zero)) => SignalDisplayUnit { unit: unit.clone(), factor: one - zero },
        _ => own,
    }
}

/// Parameters with tolerances as hypotheses need them.
fn free(tolerances: &[ToleranceParameter]) -> Vec<UncertainParameter> {
    tolerances.iter().map(|t| UncertainParameter { name: t.name.clone(), nominal: t.nominal, sigma: t.sigma }).collect()
}

impl DiagnosisStudy<'_> {
    /// Reads the held recordings.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn held(&self, data: Option<&Path>, sources: &mut Sources) -> Result<HoldoutData, Vec<Diagnostic>> {
        let checked = self.bound.load(self.problem.world, data, RecordingRole::Held, sources);
        let found = checked.value.ok_or(checked.diagnostics)?;
        let files = found.iter().map(|r| r.file.clone()).collect();
        let recordings = found.into_iter().map(|r| recording(&self.flat, &self.bound, r)).collect();
        Ok(HoldoutData { files, recordings })
    }
}

/// Standard deviation of a signal's noise as estimated from its samples, SI; never quite zero.
/// A constant or coarsely quantised signal shows none.
fn floor(train: &[RecordingData], signal: usize, full_scale: f64) -> f64 {
    let samples: Vec<&[f64]> = train.iter().map(|r| &*r.signals[signal]).collect();
    noise::floor(&samples).max(1e-9 * full_scale.abs())
}

/// A function that gives the value of a parameter of the nominal model, SI.
fn parameter_values(dae: bramah_model::structure::Dae) -> impl Fn(VarId) -> f64 {
    let system = lower(Arc::new(dae), &LoweringOptions::INTERPRETED);
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &[]);
    move |v| values[system.layout.var(v)]
}

/// A recording in the order of the model's inputs. Inputs that the study leaves out keep their start value.
fn recording(flat: &FlatModel, bound: &BoundStudy, r: bramah_analysis::study::Recording) -> RecordingData {
    let count = r.times.len();
    let mut inputs: Vec<Arc<[f64]>> = Vec::new();
    let mut linear = Vec::new();
    for (v, variable) in (0..).map(VarId).zip(&flat.variables).filter(|(_, v)| v.input) {
        match bound.inputs.iter().position(|i| i.variable == v) {
            Some(i) => {
                inputs.push(Arc::from(&r.inputs[i][..]));
                linear.push(bound.inputs[i].interpolation == Interpolation::Linear);
            }
            None => {
                let value = variable.binding.or(variable.start).and_then(|e| flat.exprs.as_num(e)).unwrap_or(0.0);
                inputs.push(Arc::from(vec![value; count]));
                linear.push(false);
            }
        }
    }
    let signals = r.signals.iter().map(|s| Arc::from(&s[..])).collect();
    RecordingData { times: Arc::from(&r.times[..]), inputs, linear, signals }
}

/// Tolerances that the study states.
fn stated(flat: &FlatModel, bound: &BoundStudy, value: &impl Fn(VarId) -> f64) -> Vec<ToleranceParameter> {
    let mut all = Vec::new();
    for p in &bound.parameters {
        let nominal = value(p.variable);
        let sigma = match p.knowledge {
            DataSheetTolerance::Exact => continue,
            DataSheetTolerance::Relative(part) => part * nominal.abs(),
            DataSheetTolerance::Absolute(value) => value,
            // a free parameter has no prior, but needs a scale
            DataSheetTolerance::Free => nominal.abs().max(1e-12),
        };
        let t = tolerance(flat, p.variable, nominal, sigma, (p.min, p.max), false);
        all.push(ToleranceParameter { free: matches!(p.knowledge, DataSheetTolerance::Free), ..t });
    }
    all
}

/// Tolerances of the study. If it states none: [`ASSUMED`] for all parameters with a unit that do not depend on others.
fn tolerances(flat: &FlatModel, bound: &BoundStudy, value: &impl Fn(VarId) -> f64) -> Vec<ToleranceParameter> {
    if !bound.parameters.is_empty() {
        return stated(flat, bound, value);
    }
    let mut all = Vec::new();
    for (v, variable) in (0..).map(VarId).zip(&flat.variables) {
        // a parameter without a unit gets no assumed tolerance
        let physical = variable.unit.as_deref().is_some_and(|u| !u.is_empty() && u != "1");
        if variable.hidden
            || !physical
            || variable.variability != Variability::Parameter
            || variable.ty != ScalarType::Real
            || !flat.is_root(v)
        {
            continue;
        }
        let nominal = value(v);
        if nominal != 0.0 && nominal.is_finite() {
            all.push(tolerance(flat, v, nominal, ASSUMED * nominal.abs(), (None, None), true));
        }
    }
    all
}

/// One parameter with its bounds: those of the study, else those of the model.
fn tolerance(
    flat: &FlatModel,
    v: VarId,
    nominal: f64,
    sigma: f64,
    bounds: (Option<f64>, Option<f64>),
    assumed: bool,
) -> ToleranceParameter {
    let variable = &flat.variables[v.index()];
    let number = |e: Option<bramah_expr::ExprId>| e.and_then(|e| flat.exprs.as_num(e)).filter(|b| b.is_finite());
    // a parameter that must not be negative stays positive: its least value is a hundredth of the nominal one
    let declared = number(variable.min).map(|m| if m == 0.0 && nominal > 0.0 { 0.01 * nominal } else { m });
    let least = if nominal > 0.0 { Some(0.01 * nominal) } else { None };
    ToleranceParameter {
        name: variable.name.clone(),
        unit: variable.unit.as_deref().unwrap_or("").to_string(),
        nominal,
        sigma,
        min: bounds.0.or(declared).or(least).unwrap_or(f64::NEG_INFINITY),
        max: bounds.1.or(number(variable.max)).unwrap_or(f64::INFINITY),
        assumed,
        free: false,
    }
}
