//! Dimensions: products of powers of the seven base quantities of the SI.

/// Exponents are counted in sixtieths, so that square, cube, fourth, fifth and sixth roots are exact.
pub(super) const WHOLE: i16 = 60;

/// The base units, in the order in which they are printed.
const BASE: [&str; 7] = ["kg", "m", "s", "A", "K", "mol", "cd"];

/// Exponents of kilogram, metre, second, ampere, kelvin, mole and candela.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Dimension([i16; 7]);

/// Derived units worth naming in messages: exponents of kg, m, s, A, K.
const NAMED: [(&str, [i16; 5]); 16] = [
    ("N", [1, 1, -2, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0]),
    ("J", [1, 2, -2, 0, 0]),
    ("W", [1, 2, -3, 0, 0]),
    ("V", [1, 2, -3, -1, 0]),
    ("C", [0, 0, 1, 1, 0]),
    ("Ohm", [1, 2, -3, -2, 0]),
    ("F", [-1, -2, 4, 2, 0]),
    ("Wb", [1, 2, -2, -1, 0]),
    ("T", [1, 0, -2, -1, 0]),
    ("H", [1, 2, -2, -2, 0]),
    ("Pa.s", [1, -1, -1, 0, 0]),
    ("N/m", [1, 0, -2, 0, 0]),
    ("W/K", [1, 2, -3, 0, -1]),
    ("J/K", [1, 2, -2, 0, -1]),
    ("J/(kg.K)", [0, 2, -2, 0, -1]),
];

impl Dimension {
    /// No dimension.
    pub const NONE: Dimension = Dimension([0; 7]);
    /// Of time.
    pub const TIME: Dimension = Dimension::new([0, 0, 1, 0, 0, 0, 0]);

    /// From whole exponents of kg, m, s, A, K, mol, cd.
    pub const fn new(exponents: [i16; 7]) -> Self {
        let mut sixtieths = [0; 7];
        let mut i = 0;
        while i < 7 {
            sixtieths[i] = exponents[i] * WHOLE;
            i += 1;
        }
        Dimension(sixtieths)
    }

    /// Exponents of kg, m, s, A, K, mol, cd; `None` where one is not whole.
    pub fn whole(self) -> Option<[i16; 7]> {
        self.0.iter().all(|e| e % WHOLE == 0).then(|| self.0.map(|e| e / WHOLE))
    }

    /// True when all exponents are 0.
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// The dimension of a product; `None` when an exponent grows beyond all sense.
    pub fn times(self, other: Dimension) -> Option<Dimension> {
        self.each(other, i16::checked_add)
    }

    /// The dimension of a quotient.
    pub fn over(self, other: Dimension) -> Option<Dimension> {
        self.each(other, i16::checked_sub)
    }

    /// The dimension of a power; `None` when an exponent is not a multiple of 1/60.
    pub fn power(self, exponent: f64) -> Option<Dimension> {
        let mut result = [0; 7];
        for (to, from) in result.iter_mut().zip(self.0) {
            *to = power_of(from, exponent)?;
        }
        Some(Dimension(result))
    }

    fn each(self, other: Dimension, op: impl Fn(i16, i16) -> Option<i16>) -> Option<Dimension> {
        let mut result = [0; 7];
        for (to, (a, b)) in result.iter_mut().zip(self.0.into_iter().zip(other.0)) {
            *to = op(a, b)?;
        }
        Some(Dimension(result))
    }
}

/// An exponent in sixtieths, multiplied.
pub fn power_of(sixtieths: i16, exponent: f64) -> Option<i16> {
    let product = f64::from(sixtieths) * exponent;
    let whole = product.round();
    let fits = (product - whole).abs() < 1e-9 && whole.abs() <= f64::from(i16::MAX);
    #[allow(clippy::cast_possible_truncation, reason = "a whole number in the range of i16")]
    fits.then_some(whole as i16)
}

/// In coherent SI units, such as `Pa`, `m3/s` or `kg/(m.s)`.
impl std::fmt::Display for Dimension {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let named = NAMED.iter().find(|(_, e)| *self == Dimension::new([e[0], e[1], e[2], e[3], e[4], 0, 0]));
        match named {
            Some((name, _)) => f.write_str(name),
            None => f.write_str(&self.in_base_units()),
        }
    }
}

impl Dimension {
    fn in_base_units(self) -> String {
        let above: Vec<String> = self.factors(|e| e > 0).collect();
        let below: Vec<String> = self.factors(|e| e < 0).collect();
        let head = if above.is_empty() { "1".into() } else { above.join(".") };
        match below.as_slice() {
            [] => head,
            [one] => format!("{head}/{one}"),
            many => format!("{head}/({})", many.join(".")),
        }
    }

    fn factors(self, wanted: impl Fn(i16) -> bool) -> impl Iterator<Item = String> {
        let pairs = BASE.iter().zip(self.0).filter(move |&(_, exponent)| wanted(exponent));
        pairs.map(|(name, exponent)| match exponent.abs() {
            WHOLE => (*name).to_string(),
            e if e % WHOLE == 0 => format!("{name}{}", e / WHOLE),
            e => format!("{name}^{}", crate::print::number(f64::from(e) / f64::from(WHOLE), Some(4))),
        })
    }
}
