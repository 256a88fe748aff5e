//! The anchor: an extended Kalman filter over a lifted model with an Ornstein-Uhlenbeck source per place. Beside the
//! state it carries, for every free parameter, how the innovations depend on it; whitened innovations and columns give
//! the Gaussian evidence of any set of parameters (see `evidence`).
//!
//! Everything is linearised at the predicted state, not the filtered one, so that sources do not swallow an effect.
//! States, covariances and columns are in units of the states' sizes. States that nothing measured depends on
//! (those of effects at their off value) are carried along without covariance.

pub mod colour;
pub mod predict;

use super::begin;
use super::data::{Inputs, Recording};
use super::estimate::start::{KELVIN, TRAVEL, UNMEASURED};
use super::passive::{Passive, passive_states};
use super::step::{Exponential, add_outer, apply};
use crate::analysis::local::{Local, LocalError, Plan};
use colour::{Colour, Past};
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Stretches into which a recording is cut for statistics over blocks.
pub const BLOCKS: usize = 16;

/// Iterations of the first update at most, and the part of the states' sizes below which they have settled.
const FIRST: usize = 10;
const SETTLED: f64 = 1e-6;
/// Part of a pressure that nothing measures below which no correction takes it: where oil evaporates, the linear model of a
/// stiff volume says nothing of the void.
const LEAST_PRESSURE: f64 = 0.1;
/// A state of the nominal model is not known worse than by so many of its sizes, or times what is known of it at the start:
/// where the linear model runs away (a cavity that fills), the true state has long come to rest elsewhere.
const WORST_KNOWN: f64 = 10.0;
/// A variance may be below zero by rounding, by so much of the noise's.
const ROUNDING: f64 = 1e-6;
/// What drives the model beside its inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Which parameter of the plan it is.
    pub parameter: usize,
    /// Standard deviation, in the parameter's unit.
    pub level: f64,
    /// Correlation time, s.
    pub tau: f64,
}

/// Everything that a pass of the filter needs to know beside the data.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The model.
    pub plan: Arc<Plan>,
    /// Values of all parameters of the plan; those of sources are not read.
    pub theta: Vec<f64>,
    /// Parameters that act in one recording only, and its number: they are 0 in the others.
    pub own: Vec<(usize, usize)>,
    /// The sources.
    pub sources: Vec<Source>,
    /// Per signal the standard deviation of its noise.
    pub noise: Vec<f64>,
    /// Per signal the largest noise that its samples allow; misfit beyond is not noise.
    pub most_noise: Vec<f64>,
    /// Per signal, how its noise tells itself; none where it is white.
    pub colours: Vec<Colour>,
    /// Parameters whose columns are wanted.
    pub columns: Vec<usize>,
    /// How many of the first columns are wanted against all others; beyond, a column is wanted against these and its
    /// own group only.
    pub common: usize,
    /// Stretches of columns behind the common ones that are wanted against each other.
    pub groups: Vec<Range<usize>>,
    /// Per state its usual size, positive.
    pub sizes: Vec<f64>,
    /// Per state how far it usually moves, SI; 0 where that is not known.
    pub travel: Vec<f64>,
    /// Per recording, where steps are to be cut; found anew where nothing is said.
    pub cuts: Vec<Vec<bool>>,
    /// Per recording, the state it begins at; found anew where nothing is said.
    pub starts: Vec<Vec<f64>>,
}

/// Part of their levels at which sources do nothing.
pub const SILENT: f64 = 1e-6;

impl Setting {
    /// The same without columns, with white noise and without what is known of single recordings.
    pub fn alone(&self) -> Setting {
        let (columns, groups, colours, cuts, starts) = Default::default();
        Setting { columns, common: 0, groups, colours, cuts, starts, ..self.clone() }
    }

    /// The setting of one recording.
    pub fn of_recording(&self, number: usize) -> Cow<'_, Setting> {
        if self.own.iter().all(|own| own.1 == number) {
            return Cow::Borrowed(self);
        }
        let mut setting = self.clone();
        self.foreign(number).for_each(|p| setting.theta[p] = 0.0);
        Cow::Owned(setting)
    }

    /// Parameters that do not act in a recording.
    pub fn foreign(&self, number: usize) -> impl Iterator<Item = usize> {
        self.own.iter().filter(move |own| own.1 != number).map(|own| own.0)
    }

    /// The sources with their levels times a factor.
    pub fn sources_times(&self, factor: f64) -> Vec<Source> {
        self.sources.iter().map(|s| Source { level: s.level * factor, ..s.clone() }).collect()
    }
}

/// What a pass over one recording gave.
#[derive(Clone, Debug)]
pub struct Pass {
    /// Log likelihood of the samples.
    pub likelihood: f64,
    /// Gram matrix of the whitened columns, and last the whitened data.
    pub gram: DMatrix<f64>,
    /// Log likelihood of each block.
    pub blocks: Vec<f64>,
    /// Innovations over their deviations, samples by signals; 0 where there is no sample. Where noise has a colour, theirs
    /// is still in them.
    pub white: DMatrix<f64>,
    /// Linearised steps of the stretches asked for.
    pub tapes: Vec<Vec<Step>>,
    /// Samples after which the step was cut because the model bends.
    pub cut: Vec<bool>,
    /// State that the recording began at, SI.
    pub start: Vec<f64>,
    /// Filtered state at the last sample, SI.
    pub last: Vec<f64>,
}

/// A linearised step: from one sample to the next.
#[derive(Clone, Debug)]
pub struct Step {
    /// Behind the start of the recording: its samples count.
    pub counted: bool,
    /// Signals with a sample.
    pub here: Vec<usize>,
    /// Measured minus predicted output.
    pub innovation: DVector<f64>,
    /// d y / d z.
    pub output: DMatrix<f64>,
    /// What the filter added to the prediction.
    pub correction: DVector<f64>,
    /// d z next / d z.
    pub transition: DMatrix<f64>,
    /// Length, s.
    pub h: f64,
}

/// Which linearised steps a pass keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tape {
    /// None.
    Nothing,
    /// All.
    Whole,
    /// A few stretches spread over the recording, together a third of it: speeds and loads differ along it.
    Stretches,
}

/// Samples that stretches hold together at least, the part of the recording that they are, and how many there are.
const STRETCHED: usize = 1200;
const STRETCHED_PART: usize = 3;
const STRETCHES: usize = 4;

impl Tape {
    fn of(self, samples: usize) -> Vec<Range<usize>> {
        let kept = STRETCHED.max(samples / STRETCHED_PART);
        match self {
            Tape::Nothing => Vec::new(),
            Tape::Stretches if 2 * kept < samples => {
                let length = kept / STRETCHES;
                let start = |i: usize| i * (samples - length) / (STRETCHES - 1);
                (0..STRETCHES).map(|i| start(i)..start(i) + length).collect()
            }
            Tape::Whole | Tape::Stretches => std::iter::once(0..samples).collect(),
        }
    }
}

/// Runs the filter over the first `samples` of a recording, the `number`-th of those that `Setting::cuts` counts.
///
/// # Errors
/// When the model has no value on the way: the time, and why.
pub fn run(
    setting: &Setting,
    recording: &Recording,
    number: usize,
    samples: usize,
    tape: Tape,
) -> Result<Pass, (f64, LocalError)> {
    let (local, theta) = at_first(setting, recording, None).map_err(|e| (recording.times[0], e))?;
    let start = local.state();
    // looked at by a model of its own: where there is no value, the search for one leaves traces
    let (mut scout, _) = at_first(setting, recording, None).map_err(|e| (recording.times[0], e))?;
    let (hidden, reads) = passive_states(&mut scout, recording, &theta, &start, &setting.sizes);
    let start = match setting.starts.get(number) {
        Some(known) => known.clone(),
        None => begin::state(setting, recording, &start, &hidden, &reads),
    };
    let mut filter = Filter::new(setting, local, theta, start, recording, &hidden, &reads);
    filter.number = number;
    let samples = samples.min(recording.len());
    filter.stretches = tape.of(samples);
    for k in 0..samples {
        filter.sample(k, samples).map_err(|e| (recording.times[k], e))?;
    }
    Ok(filter.finish())
}

/// The model at the first sample of a recording, linearised at its own start or at another state, and the values of all
/// parameters, with silent sources.
pub(super) fn at_first(
    setting: &Setting,
    recording: &Recording,
    state: Option<&[f64]>,
) -> Result<(Local, Vec<f64>), LocalError> {
    let u = Inputs::new(recording).from;
    let t0 = recording.times[0];
    let mut theta = setting.theta.clone();
    setting.sources.iter().for_each(|s| theta[s.parameter] = 0.0);
    let mut local = Local::start(setting.plan.clone(), t0, &theta, &u)?;
    let own = local.state();
    local.linearize(t0, state.unwrap_or(&own), &theta, &u)?;
    Ok((local, theta))
}

/// Signals that have a sample, what was not expected of them, and how they depend on the states.
type Observed = (Vec<usize>, DVector<f64>, DMatrix<f64>);

pub(super) struct Filter<'a> {
    setting: &'a Setting,
    recording: &'a Recording,
    number: usize,
    /// Samples whose steps are kept.
    stretches: Vec<Range<usize>>,
    /// Samples before it estimate the state and count for nothing else.
    settled: usize,
    local: Local,
    /// Parameters with the sources' present values.
    theta: Vec<f64>,
    /// Inputs of the interval, and what they are within it.
    inputs: Inputs,
    between: Vec<f64>,
    /// States that are filtered, and states carried along.
    active: Vec<usize>,
    passive: Passive,
    x: Vec<f64>,
    /// Pressures of the nominal model among them that nothing measures.
    unseen: Vec<usize>,
    /// Active states and sources, scaled.
    z: DVector<f64>,
    /// Where the model had values last.
    safe: DVector<f64>,
    scale: DVector<f64>,
    p: DMatrix<f64>,
    /// Greatest variances of the active states; endless where nothing is known of how far they move.
    most: Vec<f64>,
    /// Transposed d z / d parameters wanted: a row for each of them, because there may be hundreds.
    s: DMatrix<f64>,
    work: Work,
    /// Per signal whose noise has a colour, the rows before.
    past: Vec<Past>,
    row: Vec<f64>,
    chunk: Vec<f64>,
    /// Parts of cut steps so far.
    parts: usize,
    block: f64,
    pass: Pass,
}

/// Matrices that are used again and again.
struct Work {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    exponential: Exponential,
    next_p: DMatrix<f64>,
    next_s: DMatrix<f64>,
    transposed: DMatrix<f64>,
    /// Transition over the whole interval between two samples.
    total: DMatrix<f64>,
}

impl<'a> Filter<'a> {
    pub(super) fn new(
        setting: &'a Setting,
        local: Local,
        theta: Vec<f64>,
        start: Vec<f64>,
        recording: &'a Recording,
        hidden: &[usize],
        reads: &DMatrix<bool>,
    ) -> Self {
        let passive = Passive::new(&local, hidden, reads);
        let active: Vec<usize> = (0..start.len()).filter(|i| !hidden.contains(i)).collect();
        let n = active.len();
        let nz = n + setting.sources.len();
        let mut scale = DVector::from_element(nz, 1.0);
        active.iter().enumerate().for_each(|(i, &x)| scale[i] = setting.sizes[x]);
        setting.sources.iter().enumerate().for_each(|(i, source)| scale[n + i] = source.level.max(1e-300));
        let mut z = DVector::zeros(nz);
        active.iter().enumerate().for_each(|(i, &x)| z[i] = start[x] / scale[i]);
        let mut p = DMatrix::identity(nz, nz);
        let mut unseen = Vec::new();
        for (i, &x) in active.iter().enumerate() {
            let measured = local.linear.c.column(x).iter().any(|c| *c != 0.0);
            if !measured && setting.travel[x] > 0.0 && local.plan().state_unit(x) == Some("Pa") {
                unseen.push(i);
            }
            let deviation = match local.plan().state_unit(x) {
                Some("K") => KELVIN / scale[i],
                _ if measured => 1.0,
                _ => UNMEASURED.max(TRAVEL * setting.travel[x] / scale[i]),
            };
            p[(i, i)] = deviation * deviation;
        }
        let worst = |(i, &x): (usize, &usize)| {
            let most = WORST_KNOWN.powi(2) * p[(i, i)].max(1.0);
            if setting.travel[x] > 0.0 { most } else { f64::INFINITY }
        };
        let most = active.iter().enumerate().map(worst).collect();
        let columns = setting.columns.len();
        let (samples, signals) = (recording.len(), setting.noise.len());
        let pass = Pass {
            likelihood: 0.0,
            gram: DMatrix::zeros(columns + 1, columns + 1),
            blocks: Vec::new(),
            white: DMatrix::zeros(samples, signals),
            tapes: Vec::new(),
            cut: vec![false; samples],
            start: start.clone(),
            last: Vec::new(),
        };
        Filter {
            setting,
            recording,
            number: 0,
            stretches: Vec::new(),
            settled: recording.settled(),
            local,
            theta,
            inputs: Inputs::new(recording),
            between: vec![0.0; recording.inputs.len()],
            active,
            unseen,
            passive,
            x: start,
            safe: z.clone(),
            z,
            scale,
            p,
            most,
            s: DMatrix::zeros(columns, nz),
            work: Work {
                a: DMatrix::zeros(nz, nz),
                b: DMatrix::zeros(columns, nz),
                exponential: Exponential::new(n, nz - n),
                next_p: DMatrix::zeros(nz, nz),
                next_s: DMatrix::zeros(columns, nz),
                transposed: DMatrix::zeros(nz, nz),
                total: DMatrix::zeros(nz, nz),
            },
            past: vec![Past::default(); setting.colours.len()],
            row: Vec::new(),
            chunk: Vec::new(),
            parts: 0,
            block: 0.0,
            pass,
        }
    }

    /// Puts the scaled state into `x` and the sources into `theta`; several sources of one place add up.
    fn load(&mut self) {
        let n = self.active.len();
        for (i, &x) in self.active.iter().enumerate() {
            self.x[x] = self.z[i] * self.scale[i];
        }
        self.setting.sources.iter().for_each(|s| self.theta[s.parameter] = 0.0);
        for (i, source) in self.setting.sources.iter().enumerate() {
            self.theta[source.parameter] += self.z[n + i] * self.scale[n + i];
        }
    }

    /// Takes the state before the first sample for the columns, and counts all samples; gives the variances of that state.
    pub(super) fn follow_start(&mut self) -> Vec<f64> {
        let (n, nz) = (self.active.len(), self.z.len());
        self.settled = 0;
        self.s = DMatrix::identity(n, nz);
        (self.work.b, self.work.next_s) = (DMatrix::zeros(n, nz), DMatrix::zeros(n, nz));
        self.pass.gram = DMatrix::zeros(n + 1, n + 1);
        (0..n).map(|i| self.p[(i, i)]).collect()
    }

    /// States that are filtered, by their numbers in the model.
    pub(super) fn states(&self) -> &[usize] {
        &self.active
    }

    /// Update with sample `k`, then prediction of the next.
    pub(super) fn sample(&mut self, k: usize, samples: usize) -> Result<(), LocalError> {
        let recording = self.recording;
        let t = recording.times[k];
        self.inputs.enter(recording, k);
        self.load();
        if self.local.linearize(t, &self.x, &self.theta, &self.inputs.from).is_err() {
            // with other inputs there may be no values there
            self.z.copy_from(&self.safe);
            self.load();
            self.local.linearize(t, &self.x, &self.theta, &self.inputs.from)?;
        }
        let before = self.z.clone();
        self.safe.copy_from(&before);
        let point = if k == 0 { self.first_point(t) } else { before };
        let (here, innovation, output) = self.update(k, &point)?;
        for &i in self.unseen.iter().filter(|&&i| point[i] > 0.0) {
            self.z[i] = self.z[i].max(LEAST_PRESSURE * point[i]);
        }
        let mut correction = &self.z - &point;
        if (k + 1) * BLOCKS / samples > k * BLOCKS / samples {
            self.close_block();
        }
        if k + 1 == samples {
            return Ok(());
        }
        let h = recording.times[k + 1] - t;
        self.predict(k, &mut correction, h);
        if let Some(stretch) = self.stretches.iter().find(|s| s.contains(&k)) {
            let transition = self.work.total.clone();
            if k == stretch.start {
                self.pass.tapes.push(Vec::with_capacity(stretch.len()));
            }
            self.pass.tapes.last_mut().expect("begun at its start").push(Step {
                counted: k >= self.settled,
                here,
                innovation,
                output,
                correction,
                transition,
                h,
            });
        }
        Ok(())
    }

    /// Where the model is linearised for the first sample: little is known of the state before, and outputs may bend on the
    /// way to what the sample says (flow over a root of pressure), so the update is iterated (Bell, Cathey, The iterated
    /// Kalman filter update as a Gauss-Newton method, 1993). The state itself stays the predicted one.
    fn first_point(&mut self, t: f64) -> DVector<f64> {
        let prior = self.z.clone();
        let mut point = prior.clone();
        for _ in 0..FIRST {
            let Some(next) = self.estimate(&prior, &point) else { break };
            self.z.copy_from(&next);
            self.load();
            if self.local.linearize(t, &self.x, &self.theta, &self.inputs.from).is_err() {
                self.z.copy_from(&point);
                self.load();
                // it had values there before
                let _ = self.local.linearize(t, &self.x, &self.theta, &self.inputs.from);
                break;
            }
            let moved = (&next - &point).amax();
            point = next;
            if moved < SETTLED {
                break;
            }
        }
        self.z = prior;
        point
    }

    /// The state that the first sample leads to, with the model linearised at `point`; sources stay where they are.
    fn estimate(&self, prior: &DVector<f64>, point: &DVector<f64>) -> Option<DVector<f64>> {
        let signals = &self.recording.signals;
        let here: Vec<usize> = (0..signals.len()).filter(|&i| signals[i][0].is_finite()).collect();
        let c = self.output(&here);
        let left = DVector::from_fn(here.len(), |row, _| signals[here[row]][0] - self.local.outputs[here[row]])
            - &c * (prior - point);
        let noise = |row: usize| self.setting.noise[here[row]].powi(2);
        let mut known = self.p.clone();
        (self.active.len()..self.z.len()).for_each(|j| known.column_mut(j).fill(0.0));
        let cp = &c * known;
        let mut variance = &cp * c.transpose();
        (0..here.len()).for_each(|row| variance[(row, row)] += noise(row));
        let next = prior + cp.transpose() * variance.lu().solve(&left)?;
        next.iter().all(|v| v.is_finite()).then_some(next)
    }

    /// d y / d z of the signals named.
    fn output(&self, here: &[usize]) -> DMatrix<f64> {
        let (n, linear) = (self.active.len(), &self.local.linear);
        DMatrix::from_fn(here.len(), self.z.len(), |row, j| {
            let slope = match self.active.get(j) {
                Some(&x) => linear.c[(here[row], x)],
                None => linear.d[(here[row], self.setting.sources[j - n].parameter)],
            };
            slope * self.scale[j]
        })
    }

    /// The measurement, one signal after the other (their noises are independent): innovations whitened, state,
    /// covariance and columns corrected. The model is linearised at `point`.
    fn update(&mut self, k: usize, point: &DVector<f64>) -> Result<Observed, LocalError> {
        let (nz, width, recording) = (self.z.len(), self.s.nrows(), self.recording);
        let signals = &recording.signals;
        let here: Vec<usize> = (0..signals.len()).filter(|&i| signals[i][k].is_finite()).collect();
        (0..self.past.len()).filter(|i| !here.contains(i)).for_each(|i| self.past[i].forget());
        let q = here.len();
        let innovation = DVector::from_fn(q, |row, _| signals[here[row]][k] - self.local.outputs[here[row]]);
        let c = self.output(&here);
        let mut pc = DVector::zeros(nz);
        let mut e = DVector::zeros(width);
        for (row, &i) in here.iter().enumerate() {
            let direction = c.row(row).transpose();
            apply(&mut pc, &self.p, &direction, 0.0);
            let (spread, noise) = (direction.dot(&pc), self.setting.noise[i] * self.setting.noise[i]);
            if spread < -ROUNDING * noise {
                // an undamped mode far faster than the samples: nothing is known of it any more
                return Err(LocalError::NonFinite);
            }
            let variance = spread + noise;
            let left = innovation[row] - direction.dot(&(&self.z - point));
            if !(variance > 0.0 && left.is_finite()) {
                continue;
            }
            let root = variance.sqrt();
            // how predicted outputs depend on the parameters; innovations do with the opposite sign
            let own = &self.local.linear.d;
            e.iter_mut().zip(&self.setting.columns).for_each(|(e, &j)| *e = own[(i, j)]);
            apply(&mut e, &self.s, &direction, 1.0);
            self.row.clear();
            self.row.extend(e.iter().map(|e| e / root));
            self.row.push(left / root);
            self.weigh(k, i, root);
            self.z.axpy(left / variance, &pc, 1.0);
            add_outer(&mut self.s, -1.0 / variance, e.as_slice(), pc.as_slice());
            add_outer(&mut self.p, -1.0 / variance, pc.as_slice(), pc.as_slice());
        }
        Ok((here, innovation, c))
    }

    /// Counts the row of a signal's sample, in units of a deviation.
    fn weigh(&mut self, k: usize, signal: usize, mut deviation: f64) {
        let counted = k >= self.settled;
        if counted {
            self.pass.white[(k, signal)] = self.row[self.row.len() - 1];
        }
        if let Some(colour) = self.setting.colours.get(signal) {
            if !self.past[signal].whiten(colour, &mut self.row) {
                return;
            }
            deviation *= colour.power.sqrt();
        }
        if counted {
            let left = self.row[self.row.len() - 1];
            let likelihood = -0.5 * left * left - deviation.ln() - 0.5 * (2.0 * std::f64::consts::PI).ln();
            self.pass.likelihood += likelihood;
            self.block += likelihood;
            self.chunk.append(&mut self.row);
        }
    }

    fn close_block(&mut self) {
        let width = self.s.nrows() + 1;
        let rows = DMatrix::from_row_slice(self.chunk.len() / width, width, &self.chunk);
        self.chunk.clear();
        let common = self.setting.common;
        let gram = &mut self.pass.gram;
        if common + 1 >= width {
            *gram += rows.tr_mul(&rows);
        } else {
            let mut wanted: Vec<usize> = (0..common).collect();
            wanted.push(width - 1);
            let left = rows.select_columns(&wanted);
            let part = left.tr_mul(&rows);
            for (i, &w) in wanted.iter().enumerate() {
                for j in 0..width {
                    gram[(w, j)] += part[(i, j)];
                    if j >= common && j + 1 < width {
                        gram[(j, w)] += part[(i, j)];
                    }
                }
            }
            for group in &self.setting.groups {
                let own = rows.columns(group.start, group.len());
                let part = own.tr_mul(&own);
                let mut target = gram.view_mut((group.start, group.start), (group.len(), group.len()));
                target += part;
            }
        }
        self.pass.blocks.push(self.block);
        self.block = 0.0;
    }

    pub(super) fn finish(mut self) -> Pass {
        self.load();
        self.pass.last = self.x;
        self.pass
    }
}
