//! Small flat models for tests, written as text.

use crate::flat::*;
use bramah_expr::{ExprId, ExprNode, Exprs, RelationalOp, UnaryFunction, VarId};
use bramah_syntax::diag::{FileId, Span};

/// A flat model under construction. Names in expressions must be declared before.
pub struct Model {
    pub flat: FlatModel,
}

fn origin(instance: u32, kind: OriginKind) -> ElementOrigin {
    ElementOrigin { span: Span { file: FileId(0), start: 0, end: 0 }, instance, kind }
}

impl Model {
    pub fn new() -> Self {
        let mut flat = FlatModel { class: "Test".into(), ..FlatModel::default() };
        let span = Span { file: FileId(0), start: 0, end: 0 };
        flat.instances.push(InstanceInfo { name: String::new(), class: "Test".into(), parent: 0, span });
        Model { flat }
    }

    /// A component or connector; its variables are those whose names start with it.
    pub fn instance(&mut self, name: &str, class: &str) -> &mut Self {
        let parent = name.rsplit_once('.').map_or(0, |(outer, _)| self.instance_named(outer));
        let span = Span { file: FileId(0), start: 0, end: 0 };
        self.flat.instances.push(InstanceInfo { name: name.into(), class: class.into(), parent, span });
        self
    }

    fn instance_named(&self, name: &str) -> u32 {
        self.flat.instances.iter().position(|i| i.name == name).unwrap_or(0) as u32
    }

    fn declare(&mut self, name: &str, ty: ScalarType, variability: Variability) -> VarId {
        let instance = name.rsplit_once('.').map_or(0, |(outer, _)| self.instance_named(outer));
        self.flat.variables.push(FlatVariable {
            fixed: variability <= Variability::Parameter,
            ..FlatVariable::plain(name, ty, variability, origin(instance, OriginKind::Declared))
        });
        VarId(self.flat.variables.len() as u32 - 1)
    }

    /// Real variables.
    pub fn reals(&mut self, names: &str) -> &mut Self {
        for name in names.split_whitespace() {
            self.declare(name, ScalarType::Real, Variability::Continuous);
        }
        self
    }

    pub fn flows(&mut self, names: &str) -> &mut Self {
        for name in names.split_whitespace() {
            let v = self.declare(name, ScalarType::Real, Variability::Continuous);
            self.flat.variables[v.index()].flow = true;
        }
        self
    }

    pub fn booleans(&mut self, names: &str) -> &mut Self {
        for name in names.split_whitespace() {
            self.declare(name, ScalarType::Boolean, Variability::Discrete);
        }
        self
    }

    pub fn integers(&mut self, names: &str) -> &mut Self {
        for name in names.split_whitespace() {
            self.declare(name, ScalarType::Integer, Variability::Discrete);
        }
        self
    }

    pub fn discretes(&mut self, names: &str) -> &mut Self {
        for name in names.split_whitespace() {
            self.declare(name, ScalarType::Real, Variability::Discrete);
        }
        self
    }

    pub fn inputs(&mut self, names: &str) -> &mut Self {
        for name in names.split_whitespace() {
            let v = self.declare(name, ScalarType::Real, Variability::Continuous);
            self.flat.variables[v.index()].input = true;
        }
        self
    }

    /// `name = expression` for each parameter.
    pub fn parameters(&mut self, bindings: &str) -> &mut Self {
        let bindings: Vec<(&str, &str)> = pieces(bindings).map(|b| b.split_once('=').expect("a binding")).collect();
        for (name, _) in &bindings {
            self.declare(name.trim(), ScalarType::Real, Variability::Parameter);
        }
        for (name, value) in &bindings {
            let value = self.expr(value);
            let v = self.id(name.trim());
            self.flat.variables[v.index()].binding = Some(value);
        }
        self
    }

    /// `name = value`: fixed start values.
    pub fn fixed(&mut self, starts: &str) -> &mut Self {
        self.starts(starts, true)
    }

    /// `name = value`: start values that are guesses.
    pub fn guess(&mut self, starts: &str) -> &mut Self {
        self.starts(starts, false)
    }

    fn starts(&mut self, starts: &str, fixed: bool) -> &mut Self {
        for piece in pieces(starts) {
            let (name, value) = piece.split_once('=').expect("a start");
            let value = self.expr(value);
            let v = self.id(name.trim());
            self.flat.variables[v.index()].start = Some(value);
            self.flat.variables[v.index()].fixed = fixed;
        }
        self
    }

    pub fn select(&mut self, names: &str, select: StateSelect) -> &mut Self {
        for name in names.split_whitespace() {
            let v = self.id(name);
            self.flat.variables[v.index()].state_select = select;
        }
        self
    }

    pub fn equations(&mut self, text: &str) -> &mut Self {
        self.equations_of("", OriginKind::Declared, text)
    }

    pub fn equations_of(&mut self, instance: &str, kind: OriginKind, text: &str) -> &mut Self {
        let instance = self.instance_named(instance);
        for piece in pieces(text) {
            let (lhs, rhs) = self.sides(piece);
            self.flat.equations.push(FlatEquation { lhs, rhs, origin: origin(instance, kind) });
        }
        self
    }

    pub fn initial(&mut self, text: &str) -> &mut Self {
        for piece in pieces(text) {
            let (lhs, rhs) = self.sides(piece);
            let mut origin = origin(0, OriginKind::Declared);
            origin.span.start = 1000 + self.flat.initial_equations.len() as u32;
            self.flat.initial_equations.push(FlatEquation { lhs, rhs, origin });
        }
        self
    }

    /// Branches of conditions (separated by bars) and assignments; `reinit(x, e)` is written `reinit x = e`.
    pub fn when(&mut self, branches: &[(&str, &str)]) -> &mut Self {
        let origin = origin(0, OriginKind::Declared);
        let branches = branches
            .iter()
            .map(|(conditions, actions)| WhenBranch {
                conditions: conditions.split('|').map(|c| self.expr(c)).collect(),
                actions: pieces(actions).map(|a| self.action(a)).collect(),
            })
            .collect();
        self.flat.whens.push(WhenClause { branches, origin });
        self
    }

    fn action(&mut self, text: &str) -> WhenAction {
        let origin = origin(0, OriginKind::Declared);
        let (left, value) = text.split_once('=').expect("an assignment");
        let value = self.expr(value);
        match left.trim().strip_prefix("reinit ") {
            Some(x) => WhenAction::Reinit { variable: self.id(x.trim()), value, guard: Exprs::ONE, origin },
            None => WhenAction::Assign { variable: self.id(left.trim()), value, origin },
        }
    }

    pub fn id(&self, name: &str) -> VarId {
        let found = self.flat.variables.iter().position(|v| v.name == name);
        VarId(found.unwrap_or_else(|| panic!("`{name}` is not declared")) as u32)
    }

    fn sides(&mut self, text: &str) -> (ExprId, ExprId) {
        let split = text
            .char_indices()
            .find(|&(i, c)| {
                let bytes = text.as_bytes();
                c == '=' && bytes.get(i + 1) != Some(&b'=') && !matches!(bytes[i - 1], b'=' | b'<' | b'>')
            })
            .expect("an equation");
        (self.expr(&text[..split.0]), self.expr(&text[split.0 + 1..]))
    }

    /// Parses an expression; relations make events.
    pub fn expr(&mut self, text: &str) -> ExprId {
        let mut parser = Parser { tokens: tokens(text), at: 0, model: self };
        let e = parser.level(0);
        assert_eq!(parser.at, parser.tokens.len(), "rest in `{text}`");
        e
    }
}

fn pieces(text: &str) -> impl Iterator<Item = &str> {
    text.split(';').map(str::trim).filter(|piece| !piece.is_empty())
}

fn tokens(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().collect();
    let (mut found, mut i) = (Vec::new(), 0);
    let word = |c: char| c.is_alphanumeric() || c == '.' || c == '_';
    while i < chars.len() {
        let start = i;
        i += 1;
        if chars[start].is_whitespace() {
            continue;
        }
        if word(chars[start]) {
            let number = chars[start].is_ascii_digit();
            while i < chars.len() && (word(chars[i]) || number && chars[i - 1] == 'e' && chars[i] == '-') {
                i += 1;
            }
        } else if i < chars.len() && matches!((chars[start], chars[i]), ('<' | '>' | '=', '=') | ('<', '>')) {
            i += 1;
        }
        found.push(chars[start..i].iter().collect());
    }
    found
}

struct Parser<'a> {
    tokens: Vec<String>,
    at: usize,
    model: &'a mut Model,
}

const LEVELS: [&[&str]; 6] = [&["or"], &["and"], &["<", "<=", ">", ">=", "==", "<>"], &["+", "-"], &["*", "/"], &["^"]];

impl Parser<'_> {
    fn peek(&self) -> &str {
        self.tokens.get(self.at).map_or("", String::as_str)
    }

    fn take(&mut self, token: &str) -> bool {
        let found = self.peek() == token;
        self.at += usize::from(found);
        found
    }

    fn level(&mut self, level: usize) -> ExprId {
        if level == LEVELS.len() {
            return self.unary();
        }
        let mut left = self.level(level + 1);
        while let Some(op) = LEVELS[level].iter().find(|op| self.peek() == **op) {
            self.at += 1;
            let right = self.level(level + 1);
            left = binary(&mut self.model.flat.exprs, op, left, right);
        }
        left
    }

    fn unary(&mut self) -> ExprId {
        if self.take("-") {
            let e = self.level(5);
            return self.model.flat.exprs.neg(e);
        }
        if self.take("not") {
            let e = self.level(2);
            return self.model.flat.exprs.not(e);
        }
        if self.take("if") {
            let c = self.level(0);
            assert!(self.take("then"));
            let a = self.level(0);
            assert!(self.take("else"));
            let b = self.level(0);
            return self.model.flat.exprs.if_(c, a, b);
        }
        if self.take("(") {
            let e = self.level(0);
            assert!(self.take(")"));
            return e;
        }
        let word = self.tokens[self.at].clone();
        self.at += 1;
        if word.starts_with(|c: char| c.is_ascii_digit()) {
            return self.model.flat.exprs.num(word.parse().expect("a number"));
        }
        let call = self.peek() == "(" && !matches!(word.as_str(), "and" | "or");
        self.at += usize::from(call);
        if call { self.call(&word) } else { self.name(&word) }
    }

    fn name(&mut self, word: &str) -> ExprId {
        match word {
            "time" => self.model.flat.exprs.time(),
            "true" => Exprs::ONE,
            "false" => Exprs::ZERO,
            _ => {
                let v = self.model.id(word);
                self.model.flat.exprs.var(v)
            }
        }
    }

    fn call(&mut self, word: &str) -> ExprId {
        let mut args = Vec::new();
        while !self.take(")") {
            args.push(self.level(0));
            self.take(",");
        }
        let p = &mut self.model.flat.exprs;
        let variable = |p: &Exprs| match p.node(args[0]) {
            ExprNode::Var(v) => v,
            other => panic!("{word} of {other:?}"),
        };
        match word {
            "der" => {
                let v = variable(p);
                p.der(v)
            }
            "pre" => {
                let v = variable(p);
                p.pre(v)
            }
            "initial" => p.intern(ExprNode::Initial),
            "sample" => p.sample(args[0], args[1]),
            "noEvent" => without_event(p, args[0]),
            "floor" => p.event_floor(args[0]),
            "sin" => p.unary(UnaryFunction::Sin, args[0]),
            "cos" => p.unary(UnaryFunction::Cos, args[0]),
            "exp" => p.unary(UnaryFunction::Exp, args[0]),
            "sqrt" => p.sqrt(args[0]),
            _ => panic!("no function `{word}`"),
        }
    }
}

fn without_event(p: &mut Exprs, e: ExprId) -> ExprId {
    match p.node(e) {
        ExprNode::EventRel(rel, a, b) => p.rel(rel, a, b),
        ExprNode::If(c, a, b) => {
            let c = without_event(p, c);
            p.if_(c, a, b)
        }
        _ => e,
    }
}

fn binary(p: &mut Exprs, op: &str, a: ExprId, b: ExprId) -> ExprId {
    match op {
        "or" => p.or(a, b),
        "and" => p.and(a, b),
        "<" => p.event_rel(RelationalOp::Lt, a, b),
        "<=" => p.event_rel(RelationalOp::Le, a, b),
        ">" => p.event_rel(RelationalOp::Gt, a, b),
        ">=" => p.event_rel(RelationalOp::Ge, a, b),
        "==" => p.event_rel(RelationalOp::Eq, a, b),
        "<>" => p.event_rel(RelationalOp::Ne, a, b),
        "+" => p.add(a, b),
        "-" => p.sub(a, b),
        "*" => p.mul(a, b),
        "/" => p.div(a, b),
        _ => p.pow(a, b),
    }
}
