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
/// Left-out evidence by which the fit at the sensors' noise must beat the fit at the errors as they are, nats.
pub const OTHER_WEIGHTING: f64 = 3.0;
/// Tolerances beyond which a parameter is off: as much as one in four hundred parameters that are within theirs.
pub const BENT: f64 = 3.0;
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

/// Time that a search may take, s: what is not fitted then is named. Halved: on slow models fewer hypotheses are weighed.
pub const BUDGET: f64 = 60.0;
/// On a slow model as long as so many simulations of all recordings take, one after another: the fits of the model within its
/// tolerances and of some dozens of hypotheses. Halved: as above.
pub const RUNS: u32 = 500;
/// Part of the time that is left which one step may take.
pub const SHARE: f64 = 0.5;
/// Hypotheses that are fitted between two looks at the clock.
pub const ROUND: usize = 4;
/// Decades up and down over which the size of an effect is looked for, at most: what its class calls usual may be a
/// default in other units than the model's.
pub const DECADES: i32 = 12;
/// Sizes count that leave less than so many times what the model without the effect leaves.
pub const SCANNED: f64 = 100.0;
/// Sizes count with which a simulation takes at most so many times the steps that it takes without the effect: with others the
/// model chatters, or is too stiff for the time that a search has.
pub const SLOWER: usize = 16;
/// Part by which costs differ that are the same: there an effect is gone, or as strong as can be.
pub const UNCHANGED: f64 = 1e-3;
/// Sizes from which an effect is fitted.
pub const SIZES: usize = 2;
/// A hypothesis goes on where its first fits lower the mean square of a signal by this part: a quarter of what is worth a
/// name.
pub const HOPED: f64 = 0.05;
/// Iterations of a first fit from each start; the best goes on for as many.
pub const ROUGH: usize = 2;
/// Starts of a hypothesis that are tried before it is decided which ones are fitted first: by cost and by gap.
pub const TRIED: usize = 2;
/// Of those fitted, so many of the best are fitted again as if only the sensors' noise were left.
pub const FRONT: usize = 4;
/// Starts from which each hypothesis is fitted.
pub const STARTS: usize = 3;
/// Combinations of grid values that are tried as starts, at most.
pub const GRID: usize = 12;
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
/// Dampings of the step to the parameters without a fold, in parts of the diagonal, until one lands.
pub const DAMPINGS: [f64; 4] = [0.0, 0.3, 3.0, 30.0];
