//! Samples of a sweep: the parameter values of each run.
//!
//! A [`ParameterSweep`] and its parameters enter; a matrix of values leaves, one row for each run. Random methods draw
//! points of the unit cube, which the quantile functions of the parameters map to values.

use super::sobol;
use crate::experiment::{ParameterSweep, ParameterVariation, SamplingMethod};
use crate::grid;
use crate::study::Amount;
use statrs::function::erf::erfc_inv;
use std::f64::consts::SQRT_2;

/// A parameter that varies.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepParameter {
    /// Its name.
    pub name: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// Its value in the model.
    pub value: f64,
    /// How it varies.
    pub spread: ParameterVariation,
}

/// Pseudo-random numbers between 0 and 1. Source: S. Vigna, xorshift64* (2016).
#[derive(Clone, Debug)]
pub struct XorshiftGenerator(u64);

impl XorshiftGenerator {
    /// A generator; the same seed gives the same numbers.
    pub fn new(seed: u64) -> XorshiftGenerator {
        // Multiplication separates neighbouring seeds; `| 1` avoids zero, at which the generator would stay.
        XorshiftGenerator((seed ^ 0x9E37_79B9_7F4A_7C15).wrapping_mul(0xBF58_476D_1CE4_E5B9) | 1)
    }

    /// The next number, greater than 0 and less than 1.
    pub fn roll(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let high = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 12;
        (high as f64 + 0.5) / (1u64 << 52) as f64
    }

    /// A random integer from 0 to n - 1.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.roll() * n as f64) as usize).min(n - 1)
    }
}

/// Parameter values of all runs, one row for each run.
///
/// # Errors
/// A sentence about the parameter whose variation does not fit the method.
pub fn samples(sweep: &ParameterSweep, varied: &[SweepParameter]) -> Result<Vec<Vec<f64>>, String> {
    match sweep.method {
        SamplingMethod::Grid => Ok(products(&lists(varied)?)),
        SamplingMethod::List => zipped(&lists(varied)?, varied),
        _ => {
            let unit = unit_cube(sweep, varied.len())?;
            let map: Vec<QuantileFunction> = varied.iter().map(QuantileFunction::new).collect::<Result<_, _>>()?;
            Ok(unit.into_iter().map(|row| row.iter().zip(&map).map(|(p, m)| m.at(*p)).collect()).collect())
        }
    }
}

/// The list of values of each parameter, in its unit.
fn lists(varied: &[SweepParameter]) -> Result<Vec<Vec<f64>>, String> {
    let list = |v: &SweepParameter| match &v.spread {
        ParameterVariation::Values(text) => grid::values(text, &v.unit).map_err(|e| format!("`{}`: {e}", v.name)),
        _ => Err(format!("`{}`: a grid or list needs values, such as `1,2,5` or `0:10:11`", v.name)),
    };
    varied.iter().map(list).collect()
}

/// All combinations; the last parameter changes fastest.
fn products(lists: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut all = vec![Vec::new()];
    for list in lists {
        all = all.iter().flat_map(|head: &Vec<f64>| list.iter().map(|v| [head.as_slice(), &[*v]].concat())).collect();
    }
    all
}

/// Row i holds value i of each parameter.
fn zipped(lists: &[Vec<f64>], varied: &[SweepParameter]) -> Result<Vec<Vec<f64>>, String> {
    let count = lists.first().map_or(0, Vec::len);
    if let Some(k) = lists.iter().position(|l| l.len() != count) {
        let (name, n) = (&varied[k].name, lists[k].len());
        return Err(format!("`{name}` has {n} values, `{}` has {count}: a list needs as many of each", varied[0].name));
    }
    Ok((0..count).map(|i| lists.iter().map(|l| l[i]).collect()).collect())
}

/// Points of the unit cube with one coordinate for each parameter.
fn unit_cube(sweep: &ParameterSweep, directions: usize) -> Result<Vec<Vec<f64>>, String> {
    let mut random = XorshiftGenerator::new(sweep.seed);
    Ok(match sweep.method {
        SamplingMethod::LatinHypercube => latin_hypercube(sweep.count, directions, &mut random),
        SamplingMethod::Sobol => sobol::design(sweep.count, directions)?,
        _ => (0..sweep.count).map(|_| (0..directions).map(|_| random.roll()).collect()).collect(),
    })
}

/// Latin hypercube: for each parameter one sample in each of `count` equal intervals, in random order.
fn latin_hypercube(count: usize, directions: usize, random: &mut XorshiftGenerator) -> Vec<Vec<f64>> {
    let mut rows = vec![vec![0.0; directions]; count];
    for j in 0..directions {
        let mut order: Vec<usize> = (0..count).collect();
        for i in (1..count).rev() {
            order.swap(i, random.below(i + 1));
        }
        for (row, part) in rows.iter_mut().zip(order) {
            row[j] = (part as f64 + random.roll()) / count as f64;
        }
    }
    rows
}

/// Maps a probability between 0 and 1 to a value in the parameter's unit.
enum QuantileFunction {
    /// Uniform between two values.
    Even(f64, f64),
    /// Uniform in the logarithm; holds the logarithms of both ends.
    Logarithmic(f64, f64),
    /// Mean and standard deviation.
    Normal(f64, f64),
    /// Median, and standard deviation of the logarithm.
    LogNormal(f64, f64),
}

impl QuantileFunction {
    /// The quantile function of a parameter's variation.
    fn new(v: &SweepParameter) -> Result<QuantileFunction, String> {
        let message = |e: String| format!("`{}`: {e}", v.name);
        let amount = |text: &str| Amount::parse(text).map_err(message);
        match &v.spread {
            ParameterVariation::Range { min, max, logarithmic } => {
                let value = |t: &str| amount(t)?.in_unit(&v.unit, v.value).map_err(message);
                let (low, high) = (value(min)?, value(max)?);
                if low >= high || (*logarithmic && low <= 0.0) {
                    return Err(message(
                        "`min` must lie below `max`, and above zero for a logarithmic range".to_owned(),
                    ));
                }
                Ok(if *logarithmic {
                    QuantileFunction::Logarithmic(low.ln(), high.ln())
                } else {
                    QuantileFunction::Even(low, high)
                })
            }
            ParameterVariation::Sigma(text) => match amount(text)? {
                Amount::Part(part) if v.value > 0.0 => Ok(QuantileFunction::LogNormal(v.value, part)),
                other => Ok(QuantileFunction::Normal(
                    v.value,
                    other.difference_in_unit(&v.unit, v.value.abs()).map_err(message)?,
                )),
            },
            ParameterVariation::Values(_) => Err(message("samples need `min` and `max`, or `sigma`".to_owned())),
        }
    }

    /// The value at a probability.
    fn at(&self, share: f64) -> f64 {
        match *self {
            QuantileFunction::Even(low, high) => low + share * (high - low),
            QuantileFunction::Logarithmic(low, high) => (low + share * (high - low)).exp(),
            QuantileFunction::Normal(mean, sigma) => mean + sigma * quantile(share),
            QuantileFunction::LogNormal(median, part) => median * (part * quantile(share)).exp(),
        }
    }
}

/// The quantile of the standard normal distribution, about 8 deviations at most.
pub fn quantile(share: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * share.clamp(1e-15, 1.0 - 1e-15))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn varied(spreads: &[ParameterVariation]) -> Vec<SweepParameter> {
        let one = |(k, s): (usize, &ParameterVariation)| SweepParameter {
            name: format!("p{k}"),
            unit: "Pa".into(),
            value: 2e5,
            spread: s.clone(),
        };
        spreads.iter().enumerate().map(one).collect()
    }

    fn values(text: &str) -> ParameterVariation {
        ParameterVariation::Values(text.into())
    }

    fn range(min: &str, max: &str) -> ParameterVariation {
        ParameterVariation::Range { min: min.into(), max: max.into(), logarithmic: false }
    }

    fn sweep(method: SamplingMethod, count: usize) -> ParameterSweep {
        ParameterSweep { method, count, seed: 7, ..ParameterSweep::default() }
    }

    #[test]
    fn grids_and_lists() {
        let two = varied(&[values("1,2 bar"), values("0:4:3")]);
        let grid = samples(&sweep(SamplingMethod::Grid, 0), &two).unwrap();
        assert_eq!((grid.len(), grid[1].as_slice()), (6, [1e5, 2.0].as_slice()));
        assert!(samples(&sweep(SamplingMethod::List, 0), &two).unwrap_err().contains("has 3 values"));
        let list = samples(&sweep(SamplingMethod::List, 0), &varied(&[values("1,2"), values("3,4")])).unwrap();
        assert_eq!(list, [[1.0, 3.0], [2.0, 4.0]]);
        assert!(samples(&sweep(SamplingMethod::Grid, 0), &varied(&[range("1", "2")])).is_err());
    }

    #[test]
    fn a_latin_hypercube_has_one_sample_in_each_part() {
        let rows =
            samples(&sweep(SamplingMethod::LatinHypercube, 20), &varied(&[range("0", "20"), range("1 bar", "2 bar")]));
        let mut parts: Vec<usize> = rows.unwrap().iter().map(|r| r[0] as usize).collect();
        parts.sort_unstable();
        assert_eq!(parts, (0..20).collect::<Vec<_>>());
    }

    #[test]
    fn tolerances_are_normal_and_log_normal() {
        let rows =
            samples(&sweep(SamplingMethod::MonteCarlo, 4000), &varied(&[ParameterVariation::Sigma("10 %".into())]))
                .unwrap();
        let logs: Vec<f64> = rows.iter().map(|r| (r[0] / 2e5).ln()).collect();
        let mean = logs.iter().sum::<f64>() / 4000.0;
        let spread = (logs.iter().map(|l| l * l).sum::<f64>() / 4000.0).sqrt();
        assert!(mean.abs() < 0.006 && (spread - 0.1).abs() < 0.005, "{mean} {spread}");
        let rows =
            samples(&sweep(SamplingMethod::MonteCarlo, 100), &varied(&[ParameterVariation::Sigma("0.1 bar".into())]))
                .unwrap();
        assert!(rows.iter().all(|r| (r[0] - 2e5).abs() < 5e4));
    }

    #[test]
    fn quantiles() {
        for (p, x) in [(0.5, 0.0), (0.975, 1.959_963_985), (0.001, -3.090_232_306), (1e-8, -5.612_001_244)] {
            assert!((quantile(p) - x).abs() < 1e-8, "{p}: {}", quantile(p));
        }
    }
}
