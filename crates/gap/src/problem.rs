//! What is diagnosed: the nominal model with its places, hypotheses, tolerances and recordings; and the models made of
//! it by attaching hypotheses and sources.

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

/// A state that moves over so many of its nominal sizes has one that nobody chose.
const DEFAULT: f64 = 10.0;
/// The unit in which a signal is spoken of: that of the study's column.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalDisplayUnit {
    /// The unit; empty where there is none.
    pub unit: String,
    /// Differences in SI units times this are differences in the unit.
    pub factor: f64,
}

impl SignalDisplayUnit {
    /// A difference in the unit.
    pub fn value(&self, si: f64) -> f64 {
        si * self.factor
    }
}

/// A parameter that may be off within its tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct ToleranceParameter {
    /// Full name in the nominal model.
    pub name: String,
    /// Its unit as written.
    pub unit: String,
    /// Value of the nominal model, SI.
    pub nominal: f64,
    /// One standard deviation, SI.
    pub sigma: f64,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// The study does not say it: assumed.
    pub assumed: bool,
    /// The study leaves it free: the nominal value says nothing, `sigma` is a size.
    pub free: bool,
}

/// The whole question.
pub struct DiagnosisProblem<'a> {
    /// Where classes come from.
    pub world: &'a dyn World,
    /// The nominal model.
    pub request: Request,
    /// The folder with effects of the user's own.
    pub folder: Option<PathBuf>,
    /// Places of the nominal model.
    pub circuit: CircuitTopology,
    /// All explanations.
    pub hypotheses: Vec<Hypothesis>,
    /// One source per node, command and sensor.
    pub disturbances: Vec<Hypothesis>,
    /// Measured signals.
    pub signals: Vec<SensorSignal>,
    /// Full scales of the signals, SI.
    pub full_scale: Vec<f64>,
    /// In which units the signals are spoken of.
    pub shown: Vec<SignalDisplayUnit>,
    /// Noise that the samples show, SI: an upper bound where signals move fast.
    pub noise_floor: Vec<f64>,
    /// Parameters with their tolerances.
    pub tolerances: Vec<ToleranceParameter>,
    /// Names of the train recordings, for messages alone.
    pub files: Vec<String>,
    /// Recordings to learn from.
    pub train: Vec<RecordingData>,
    /// How far states of the nominal model move over the recordings, by their names, SI; see [`DiagnosisProblem::explore`].
    pub travel: BTreeMap<String, f64>,
}

/// A model with hypotheses attached, ready to be evaluated.
#[derive(Clone, Debug)]
pub struct AssembledModel {
    /// Derivatives and all.
    pub plan: Arc<EvaluationPlan>,
    /// Value of each parameter of the plan.
    pub theta: Vec<f64>,
    /// Parameters of the plan that are tolerances, in their order: always the first ones.
    pub free: Range<usize>,
    /// Parameters of the plan that are sources, in the order of the disturbances asked for.
    pub sources: Range<usize>,
    /// Per attached hypothesis its coefficients and shapes.
    pub attached: Vec<Vec<usize>>,
    /// Parameters that act in one recording only, and its number.
    pub own: Vec<(usize, usize)>,
    /// Usual size of each state.
    pub sizes: Vec<f64>,
    /// What a step of a simulation may be corrected by, in parts of these sizes.
    pub correction: f64,
    /// How far each state moves in the nominal model, SI; 0 where that is not known.
    pub travel: Vec<f64>,
    /// The Modelica text.
    pub augmented: AugmentedModel,
}

impl AssembledModel {
    /// States of an effect through which a signal passes are as large as the signal.
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

/// A hypothesis with one choice of its shapes and values of its coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct HypothesisValues {
    /// Index into [`DiagnosisProblem::hypotheses`].
    pub hypothesis: usize,
    /// Values of coefficients, then of shapes.
    pub values: Vec<f64>,
}

impl DiagnosisProblem<'_> {
    /// Its recordings, to fit models to for so long.
    pub fn task<'b>(&'b self, until: Deadline<'b>) -> FitTask<'b> {
        FitTask { train: &self.train, full_scale: &self.full_scale, until }
    }

    /// The unit of a signal's variable, as written.
    pub fn unit(&self, signal: &SensorSignal) -> String {
        self.circuit.units.get(&signal.variable).cloned().unwrap_or_default()
    }

    /// Physical sources: those at nodes.
    pub fn node_sources(&self) -> Vec<usize> {
        let at_node = |d: &Hypothesis| matches!(d.attachments[0].site, AttachmentSite::Node(_));
        (0..self.disturbances.len()).filter(|&i| at_node(&self.disturbances[i])).collect()
    }

    /// Median time between samples, s; 0 without any.
    pub fn step(&self) -> f64 {
        let steps =
            |r: &RecordingData| r.times.windows(2).map(|w| w[1] - w[0]).filter(|h| *h > 0.0).collect::<Vec<f64>>();
        let mut steps: Vec<f64> = self.train.iter().flat_map(steps).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(0.0)
    }

    /// The nominal model with hypotheses and sources; coefficients and shapes of the hypotheses are free.
    ///
    /// # Errors
    /// The diagnostics of the compiler: a hypothesis that cannot be attached.
    pub fn assemble(&self, chosen: &[HypothesisValues], sources: &[usize]) -> Result<AssembledModel, Vec<Diagnostic>> {
        self.assembled(chosen, sources, chosen.len())
    }

    /// The same where only the first `shaped` hypotheses have free shapes: shapes that stand still cost less.
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

    /// Puts what the nominal model says of the signals into the train recordings; `None` where it does not reach the end.
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

    /// What the nominal model says of further variables over all train recordings, one after the other, from its own
    /// start; `None` where it does not reach the end.
    pub fn observe(&self, variables: &[SensorSignal]) -> Option<Vec<Vec<f64>>> {
        self.observe_with(&[], None, variables)
    }

    /// The same of a model with hypotheses, whose parameters within their tolerances are these, SI.
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

    /// Takes down how far the states of the nominal model move from its own start: what its author gave as their sizes
    /// may be a default.
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

    /// The flat model of an augmented text.
    fn flat(&self, augmented: &AugmentedModel) -> Result<FlatModel, Vec<Diagnostic>> {
        let (overlay, request) =
            augment::request(self.world, &self.request, self.folder.as_deref(), augmented, "Augmented");
        let outcome = bramah_model::compile::flatten(&overlay, &request);
        outcome.value.map(|f| f.flat).ok_or(outcome.diagnostics)
    }

    /// A choice as the augmenter takes it.
    pub fn attached(&self, chosen: &HypothesisValues, name: &str) -> HypothesisInstance<'_> {
        let hypothesis = &self.hypotheses[chosen.hypothesis];
        let coefficients = hypothesis.coefficients.iter().map(super::effects::EffectCoefficient::label);
        let names = coefficients.chain(hypothesis.shapes.iter().map(|s| s.name.clone()));
        let values = names.zip(chosen.values.iter().copied()).collect();
        HypothesisInstance { name: name.into(), hypothesis, values }
    }

    /// `counts`: how many of the parameters of each hypothesis are free.
    fn lifted(
        &self,
        flat: FlatModel,
        augmented: AugmentedModel,
        counts: &[usize],
    ) -> Result<AssembledModel, Vec<Diagnostic>> {
        let mut ids: Vec<VarId> = Vec::new();
        let mut add = |name: &str| -> Option<usize> {
            let v = variable(&flat, name)?;
            // a parameter may stand in several places of the list
            Some(ids.iter().position(|x| *x == v).unwrap_or_else(|| {
                ids.push(v);
                ids.len() - 1
            }))
        };
        for t in &self.tolerances {
            add(&format!("{PLANT}.{}", t.name));
        }
        let free = 0..self.tolerances.len();
        let mut sources = Vec::new();
        let mut attached = Vec::new();
        let (effect_names, source_names) = augmented.parameters.split_at(counts.len());
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
            // laws repeat over a turn
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

/// The name of a chosen hypothesis among the parameters and instances of a model.
fn instance(number: usize) -> String {
    format!("e{number}")
}

/// What flows through the first instance of a chosen hypothesis, SI; nothing where it is a signal or a parameter.
pub fn through(number: usize, hypothesis: &Hypothesis) -> Option<SensorSignal> {
    let effect = hypothesis.attachments[0].effect.as_ref()?;
    let through = effect.interface.through.as_ref()?;
    let variable = format!("{}.{}", augment::instance(&instance(number), 0), through.name);
    Some(SensorSignal { name: format!("through_{number}"), variable, scale: 1.0 })
}

/// The name that a variable of the nominal model has there.
fn of_plant(name: &str) -> Option<&str> {
    name.strip_prefix(PLANT)?.strip_prefix('.')
}

/// A variable by its name.
pub fn variable(flat: &FlatModel, name: &str) -> Option<VarId> {
    let i = flat.variables.iter().position(|v| v.name == name)?;
    Some(VarId(u32::try_from(i).expect("fewer than 2^32 variables")))
}
