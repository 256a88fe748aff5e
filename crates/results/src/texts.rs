//! Texts of numbers, remembered: rows repeat values, for most variables are equal to others up to the sign, and many
//! stand still. Making the fewest digits costs several times a look into this table.

use super::number;

/// Entries; a power of two.
const ENTRIES: usize = 1024;
/// The longest text of a number without its sign.
const LONGEST: usize = 23;

#[derive(Clone, Copy, Debug)]
struct TextCacheEntry {
    bits: u64,
    len: u8,
    text: [u8; LONGEST],
}

/// The last texts of numbers, found by their bits.
#[derive(Clone)]
pub struct NumberTextCache {
    entries: Vec<TextCacheEntry>,
    digits: ryu::Buffer,
}

impl Default for NumberTextCache {
    fn default() -> Self {
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
    /// Appends what [`super::number::push`] appends.
    pub fn push(&mut self, out: &mut Vec<u8>, value: f64) {
        if value.is_nan() {
            return;
        }
        if value == 0.0 {
            return out.push(b'0');
        }
        if value.is_sign_negative() {
            out.push(b'-');
        }
        let bits = value.abs().to_bits();
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
