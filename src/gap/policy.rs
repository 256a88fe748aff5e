//! The constants of the judge: value, unit, meaning, where the value comes from, what changes with it.

/// Probability that any false step is taken, all hypotheses of a search together; a promise to the user. At 0.05 effects
/// that merely clip a peak are named.
pub const ALPHA: f64 = 0.01;
/// Part of a gap that is worth a name. Blocks whose gap is closed to this part do not vote. Halved: smaller effects are
/// named, more of them false.
pub const DELTA: f64 = 0.10;
/// Two models are one for the user where one leaves at most this part more gap than the other: the scatter of gaps between
/// recordings of one kind. Halved: smaller sets, more often without the truth.
pub const NEAR: f64 = 0.25;
/// Gaps that are closer than this part of full scale are one: the class of a good sensor.
pub const ACCURACY: f64 = 2.5e-3;
/// Quantile of the t statistic beyond which a rival is surely worse (one-sided 0.6 %).
pub const SURE: f64 = 2.5;
/// Pieces into which each recording is cut to leave one out at a time.
pub const PIECES: usize = 6;
/// Blocks of all train recordings together over which models are compared: longer than what remains correlated, and
/// enough of them for a variance.
pub const BLOCKS: usize = 24;
/// Fewest recordings that are also left out as a whole, one at a time: with two, one half predicts the other.
pub const WHOLE_RECORDINGS: usize = 3;
/// Random flips of the blocks' signs: the standard error of a p-value of 0.01 is then 0.002.
pub const FLIPS: usize = 2000;
/// Autocorrelation below which errors count as independent; the sum over larger lags would be noise.
pub const UNCORRELATED: f64 = 0.05;
/// Left-out evidence by which the fit at the sensors' noise must beat the fit at the errors as they are, nats.
pub const OTHER_WEIGHTING: f64 = 3.0;
/// Part by which a corrected model may leave more of the held recordings than the nominal one.
pub const OPENS: f64 = 0.02;
/// Least mean square of a signal that counts, as part of full scale, squared: what is below is rounding.
pub const LEAST: f64 = 1e-4;
/// What an effect of usual size must gain for the recordings to count as able to show it, nats: as much as a search over
/// some dozens of hypotheses asks for.
pub const SEEN: f64 = 8.0;
/// Share of the hypotheses that recordings must be able to show for a closed gap to mean that nothing is missing.
pub const VISIBLE: f64 = 0.2;
/// Effects that are looked for one after another, at most.
pub const EFFECTS: usize = 4;

// The constants below say how far a search looks: with larger counts it takes longer and misses less.

/// Hypotheses with parameters that are fitted after the screen, half of them by each of its criteria.
pub const FITTED: usize = 14;
/// And without.
pub const FITTED_WITHOUT: usize = 2;
/// Times as many hypotheses as are fitted take a second step before.
pub const STEPPED: usize = 2;
/// Of those fitted, so many of the best are fitted again as if only the sensors' noise were left.
pub const FRONT: usize = 4;
/// Part of the least gain that is worth a name which a linear model must promise for a step: what bends comes to more.
pub const HOPED: f64 = 0.25;
/// Part of it which a step must show, or its linear model promise, for a fit: left-out data may see more of it.
pub const PROMISED: f64 = 0.5;
/// Starts from which each of them is fitted.
pub const STARTS: usize = 2;
/// Combinations of grid values that are tried as starts, at most.
pub const GRID: usize = 12;
/// Dampings of the screen's linear step, in parts of the diagonal: undamped it overshoots where an effect is large.
pub const DAMPINGS: [f64; 3] = [0.0, 0.3, 3.0];
/// Times that a model is fitted again with the weights that it left, at most.
pub const SETTLING: usize = 3;
/// Iterations of a fit at most.
pub const ITERATIONS: usize = 24;
/// Trials of a step, each more damped.
pub const TRIALS: usize = 6;
/// A fit ends with a step that gains less than so many squared deviations ...
pub const SETTLED: f64 = 0.5;
/// ... or than this part of the cost ...
pub const SETTLED_PART: f64 = 1e-4;
/// ... and lowers no signal's mean square by more than this part: no test asks for as little, of evidence or of a gap.
pub const SETTLED_SQUARE: f64 = 0.02;
/// Times that a step which gained is doubled at most: where a sensitivity falls as an effect grows, linear steps are short.
pub const DOUBLINGS: usize = 4;
