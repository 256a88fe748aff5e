//! Texts of numbers, remembered: rows repeat values, for most variables are equal to others up to the sign, and many
//! stand still. Making the fewest digits costs several times a look into this table.

use super::number;

/// Entries; a power of two.
const ENTRIES: usize = 1024;
/// The longest text of a number without its sign.
const LONGEST: usize = 23;

#[derive(Clone, Copy, Debug)]
struct Entry {
    bits: u64,
    len: u8,
    text: [u8; LONGEST],
}

/// The last texts of numbers, found by their bits.
#[derive(Clone, Debug)]
pub struct Texts {
    entries: Vec<Entry>,
    made: String,
}

impl Default for Texts {
    fn default() -> Self {
        let nothing = Entry { bits: f64::NAN.to_bits(), len: 0, text: [0; LONGEST] };
        Texts { entries: vec![nothing; ENTRIES], made: String::new() }
    }
}

impl Texts {
    /// Appends what [`number::push`] appends.
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
            self.made.clear();
            number::push(&mut self.made, value.abs());
            if self.made.len() > LONGEST {
                return out.extend_from_slice(self.made.as_bytes());
            }
            entry.bits = bits;
            entry.len = self.made.len() as u8;
            entry.text[..self.made.len()].copy_from_slice(self.made.as_bytes());
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
        fn as_without_memory(bits in prop::collection::vec(any::<u64>(), 1..50), picks in prop::collection::vec(any::<prop::sample::Index>(), 1..200)) {
            let mut texts = Texts::default();
            for pick in picks {
                let value = f64::from_bits(bits[pick.index(bits.len())]);
                for value in [value, -value, value.trunc(), 0.0, -0.0] {
                    let (mut plain, mut remembered) = (String::new(), Vec::new());
                    number::push(&mut plain, value);
                    texts.push(&mut remembered, value);
                    prop_assert_eq!(plain.as_bytes(), remembered);
                }
            }
        }
    }
}
