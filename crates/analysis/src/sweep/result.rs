//! Scalar results of a run: expressions such as `max(cyl.v)`, `settling(p, 0.05)` or `final(x) - initial(x)`.
//!
//! A text of the section `[sweep.results]` enters; a [`ResultExpression`] leaves, which [`ResultExpression::evaluate`]
//! applies to the rows of a run. The parser descends recursively: sum, product, power, factor.

use bramah_results::Trajectory;

/// A number computed from the trajectory of one variable.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TrajectoryMeasure {
    Max,
    Min,
    Mean,
    Rms,
    Initial,
    Final,
    Integral,
    TimeOfMax,
    TimeOfMin,
    /// Time from which on the variable stays within a share of its total change around its final value.
    Settling,
    /// How far it exceeds its final value, relative to its total change.
    Overshoot,
}

/// Names of the measures in expressions.
const QUESTIONS: &[(&str, TrajectoryMeasure)] = &[
    ("max", TrajectoryMeasure::Max),
    ("min", TrajectoryMeasure::Min),
    ("mean", TrajectoryMeasure::Mean),
    ("rms", TrajectoryMeasure::Rms),
    ("initial", TrajectoryMeasure::Initial),
    ("final", TrajectoryMeasure::Final),
    ("integral", TrajectoryMeasure::Integral),
    ("energy", TrajectoryMeasure::Integral),
    ("time_of_max", TrajectoryMeasure::TimeOfMax),
    ("time_of_min", TrajectoryMeasure::TimeOfMin),
    ("settling", TrajectoryMeasure::Settling),
    ("overshoot", TrajectoryMeasure::Overshoot),
];

/// An expression of measures.
#[derive(Clone, Debug, PartialEq)]
pub struct ResultExpression {
    /// The outermost operation.
    root: ResultTerm,
}

/// A node of the expression.
#[derive(Clone, Debug, PartialEq)]
enum ResultTerm {
    Number(f64),
    /// A measure of a variable; the number is the band of `Settling`.
    Ask(TrajectoryMeasure, String, f64),
    Abs(Box<ResultTerm>),
    /// Square root.
    Root(Box<ResultTerm>),
    /// A binary operation: `+ - * / ^`.
    Pair(char, Box<ResultTerm>, Box<ResultTerm>),
}

impl ResultExpression {
    /// Parses an expression.
    ///
    /// # Errors
    /// A sentence that says what is expected.
    pub fn parse(text: &str) -> Result<ResultExpression, String> {
        let mut parser = ResultParser { text, rest: text };
        let root = parser.sum(0)?;
        if parser.rest.trim().is_empty() { Ok(ResultExpression { root }) } else { Err(parser.unexpected()) }
    }

    /// Names of the variables it reads, each once.
    pub fn variables(&self) -> Vec<String> {
        let mut found = Vec::new();
        collect(&self.root, &mut found);
        found
    }

    /// Its value for the rows of a run; NaN where a variable was not recorded.
    pub fn evaluate(&self, run: &Trajectory) -> f64 {
        evaluate(&self.root, run)
    }
}

/// Adds the variables of a node to `found`.
fn collect(term: &ResultTerm, found: &mut Vec<String>) {
    match term {
        ResultTerm::Ask(_, name, _) if !found.contains(name) => found.push(name.clone()),
        ResultTerm::Number(_) | ResultTerm::Ask(..) => {}
        ResultTerm::Abs(a) | ResultTerm::Root(a) => collect(a, found),
        ResultTerm::Pair(_, a, b) => {
            collect(a, found);
            collect(b, found);
        }
    }
}

/// The value of a node.
fn evaluate(term: &ResultTerm, run: &Trajectory) -> f64 {
    match term {
        ResultTerm::Number(x) => *x,
        ResultTerm::Ask(question, name, band) => {
            run.column(name).map_or(f64::NAN, |values| answer(*question, &run.times, values, *band))
        }
        ResultTerm::Abs(a) => evaluate(a, run).abs(),
        ResultTerm::Root(a) => evaluate(a, run).sqrt(),
        ResultTerm::Pair(op, a, b) => {
            let (a, b) = (evaluate(a, run), evaluate(b, run));
            match op {
                '+' => a + b,
                '-' => a - b,
                '*' => a * b,
                '/' => a / b,
                _ => a.powf(b),
            }
        }
    }
}

/// A measure of a trajectory; NaN for one without rows.
fn answer(question: TrajectoryMeasure, times: &[f64], values: &[f64], band: f64) -> f64 {
    let (Some(&first), Some(&last)) = (values.first(), values.last()) else { return f64::NAN };
    let most = |sign: f64| (0..values.len()).max_by(|&a, &b| (sign * values[a]).total_cmp(&(sign * values[b])));
    let extreme = |sign: f64| most(sign).map_or(f64::NAN, |k| values[k]);
    let when = |sign: f64| {
        let best = extreme(sign);
        values.iter().position(|v| *v == best).map_or(f64::NAN, |k| times[k])
    };
    let duration = times[times.len() - 1] - times[0];
    match question {
        TrajectoryMeasure::Max => extreme(1.0),
        TrajectoryMeasure::Min => extreme(-1.0),
        TrajectoryMeasure::Initial => first,
        TrajectoryMeasure::Final => last,
        TrajectoryMeasure::Integral => integral(times, values, |v| v),
        TrajectoryMeasure::Mean => integral(times, values, |v| v) / duration,
        TrajectoryMeasure::Rms => (integral(times, values, |v| v * v) / duration).sqrt(),
        TrajectoryMeasure::TimeOfMax => when(1.0),
        TrajectoryMeasure::TimeOfMin => when(-1.0),
        TrajectoryMeasure::Settling => {
            let near = band * (last - first).abs();
            // The last row outside the band decides; the variable is settled from the row after it.
            let outside = values.iter().rposition(|v| (v - last).abs() > near);
            outside.map_or(0.0, |k| times[(k + 1).min(times.len() - 1)] - times[0])
        }
        TrajectoryMeasure::Overshoot => {
            // The extreme in the direction of the change; its sign cancels in the quotient.
            let change = last - first;
            (extreme(change.signum()) - last) / change
        }
    }
}

/// The integral by the trapezoidal rule. The two rows of an event have the same time and add nothing.
fn integral(times: &[f64], values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    let pairs = times.windows(2).zip(values.windows(2));
    pairs.map(|(t, v)| 0.5 * (t[1] - t[0]) * (of(v[0]) + of(v[1]))).sum()
}

/// A recursive descent parser over a text.
struct ResultParser<'a> {
    /// The whole text, for messages.
    text: &'a str,
    /// What is not parsed yet.
    rest: &'a str,
}

/// Largest depth of nesting, so that no text overflows the stack.
const DEEPEST: u32 = 50;

impl ResultParser<'_> {
    /// The message for a text that does not fit the grammar.
    fn unexpected(&self) -> String {
        let rest = self.rest.trim();
        let at = if rest.is_empty() { "its end" } else { rest };
        format!("the expression `{}` cannot be read from `{at}` on", self.text)
    }

    /// Skips a character, after blanks, where it comes next.
    fn eat(&mut self, c: char) -> bool {
        let found = self.rest.trim_start().strip_prefix(c);
        if let Some(rest) = found {
            self.rest = rest;
        }
        found.is_some()
    }

    /// Operations of equal precedence, from left to right.
    fn pairs(
        &mut self,
        ops: [char; 2],
        depth: u32,
        next: fn(&mut Self, u32) -> Result<ResultTerm, String>,
    ) -> Result<ResultTerm, String> {
        let mut left = next(self, depth)?;
        while let Some(op) = ops.into_iter().find(|&c| self.eat(c)) {
            left = ResultTerm::Pair(op, Box::new(left), Box::new(next(self, depth)?));
        }
        Ok(left)
    }

    /// sum = product {("+" | "-") product}
    fn sum(&mut self, depth: u32) -> Result<ResultTerm, String> {
        self.pairs(['+', '-'], depth, Self::product)
    }

    /// product = power {("*" | "/") power}
    fn product(&mut self, depth: u32) -> Result<ResultTerm, String> {
        self.pairs(['*', '/'], depth, Self::power)
    }

    /// power = factor ["^" factor]
    fn power(&mut self, depth: u32) -> Result<ResultTerm, String> {
        let base = self.factor(depth)?;
        if self.eat('^') { Ok(ResultTerm::Pair('^', Box::new(base), Box::new(self.factor(depth)?))) } else { Ok(base) }
    }

    /// factor = "-" power | "(" sum ")" | number | call
    fn factor(&mut self, depth: u32) -> Result<ResultTerm, String> {
        if depth > DEEPEST {
            return Err(format!("the expression `{}` is nested too deeply", self.text));
        }
        if self.eat('-') {
            return Ok(ResultTerm::Pair('-', Box::new(ResultTerm::Number(0.0)), Box::new(self.power(depth + 1)?)));
        }
        if self.eat('(') {
            let inner = self.sum(depth + 1)?;
            return if self.eat(')') { Ok(inner) } else { Err(self.unexpected()) };
        }
        self.rest = self.rest.trim_start();
        let is_number = self.rest.starts_with(|c: char| c.is_ascii_digit() || c == '.');
        if is_number { self.number() } else { self.call(depth) }
    }

    /// The longest prefix that is a number.
    fn number(&mut self) -> Result<ResultTerm, String> {
        let fits = |n: &usize| self.rest.is_char_boundary(*n) && self.rest[..*n].parse::<f64>().is_ok();
        let length = (1..=self.rest.len().min(40)).rev().find(fits).ok_or_else(|| self.unexpected())?;
        let (digits, rest) = self.rest.split_at(length);
        self.rest = rest;
        digits.trim().parse().map(ResultTerm::Number).map_err(|_| self.unexpected())
    }

    /// A measure of a variable, `abs` or `sqrt`. Names of variables may hold brackets and commas.
    fn call(&mut self, depth: u32) -> Result<ResultTerm, String> {
        let end = self.rest.find('(').ok_or_else(|| self.unexpected())?;
        let (name, rest) = (self.rest[..end].trim(), &self.rest[end + 1..]);
        if name == "abs" || name == "sqrt" {
            self.rest = rest;
            let inner = Box::new(self.sum(depth + 1)?);
            let closed = self.eat(')');
            let term = if name == "abs" { ResultTerm::Abs(inner) } else { ResultTerm::Root(inner) };
            return if closed { Ok(term) } else { Err(self.unexpected()) };
        }
        let Some((_, question)) = QUESTIONS.iter().find(|q| q.0 == name) else {
            let known: Vec<&str> = QUESTIONS.iter().map(|q| q.0).collect();
            return Err(format!("`{name}` is not known; known are {}, abs, sqrt", known.join(", ")));
        };
        let close = rest.find(')').ok_or_else(|| self.unexpected())?;
        let inside = &rest[..close];
        // A comma separates the band only where a number follows it, because `v[1,2]` holds a comma too.
        let band = inside.rsplit_once(',').and_then(|(v, b)| Some((v, b.trim().parse::<f64>().ok()?)));
        let (variable, band) = band.filter(|_| *question == TrajectoryMeasure::Settling).unwrap_or((inside, 0.05));
        if variable.trim().is_empty() {
            return Err(format!("`{name}` of which variable?"));
        }
        self.rest = &rest[close + 1..];
        Ok(ResultTerm::Ask(*question, variable.trim().to_owned(), band))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah_results::Signal;

    fn run() -> Trajectory {
        let mut t = Trajectory::new(vec![Signal::new("v[1,2].p"), Signal::new("x")]);
        for (time, p, x) in [(0.0, 0.0, 1.0), (1.0, 12.0, 1.0), (2.0, 9.0, 1.0), (3.0, 10.0, 1.0), (4.0, 10.0, 1.0)] {
            t.push(time, &[p, x]);
        }
        t
    }

    #[test]
    fn questions_and_arithmetic() {
        let value = |text: &str| ResultExpression::parse(text).expect(text).evaluate(&run());
        assert_eq!(value("max(v[1,2].p) - 2*final(v[1,2].p)/4"), 7.0);
        assert_eq!(value("overshoot(v[1,2].p)"), 0.2);
        assert_eq!(value("settling(v[1,2].p, 0.05)"), 3.0);
        assert_eq!(value("settling(v[1,2].p, 0.15)"), 2.0);
        assert_eq!(value("time_of_max(v[1,2].p)"), 1.0);
        assert_eq!((value("integral(x)"), value("mean(x)"), value("rms(x)")), (4.0, 1.0, 1.0));
        assert_eq!(value("-(1 + 1e0)^2 + abs(-min(x)) + sqrt(4)"), -1.0);
        assert!(value("max(unknown)").is_nan());
        assert_eq!(ResultExpression::parse("max(a.b) + min(a.b)").unwrap().variables(), ["a.b"]);
    }

    #[test]
    fn mistakes() {
        for bad in ["", "max", "max(", "max()", "foo(x)", "1 +", "(1", "1 2", "max(x))", "é"] {
            assert!(ResultExpression::parse(bad).is_err(), "{bad}");
        }
        assert!(ResultExpression::parse(&"(".repeat(10_000)).is_err());
    }
}
