//! The Fourier transform of a sampled signal, as `ModelicaFFT_kiss_fftr` gives it.

use bramah_expr::function::ExternalFunction;
use std::f64::consts::TAU;
use std::sync::Arc;

/// `info`, amplitudes and phases of samples in equal steps, or their derivatives by one of the samples.
///
/// Each output is worked out by itself from all samples, which costs their number squared in all: spectra are asked for at
/// the end of a run, once.
#[derive(Debug, Default)]
pub struct Spectrum {
    by: Option<usize>,
}

impl Spectrum {
    fn angle(samples: usize, frequency: usize, sample: usize) -> f64 {
        // the product may be large, and only its remainder counts
        TAU * ((frequency * sample) % samples) as f64 / samples as f64
    }
}

impl ExternalFunction for Spectrum {
    fn value(&self, output: usize, args: &[f64]) -> f64 {
        let n = args.len();
        let frequencies = n / 2 + 1;
        let Some(line) = output.checked_sub(1) else { return if n.is_multiple_of(2) { 0.0 } else { 1.0 } };
        let (phase, k) = (line >= frequencies, line % frequencies);
        let (mut re, mut im) = (0.0, 0.0);
        for (j, u) in args.iter().enumerate() {
            let angle = Self::angle(n, k, j);
            re += u * angle.cos();
            im -= u * angle.sin();
        }
        let size = re.hypot(im);
        let scale = 1.0 / frequencies as f64;
        match (self.by, phase) {
            (None, false) => size * scale,
            (None, true) => im.atan2(re),
            (Some(_), _) if size == 0.0 => 0.0,
            (Some(j), false) => {
                let angle = Self::angle(n, k, j);
                (re * angle.cos() - im * angle.sin()) / size * scale
            }
            (Some(j), true) => {
                let angle = Self::angle(n, k, j);
                (-re * angle.sin() - im * angle.cos()) / (size * size)
            }
        }
    }

    fn partial(&self, input: usize) -> Option<Arc<dyn ExternalFunction>> {
        // nothing that is solved needs curvatures of a spectrum
        self.by.is_none().then(|| Arc::new(Spectrum { by: Some(input) }) as Arc<dyn ExternalFunction>)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_has_one_line_and_derivatives_are_those_of_differences() {
        let n = 16;
        let samples: Vec<f64> = (0..n).map(|j| 0.5 + 2.0 * (TAU * 3.0 * f64::from(j) / f64::from(n)).sin()).collect();
        let spectrum = Spectrum::default();
        assert_eq!(spectrum.value(0, &samples), 0.0);
        let line = |k: usize| spectrum.value(1 + k, &samples) * 9.0 / 8.0;
        assert!((line(3) - 2.0).abs() < 1e-12 && line(2).abs() < 1e-12 && (line(0) - 1.0).abs() < 1e-12);
        assert!((spectrum.value(1 + 9 + 3, &samples) + TAU / 4.0).abs() < 1e-12);
        let partial = spectrum.partial(5).expect("depends on it");
        for output in [1, 4, 13] {
            let mut moved = [samples.clone(), samples.clone()];
            moved[0][5] -= 1e-6;
            moved[1][5] += 1e-6;
            let difference = (spectrum.value(output, &moved[1]) - spectrum.value(output, &moved[0])) / 2e-6;
            assert!((partial.value(output, &samples) - difference).abs() < 1e-8);
        }
    }
}
