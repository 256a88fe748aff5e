//! A cache of numbers as text, for writing many rows.
//! Rows repeat values: many variables are equal to others up to the sign, and many do not change. Finding the fewest
//! digits of a number takes several times as long as a look into the cache.

use super::number;

/// The number of entries. A power of two, so that the remainder is a mask.
const ENTRIES: usize = 1024;
/// The largest length in bytes of a number without its sign.
const LONGEST: usize = 23;

/// One number and its text.
#[derive(Clone, Copy, Debug)]
struct TextCacheEntry {
    /// The bits of the number without its sign.
    bits: u64,
    /// The length of the text in bytes.
    len: u8,
    /// The text, followed by unused bytes.
    text: [u8; LONGEST],
}

/// A direct-mapped cache: each number has one place, where it replaces what was there.
#[derive(Clone)]
pub struct NumberTextCache {
    /// One entry for each place.
    entries: Vec<TextCacheEntry>,
    /// The buffer in which digits are made.
    digits: ryu::Buffer,
}

impl Default for NumberTextCache {
    fn default() -> Self {
        // NaN is never looked up, so these entries match nothing.
        let nothing = TextCacheEntry { bits: f64::NAN.to_bits(), len: 0, text: [0; LONGEST] };
        NumberTextCache { entries: vec![nothing; ENTRIES], digits: ryu::Buffer::new() }
    }
}

impl std::fmt::Debug for NumberTextCache {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Texts")
    }
}

impl NumberTextCache {
    /// Appends the same text as [`super::number::push`].
    pub fn push(&mut self, out: &mut Vec<u8>, value: f64) {
        if value.is_nan() {
            return;
        }
        if value == 0.0 {
            return out.push(b'0');
        }
        // The sign is written apart, so that a number and its negative share an entry.
        if value.is_sign_negative() {
            out.push(b'-');
        }
        let bits = value.abs().to_bits();
        // A multiplicative hash. Its high bits depend on all bits of the number.
        let place = (bits.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 54) as usize % ENTRIES;
        let entry = &mut self.entries[place];
        if entry.bits != bits {
            let made = number::digits(&mut self.digits, value.abs()).as_bytes();
            if made.len() > LONGEST {
                return out.extend_from_slice(made);
            }
            entry.bits = bits;
            entry.len = made.len() as u8;
            entry.text[..made.len()].copy_from_slice(made);
        }
        out.extend_from_slice(&entry.text[..usize::from(entry.len)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn as_without_memory(bits in prop::collection::vec(any::<u64>(), 1..50)) {
            let mut texts = NumberTextCache::default();
            for &bits in bits.iter().chain(bits.iter().rev()) {
                let usual = (bits >> 20) as f64 * 10.0_f64.powi((bits % 40) as i32 - 30);
                let value = f64::from_bits(bits);
                for value in [value, -value, usual, -usual, usual.trunc(), value.trunc(), 0.0, -0.0, f64::INFINITY] {
                    let (mut plain, mut remembered) = (String::new(), Vec::new());
                    number::push(&mut plain, value);
                    texts.push(&mut remembered, value);
                    prop_assert_eq!(plain.as_bytes(), remembered);
                }
            }
        }
    }
}
