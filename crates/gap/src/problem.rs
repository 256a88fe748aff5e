//! What is diagnosed, and the models that are made of it.
//!
//! [`DiagnosisProblem`] holds the nominal model with its places, the hypotheses, tolerances, sensors and train
//! recordings. `study` fills it. [`DiagnosisProblem::assemble`] attaches hypotheses: it writes the augmented Modelica
//! text, compiles it, and lifts tolerances, coefficients and shapes to parameters with derivatives. `select::models`
//! calls it for every model.
//!
//! Signals, full scales, noise and display units have one order, that of the study. Values are in SI units.

use super::augment::{self, AugmentedModel, HypothesisInstance, PLANT};
use super::circuit::CircuitTopology;
use super::clock::Deadline;
use super::data::{InputSegment, RecordingData};
use super::estimate::FitTask;
use super::estimate::simulation::{correction, from_start};
use super::hypotheses::{AttachmentSite, Hypothesis, SensorSignal};
use bramah_analysis::lift;
use bramah_analysis::local::{EvaluationPlan, LocalEvaluator};
use bramah_expr::VarId;
use bramah_model::compile::Request;
use bramah_model::flat::FlatModel;
use bramah_syntax::diag::Diagnostic;
use bramah_syntax::world::World;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Travel in nominal sizes from which on a state's `nominal` is taken for a default, and the travel is its size
/// instead.
const DEFAULT: f64 = 10.0;
/// The unit in which a signal is shown: that of its column in the study.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalDisplayUnit {
    /// The unit; empty if there is none.
    pub unit: String,
    /// Factor from a difference in SI units to one in the unit.
    pub factor: f64,
}

impl SignalDisplayUnit {
    /// Converts a difference from SI units.
    pub fn value(&self, si: f64) -> f64 {
        si * self.factor
    }
}

/// A parameter that may deviate from its data sheet within a tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct ToleranceParameter {
    /// Full name in the nominal model.
    pub name: String,
    /// Its unit as written.
    pub unit: String,
    /// Value of the nominal model, SI.
    pub nominal: f64,
    /// Tolerance as one standard deviation, SI.
    pub sigma: f64,
    /// Lower bound, SI.
    pub min: f64,
    /// Upper bound, SI.
    pub max: f64,
    /// The tolerance is assumed, because the study states none.
    pub assumed: bool,
    /// The study leaves the parameter free: it has no prior, and `sigma` is only its scale.
    pub free: bool,
}

/// The complete question of a diagnosis.
pub struct DiagnosisProblem<'a> {
    /// Source of all files.
    pub world: &'a dyn World,
    /// Request that compiles the nominal model.
    pub request: Request,
    /// Folder with the user's own effects; `None` without any.
    pub folder: Option<PathBuf>,
    /// Places of the nominal model.
    pub circuit: CircuitTopology,
    /// All hypotheses, errors of recordings and shapes included. Their indices are used everywhere.
    pub hypotheses: Vec<Hypothesis>,
    /// One disturbance source per node, command and sensor.
    pub disturbances: Vec<Hypothesis>,
    /// Measured signals, in the order of the recordings' signals.
    pub signals: Vec<SensorSignal>,
    /// Full scale of each signal, SI.
    pub full_scale: Vec<f64>,
    /// Unit in which each signal is shown.
    pub shown: Vec<SignalDisplayUnit>,
    /// Standard deviation of each signal's noise as estimated from the samples, SI: an upper bound where signals move
    /// fast.
    pub noise_floor: Vec<f64>,
    /// Parameters with their tolerances.
    pub tolerances: Vec<ToleranceParameter>,
    /// Files of the train recordings, for messages.
    pub files: Vec<String>,
    /// Train recordings.
    pub train: Vec<RecordingData>,
    /// How far the states of the nominal model move over the recordings, by name, SI; see
    /// [`DiagnosisProblem::explore`].
    pub travel: BTreeMap<String, f64>,
}

/// A compiled model with hypotheses attached.
#[derive(Clone, Debug)]
pub struct AssembledModel {
    /// The model with its derivatives, ready to be evaluated.
    pub plan: Arc<EvaluationPlan>,
    /// Value of each parameter of the plan, SI.
    pub theta: Vec<f64>,
    /// Range of the tolerance parameters in the plan, in the order of the problem; always the first ones.
    pub free: Range<usize>,
    /// Range of the disturbance sources in the plan, in the order in which they were asked for.
    pub sources: Range<usize>,
    /// Per attached hypothesis the indices of its coefficients, then of its shapes, among the parameters of the plan.
    pub attached: Vec<Vec<usize>>,
    /// Parameters that act in one recording only: index in the plan, index of the recording.
    pub own: Vec<(usize, usize)>,
    /// Usual size of each state, SI.
    pub sizes: Vec<f64>,
    /// Accepted correction of a simulation step, in parts of these sizes.
    pub correction: f64,
    /// How far each state moves in the nominal model, SI; 0 where unknown.
    pub travel: Vec<f64>,
    /// The Modelica text that was compiled.
    pub augmented: AugmentedModel,
}

impl AssembledModel {
    /// Sets the sizes of the states of an effect through which a signal passes to the size of that signal.
    fn take_sizes_of(&mut self, attached: &HypothesisInstance<'_>) {
        let Some(size) = attached.hypothesis.passes.filter(|s| s.is_normal()) else { return };
        let instances = format!("{}_", attached.name);
        let variables = &self.plan.system.dae.variables;
        for (v, own) in self.plan.state_variables().zip(&mut self.sizes) {
            let name = &variables[v.index()].name;
            if of_plant(name).unwrap_or(name).starts_with(&instances) {
                *own = size;
            }
        }
    }
}

/// A hypothesis with values of its coefficients and shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct HypothesisValues {
    /// Index into [`DiagnosisProblem::hypotheses`].
    pub hypothesis: usize,
    /// Values of its coefficients, then of its shapes, SI.
    pub values: Vec<f64>,
}

impl DiagnosisProblem<'_> {
    /// The train recordings as a task for fits until a deadline.
    pub fn task<'b>(&'b self, until: Deadline<'b>) -> FitTask<'b> {
        FitTask { train: &self.train, full_scale: &self.full_scale, until }
    }

    /// Unit of a signal's variable as written; empty without one.
    pub fn unit(&self, signal: &SensorSignal) -> String {
        self.circuit.units.get(&signal.variable).cloned().unwrap_or_default()
    }

    /// Indices of the disturbances that act at nodes.
    pub fn node_sources(&self) -> Vec<usize> {
        let at_node = |d: &Hypothesis| matches!(d.attachments[0].site, AttachmentSite::Node(_));
        (0..self.disturbances.len()).filter(|&i| at_node(&self.disturbances[i])).collect()
    }

    /// Median time between samples over all train recordings, s; 0 without any.
    pub fn step(&self) -> f64 {
        let steps =
            |r: &RecordingData| r.times.windows(2).map(|w| w[1] - w[0]).filter(|h| *h > 0.0).collect::<Vec<f64>>();
        let mut steps: Vec<f64> = self.train.iter().flat_map(steps).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(0.0)
    }

    /// The nominal model with hypotheses and disturbance sources attached. Coefficients and shapes are free.
    ///
    /// # Errors
    /// The diagnostics of the compiler: a hypothesis that cannot be attached.
    pub fn assemble(&self, chosen: &[HypothesisValues], sources: &[usize]) -> Result<AssembledModel, Vec<Diagnostic>> {
        self.assembled(chosen, sources, chosen.len())
    }

    /// As [`DiagnosisProblem::assemble`], but only the first `shaped` hypotheses have free shapes. Fixed shapes cost
    /// less.
    ///
    /// # Errors
    /// As [`DiagnosisProblem::assemble`].
    pub fn assembled(
        &self,
        chosen: &[HypothesisValues],
        sources: &[usize],
        shaped: usize,
    ) -> Result<AssembledModel, Vec<Diagnostic>> {
        let attached: Vec<HypothesisInstance<'_>> =
            chosen.iter().enumerate().map(|(i, c)| self.attached(c, &instance(i))).collect();
        let mut all = attached.clone();
        all.extend(sources.iter().map(|&s| HypothesisInstance {
            name: format!("s{s}"),
            hypothesis: &self.disturbances[s],
            values: Vec::new(),
        }));
        let augmented = augment::augment(&self.circuit, &all, &self.signals);
        let flat = self.flat(&augmented)?;
        // a hypothesis with fixed shapes frees as many parameters as it has coefficients
        let still = |(i, c): (usize, &HypothesisValues)| {
            let count = self.hypotheses[c.hypothesis].coefficients.len();
            if i < shaped { usize::MAX } else { count }
        };
        let counts: Vec<usize> = chosen.iter().enumerate().map(still).collect();
        let mut model = self.lifted(flat, augmented, &counts)?;
        for (places, c) in model.attached.iter().zip(chosen) {
            let coefficients = &self.hypotheses[c.hypothesis].coefficients;
            model.own.extend(places.iter().zip(coefficients).filter_map(|(&place, c)| Some((place, c.recording?))));
        }
        for a in &attached {
            model.take_sizes_of(a);
        }
        Ok(model)
    }

    /// Replaces the signals of the train recordings by those of the nominal model. `None` if a simulation stops early.
    pub fn show(&mut self) -> Option<()> {
        let shown = self.observe(&self.signals)?;
        let mut from = 0;
        for r in &mut self.train {
            let range = from..from + r.times.len();
            from = range.end;
            r.signals = shown.iter().map(|s| Arc::from(&s[range.clone()])).collect();
        }
        Some(())
    }

    /// Values of further variables in the nominal model, started as it is, over all train recordings one after the
    /// other. Outer index variable. `None` if a simulation stops early.
    pub fn observe(&self, variables: &[SensorSignal]) -> Option<Vec<Vec<f64>>> {
        self.observe_with(&[], None, variables)
    }

    /// The same for a model with hypotheses. `tolerances`: values of the tolerance parameters, SI; `None` means nominal
    /// ones.
    pub fn observe_with(
        &self,
        chosen: &[HypothesisValues],
        tolerances: Option<&[f64]>,
        variables: &[SensorSignal],
    ) -> Option<Vec<Vec<f64>>> {
        let attached: Vec<HypothesisInstance<'_>> =
            chosen.iter().enumerate().map(|(i, c)| self.attached(c, &instance(i))).collect();
        let augmented = augment::augment(&self.circuit, &attached, variables);
        let flat = self.flat(&augmented).ok()?;
        let mut model = self.lifted(flat, augmented, &[]).ok()?;
        if let Some(values) = tolerances {
            model.theta[model.free.clone()].copy_from_slice(values);
        }
        let mut all = vec![Vec::new(); variables.len()];
        for r in &self.train {
            let run = from_start(&model.plan, &model.theta, (&model.sizes, model.correction), r)?;
            all.iter_mut().zip(run).for_each(|(a, v)| a.extend(v));
        }
        Some(all)
    }

    /// Fills `travel`. The `nominal` attributes of the states may be defaults, so their real range is needed for step
    /// control.
    pub fn explore(&mut self) {
        let Ok(model) = self.assemble(&[], &[]) else { return };
        let variables = &model.plan.system.dae.variables;
        let states = model.plan.state_variables();
        let signals: Vec<SensorSignal> = states
            .filter_map(|v| of_plant(&variables[v.index()].name))
            .enumerate()
            .map(|(i, name)| SensorSignal { name: format!("state_{i}"), variable: name.to_string(), scale: 1.0 })
            .collect();
        let trajectories = self.observe(&signals).unwrap_or_default();
        let travel = |trajectory: &Vec<f64>| {
            let (least, most) =
                trajectory.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), v| (l.min(*v), m.max(*v)));
            most - least
        };
        self.travel = signals.into_iter().map(|s| s.variable).zip(trajectories.iter().map(travel)).collect();
    }

    /// Compiles an augmented text to flat equations.
    fn flat(&self, augmented: &AugmentedModel) -> Result<FlatModel, Vec<Diagnostic>> {
        let (overlay, request) =
            augment::request(self.world, &self.request, self.folder.as_deref(), augmented, "Augmented");
        let outcome = bramah_model::compile::flatten(&overlay, &request);
        outcome.value.map(|f| f.flat).ok_or(outcome.diagnostics)
    }

    /// A hypothesis with its values in the form in which `augment` takes it, under the instance name `name`.
    pub fn attached(&self, chosen: &HypothesisValues, name: &str) -> HypothesisInstance<'_> {
        let hypothesis = &self.hypotheses[chosen.hypothesis];
        let coefficients = hypothesis.coefficients.iter().map(super::effects::EffectCoefficient::label);
        let names = coefficients.chain(hypothesis.shapes.iter().map(|s| s.name.clone()));
        let values = names.zip(chosen.values.iter().copied()).collect();
        HypothesisInstance { name: name.into(), hypothesis, values }
    }

    /// Lifts tolerances, sources and the parameters of hypotheses to parameters with derivatives.
    /// `counts`: number of parameters of each hypothesis that are free.
    fn lifted(
        &self,
        flat: FlatModel,
        augmented: AugmentedModel,
        counts: &[usize],
    ) -> Result<AssembledModel, Vec<Diagnostic>> {
        let mut ids: Vec<VarId> = Vec::new();
        let mut add = |name: &str| -> Option<usize> {
            let v = variable(&flat, name)?;
            // a parameter may be a tolerance and a hypothesis at once; it is lifted once
            Some(ids.iter().position(|x| *x == v).unwrap_or_else(|| {
                ids.push(v);
                ids.len() - 1
            }))
        };
        // tolerances come first, so that `free` begins at 0
        for t in &self.tolerances {
            add(&format!("{PLANT}.{}", t.name));
        }
        let free = 0..self.tolerances.len();
        let mut sources = Vec::new();
        let mut attached = Vec::new();
        let (effect_names, source_names) = augmented.parameters.split_at(counts.len());
        // sources follow the hypotheses in the text, but the tolerances in the plan
        for names in source_names {
            sources.extend(names.iter().filter_map(|n| add(n)));
        }
        for (names, &count) in effect_names.iter().zip(counts) {
            attached.push(names.iter().take(count).filter_map(|n| add(n)).collect());
        }
        let sources = free.end..free.end + sources.len();
        let outputs: Vec<VarId> = augmented.signals.iter().filter_map(|n| variable(&flat, n)).collect();
        let plan = Arc::new(EvaluationPlan::new(&lift(&flat, &ids, &outputs))?);
        let theta = plan.parameter_values();
        let u = vec![0.0; plan.inputs()];
        // declared sizes of the states, evaluated where the first recording begins
        let sizes = match self.train.first() {
            Some(r) => {
                let u = InputSegment::new(r).from;
                LocalEvaluator::start(plan.clone(), r.times[0], &theta, &u)
            }
            None => LocalEvaluator::start(plan.clone(), 0.0, &theta, &u),
        };
        let mut sizes = sizes.map_or_else(|_| vec![1.0; plan.states()], |l| l.nominals());
        let travel = |v: VarId| {
            let name = of_plant(&plan.system.dae.variables[v.index()].name);
            name.and_then(|n| self.travel.get(n)).copied().filter(|t| t.is_finite()).unwrap_or(0.0)
        };
        let travel: Vec<f64> = plan.state_variables().map(travel).collect();
        for (i, (size, &travel)) in sizes.iter_mut().zip(&travel).enumerate() {
            // an angle may turn on and on, but laws repeat with every turn
            if travel > DEFAULT * *size && plan.state_unit(i) != Some("rad") {
                *size = travel;
            }
        }
        let correction = correction(&self.noise_floor, &self.full_scale);
        Ok(AssembledModel {
            plan,
            theta,
            free,
            sources,
            attached,
            own: Vec::new(),
            sizes,
            correction,
            travel,
            augmented,
        })
    }
}

/// Instance name of the chosen hypothesis of this number.
fn instance(number: usize) -> String {
    format!("e{number}")
}

/// The variable that flows through the first instance of a chosen hypothesis, SI; `None` for signals and parameters.
pub fn through(number: usize, hypothesis: &Hypothesis) -> Option<SensorSignal> {
    let effect = hypothesis.attachments[0].effect.as_ref()?;
    let through = effect.interface.through.as_ref()?;
    let variable = format!("{}.{}", augment::instance(&instance(number), 0), through.name);
    Some(SensorSignal { name: format!("through_{number}"), variable, scale: 1.0 })
}

/// Name of a variable in the nominal model; `None` for one that the augmentation added.
fn of_plant(name: &str) -> Option<&str> {
    name.strip_prefix(PLANT)?.strip_prefix('.')
}

/// Identifier of a variable by its name.
pub fn variable(flat: &FlatModel, name: &str) -> Option<VarId> {
    let i = flat.variables.iter().position(|v| v.name == name)?;
    Some(VarId(u32::try_from(i).expect("fewer than 2^32 variables")))
}
