//! The Fourier transform of a sampled signal, as `ModelicaFFT_kiss_fftr` of the Modelica Standard Library gives it.
//! Samples enter as arguments; the error flag, amplitudes and phases leave as outputs.

use bramah_expr::function::ExternalFunction;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The spectrum of samples at equal intervals, or its derivatives by one of the samples.
/// Outputs for n samples: `info` (0, or 1 if n is odd), then n/2+1 amplitudes, then as many phases (rad).
///
/// Each output is computed on its own from all samples, so all of them cost of the order of n squared operations.
/// A spectrum is computed once, at the end of a run, so a fast transform is not needed.
#[derive(Debug, Default)]
pub struct Spectrum {
    /// The sample of the derivative. `None` for the spectrum itself.
    by: Option<usize>,
}

impl Spectrum {
    /// The angle of a frequency at a sample (rad).
    fn angle(samples: usize, frequency: usize, sample: usize) -> f64 {
        // Only the remainder of the product counts; reducing it keeps the angle exact.
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
        // The scaling of `ModelicaFFT_kiss_fftr`.
        let scale = 1.0 / frequencies as f64;
        match (self.by, phase) {
            (None, false) => size * scale,
            (None, true) => im.atan2(re),
            // The amplitude of a vanishing line has no derivative; 0 is taken.
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
        // No solver needs second derivatives of a spectrum.
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
