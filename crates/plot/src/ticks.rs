//! Chooses ticks at round numbers for an axis. Used by all pictures with axes.

/// The ticks of an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AxisTicks {
    /// Value and text of each tick, ascending.
    pub marks: Vec<(f64, String)>,
    /// The texts are to be multiplied by ten to this power. The label of the axis states it.
    pub power: i32,
}

/// About `count` ticks at round numbers between `low` and `high`. An empty or infinite range has none.
///
/// The step is the next round number, so there may be fewer ticks.
pub(super) fn ticks(low: f64, high: f64, count: usize) -> AxisTicks {
    let range = high - low;
    if !range.is_finite() || range <= 0.0 {
        return AxisTicks { marks: Vec::new(), power: 0 };
    }
    let step = round_step(range / count.max(1) as f64);
    let power = common_power(low.abs().max(high.abs()));
    let unit = 10f64.powi(power);
    // As many decimals as the step needs. The small number corrects rounding of the logarithm.
    let decimals = usize::try_from(-((step / unit).log10() + 1e-9).floor() as i64).unwrap_or(0).min(15);
    // A tick that coincides with an end except for rounding belongs to the axis.
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    // At large offsets a step may vanish in rounding; the limit keeps the number of ticks finite.
    let number = (last - first).clamp(-1.0, 100.0) as i64 + 1;
    let marks = (0..number).map(|k| {
        let place = (first + k as f64) * step;
        let text = format!("{:.decimals$}", place / unit);
        // Rounding may give `-0.00`.
        (place, if text.trim_matches(['-', '0', '.']).is_empty() { "0".to_owned() } else { text })
    });
    AxisTicks { marks: marks.collect(), power }
}

/// The smallest number of the form 1, 2 or 5 times a power of ten that is not below `raw`.
fn round_step(raw: f64) -> f64 {
    let base = 10f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * base >= raw * (1.0 - 1e-9)).unwrap_or(10.0);
    factor * base
}

/// The power of ten that is taken out of the tick texts: a multiple of three, and 0 for magnitudes from 0.01 to 1e5.
fn common_power(largest: f64) -> i32 {
    if largest == 0.0 || (1e-2..1e5).contains(&largest) {
        return 0;
    }
    3 * ((largest.log10() / 3.0) + 1e-9).floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(low: f64, high: f64) -> (Vec<String>, i32) {
        let t = ticks(low, high, 5);
        (t.marks.into_iter().map(|m| m.1).collect(), t.power)
    }

    #[test]
    fn round_numbers() {
        assert_eq!(texts(0.0, 1.0).0, ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(-3.0, 211.0).0, ["0", "50", "100", "150", "200"]);
        assert_eq!(texts(0.0, 2.1e7), (["0", "5", "10", "15", "20"].map(str::to_owned).to_vec(), 6));
        assert_eq!(texts(0.0, 1e-6).1, -6);
        assert_eq!(texts(100.0, 100.001).0.len(), 6);
    }

    #[test]
    fn odd_ranges_end() {
        for (low, high) in
            [(0.0, 0.0), (1.0, 0.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (-1e308, 1e308), (0.0, 5e-324)]
        {
            assert!(ticks(low, high, 5).marks.len() < 110);
        }
        assert!(ticks(1e16, 1e16 + 4.0, 5).marks.len() < 110);
    }
}
