//! The constants of the method: value, unit, meaning, source, and what changes with the value.
//!
//! The first part decides which effects are accepted; the second part only bounds how far a search looks.
//! Method: `docs/gap_method.md`.

/// Probability that any false step is taken, for all hypotheses of a search together: a promise to the user.
/// At 0.05 effects that merely clip a peak are named.
pub const ALPHA: f64 = 0.01;
/// Part of a gap that is worth a name. Blocks whose gap is closed to this part do not count.
/// Halved: smaller effects are named, more of them false.
pub const DELTA: f64 = 0.10;
/// Two gaps count as equal if one exceeds the other by at most this part: the scatter between recordings of one kind.
/// Halved: smaller sets of indistinguishable effects, more often without the true one.
pub const NEAR: f64 = 0.25;
/// Gaps closer than this part of full scale count as equal: the class of a good sensor.
pub const ACCURACY: f64 = 2.5e-3;
/// Quantile of the t statistic beyond which a rival is surely worse (one-sided 0.6 %).
pub const SURE: f64 = 2.5;
/// Pieces into which each recording is cut for cross-validation.
pub const PIECES: usize = 6;
/// Blocks of all train recordings together over which models are compared.
/// They are longer than the correlation of the errors, and enough for a variance.
pub const BLOCKS: usize = 24;
/// Least number of recordings of which complete ones are left out too. With two, one half would predict the other.
pub const WHOLE_RECORDINGS: usize = 3;
/// Left-out evidence by which the fit at the sensors' noise must beat the fit with errors as they are, nats.
pub const OTHER_WEIGHTING: f64 = 3.0;
/// Distance from the data sheet in tolerances beyond which a parameter is off: one in four hundred by chance.
pub const BENT: f64 = 3.0;
/// Part by which a corrected model may leave more on held recordings than the nominal one.
pub const OPENS: f64 = 0.02;
/// Least error of a signal that counts, as part of full scale; smaller ones are rounding.
pub const LEAST: f64 = 1e-4;
/// Gain at usual size from which on the recordings count as able to show an effect, nats: what a search over some
/// dozens of hypotheses asks for.
pub const SEEN: f64 = 8.0;
/// Share of the hypotheses that the recordings must be able to show for a closed gap to mean that nothing is missing.
pub const VISIBLE: f64 = 0.2;
/// Most effects that are searched one after another.
pub const EFFECTS: usize = 4;

// The constants below say how far a search looks: with larger counts it takes longer and misses less.

/// Default time of a search, s. Hypotheses that were not fitted are listed in the verdict.
/// Halved: on slow models fewer hypotheses are fitted.
pub const BUDGET: f64 = 60.0;
/// Default time on a slow model, in simulations of all recordings one after another: enough for the fits of the model
/// within its tolerances and of some dozens of hypotheses. Halved: as [`BUDGET`].
pub const RUNS: u32 = 500;
/// Part of the remaining time that one step may take.
pub const SHARE: f64 = 0.5;
/// Hypotheses that are fitted between two checks of the clock.
pub const ROUND: usize = 4;
/// Most decades up and down over which the size of an effect is looked for. The typical size of its class may be a
/// default in other units than the model's.
pub const DECADES: i32 = 12;
/// A size counts if its cost is less than this multiple of the cost without the effect.
pub const SCANNED: f64 = 100.0;
/// A size counts if a simulation takes at most this multiple of the steps that it takes without the effect.
/// With others the model chatters, or is too stiff for the time of a search.
pub const SLOWER: usize = 16;
/// Relative difference up to which costs are the same: there an effect has vanished, or is as strong as it can be.
pub const UNCHANGED: f64 = 1e-3;
/// Sizes found over decades from which an effect is fitted.
pub const SIZES: usize = 2;
/// A hypothesis is fitted to the end if its first fits lower the mean square of a signal by this part, which is a
/// quarter of what is worth a name.
pub const HOPED: f64 = 0.05;
/// Iterations of a first fit from each start; the best fits go on for as many.
pub const ROUGH: usize = 2;
/// Starts of a hypothesis that are tried before the hypotheses are ordered anew: one by cost, one by gap.
pub const TRIED: usize = 2;
/// Number of best fitted hypotheses that are fitted again with the other weighting and free widths. Also the number of
/// alternatives that are reconsidered behind a second effect.
pub const FRONT: usize = 4;
/// Most starts of a hypothesis.
pub const STARTS: usize = 3;
/// Most combinations of grid values that are tried as starts.
pub const GRID: usize = 12;
/// Most times that a model is fitted again with the weights that it left.
pub const SETTLING: usize = 3;
/// Most iterations of a fit.
pub const ITERATIONS: usize = 24;
/// Most trials of one step, each more damped.
pub const TRIALS: usize = 6;
/// A fit ends with a step that gains less than this, in squared deviations, ...
pub const SETTLED: f64 = 0.5;
/// ... or less than this part of the cost, ...
pub const SETTLED_PART: f64 = 1e-4;
/// ... and lowers no signal's mean square by more than this part. No test asks for as little evidence or gap.
pub const SETTLED_SQUARE: f64 = 0.02;
/// Most doublings of an accepted step. Linear steps are short where a sensitivity falls as an effect grows.
pub const DOUBLINGS: usize = 4;
/// Dampings of the step to the parameters without a fold, in parts of the diagonal; tried in this order.
pub const DAMPINGS: [f64; 4] = [0.0, 0.3, 3.0, 30.0];

// --- Which variables an equation adds up ---

/// Values at which slopes of an equation are compared: a slope that is the same at both is taken for constant. Any two
/// numbers do that are neither 0 nor 1 and no multiples of each other.
pub const PROBE_POINTS: [f64; 2] = [0.3, 1.7];
/// Part by which the value of each further variable is larger, so that a product of two does not look like one of them.
pub const PROBE_SPREAD: f64 = 0.37;
/// Difference up to which slopes are the same: rounding of a few operations on numbers of order one.
pub const SAME_SLOPE: f64 = 1e-9;
