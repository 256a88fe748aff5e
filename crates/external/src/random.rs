//! The random number generators of `ModelicaRandom`: Vigna's xorshift64*, xorshift128+ and xorshift1024*
//! (<https://prng.di.unimi.it>). They are pure functions: the state is an argument, and the next state an output.
//! A state is a list of 32-bit integers, the lower half of each 64-bit word first, as in `Modelica.Math.Random`.

use bramah_expr::function::ExternalFunction;
use std::sync::Arc;

/// A generator, which makes the next state and a number from a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RandomGenerator {
    /// xorshift64*, with a state of 2 integers.
    Star64,
    /// xorshift128+, with a state of 4 integers.
    Plus128,
    /// xorshift1024*, with a state of 33 integers, of which the last is the index of the current word.
    Star1024,
}

impl RandomGenerator {
    /// The number of integers of a state.
    #[cfg(test)]
    fn size(self) -> usize {
        match self {
            RandomGenerator::Star64 => 2,
            RandomGenerator::Plus128 => 4,
            RandomGenerator::Star1024 => 33,
        }
    }

    /// Replaces the state by the next one, and gives a number between 0 and 1.
    /// `state` must have 2, 4 or 33 integers.
    pub fn next(self, state: &mut [i32]) -> f64 {
        match self {
            RandomGenerator::Star64 => {
                let mut x = word(state, 0);
                x ^= x >> 12;
                x ^= x << 25;
                x ^= x >> 27;
                x = x.wrapping_mul(2_685_821_657_736_338_717);
                set_word(state, 0, x);
                number(x)
            }
            RandomGenerator::Plus128 => {
                let (mut a, b) = (word(state, 0), word(state, 1));
                a ^= a << 23;
                let sum = (a ^ b ^ (a >> 17) ^ (b >> 26)).wrapping_add(b);
                set_word(state, 0, b);
                set_word(state, 1, sum);
                number(sum)
            }
            RandomGenerator::Star1024 => {
                let at = usize::try_from(state[32] & 15).expect("four bits");
                let next = (at + 1) & 15;
                let (mut a, mut b) = (word(state, next), word(state, at));
                a ^= a << 31;
                a ^= a >> 11;
                b ^= b >> 30;
                set_word(state, next, a ^ b);
                state[32] = i32::try_from(next).expect("four bits");
                number((a ^ b).wrapping_mul(1_181_783_497_276_652_981))
            }
        }
    }
}

/// Word `k` of a state.
#[allow(clippy::cast_sign_loss, reason = "the bits count")]
fn word(state: &[i32], k: usize) -> u64 {
    u64::from(state[2 * k] as u32) | u64::from(state[2 * k + 1] as u32) << 32
}

/// Sets word `k` of a state.
#[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "the bits count")]
fn set_word(state: &mut [i32], k: usize, x: u64) {
    (state[2 * k], state[2 * k + 1]) = (x as u32 as i32, (x >> 32) as u32 as i32);
}

/// A number between 0 and 1 from 64 random bits, by the formula of `ModelicaRandom`.
#[allow(clippy::cast_possible_wrap, reason = "the bits count")]
fn number(x: u64) -> f64 {
    x as i64 as f64 * 2.0_f64.powi(-64) + 0.5
}

/// A generator as a function for equations: from the integers of a state to those of the next one, then the number.
#[derive(Debug)]
pub struct RandomDraw(pub RandomGenerator);

impl ExternalFunction for RandomDraw {
    // The integers come as numbers; out of range they wrap, as a conversion in C does.
    #[allow(clippy::cast_possible_truncation, reason = "integers of 32 bits")]
    fn value(&self, output: usize, args: &[f64]) -> f64 {
        let mut state: Vec<i32> = args.iter().map(|x| *x as i64 as i32).collect();
        let drawn = self.0.next(&mut state);
        state.get(output).map_or(drawn, |s| f64::from(*s))
    }

    fn partial(&self, _: usize) -> Option<Arc<dyn ExternalFunction>> {
        // Random numbers have no derivatives by their state.
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_spread_evenly_and_states_do_not_repeat() {
        for generator in [RandomGenerator::Star64, RandomGenerator::Plus128, RandomGenerator::Star1024] {
            let mut state: Vec<i32> = (0..generator.size()).map(|k| 17 * k as i32 + 5).collect();
            (0..100).for_each(|_| _ = generator.next(&mut state));
            let drawn: Vec<f64> = (0..10_000).map(|_| generator.next(&mut state)).collect();
            let mean = drawn.iter().sum::<f64>() / 1e4;
            let square = drawn.iter().map(|x| x * x).sum::<f64>() / 1e4;
            assert!(drawn.iter().all(|x| (0.0..=1.0).contains(x)), "{generator:?}");
            assert!((mean - 0.5).abs() < 0.01 && (square - 1.0 / 3.0).abs() < 0.01, "{generator:?} {mean} {square}");
        }
    }

    /// The first number of xorshift64* from the state 1, worked out with integers of any length.
    #[test]
    fn known_first_numbers() {
        let mut state = [1, 0];
        let x = RandomGenerator::Star64.next(&mut state);
        let by_hand = (1_u64 ^ 1 << 25).wrapping_mul(2_685_821_657_736_338_717);
        assert_eq!(word(&state, 0), by_hand);
        assert!((x - number(by_hand)).abs() < 1e-15);
    }
}
