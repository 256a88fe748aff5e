//! The syntax tree of the full Modelica 3.6 grammar (specification, appendix A). It knows no semantics.

use super::symbol::Symbol;
use crate::diag::Span;

/// A name at a place. Quoted identifiers keep their quotes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ident {
    /// The word.
    pub name: Symbol,
    /// Where it stands.
    pub span: Span,
}

/// A dotted name such as `Modelica.Units.SI.Pressure`, or `.Modelica` with a leading dot.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// True with a leading dot.
    pub global: bool,
    /// The parts, at least one.
    pub parts: Vec<Ident>,
    /// The whole name.
    pub span: Span,
}

impl Path {
    /// The parts joined by dots.
    pub fn dotted(&self) -> String {
        self.parts.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(".")
    }
}

/// One file: `within` and classes.
#[derive(Clone, Debug, Default)]
pub struct StoredDefinition {
    /// `within A.B;`; a bare `within;` gives `None`.
    pub within: Option<Path>,
    /// Top-level classes, each with whether it is `final`.
    pub classes: Vec<Class>,
}

/// The specialised class.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the Modelica keywords")]
pub enum ClassKind {
    Class,
    Model,
    Block,
    Record {
        operator: bool,
    },
    Connector {
        expandable: bool,
    },
    Type,
    Package,
    /// `purity` is `Some(true)` for `pure`, `Some(false)` for `impure`.
    Function {
        operator: bool,
        purity: Option<bool>,
    },
    Operator,
}

impl ClassKind {
    /// The keywords without the purity of functions.
    pub fn word(self) -> &'static str {
        match self {
            ClassKind::Class => "class",
            ClassKind::Model => "model",
            ClassKind::Block => "block",
            ClassKind::Record { operator: false } => "record",
            ClassKind::Record { operator: true } => "operator record",
            ClassKind::Connector { expandable: false } => "connector",
            ClassKind::Connector { expandable: true } => "expandable connector",
            ClassKind::Type => "type",
            ClassKind::Package => "package",
            ClassKind::Function { .. } => "function",
            ClassKind::Operator => "operator",
        }
    }
}

/// Prefixes of classes and components.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs, reason = "the Modelica keywords")]
pub struct ElementPrefixes {
    pub encapsulated: bool,
    pub partial: bool,
    pub final_: bool,
    pub redeclare: bool,
    pub replaceable: bool,
    pub inner: bool,
    pub outer: bool,
}

/// A class definition.
#[derive(Clone, Debug)]
pub struct Class {
    /// Its name.
    pub name: Ident,
    /// model, function, ...
    pub kind: ClassKind,
    /// partial, replaceable, ...
    pub prefixes: ElementPrefixes,
    /// `constrainedby` of a replaceable class.
    pub constraint: Option<ConstrainingClause>,
    /// What it holds.
    pub body: ClassBody,
    /// The description string.
    pub description: Option<Box<str>>,
    /// `annotation(...)` of the class (also the one inside a long class).
    pub annotation: Option<Modification>,
    /// From the first prefix to the name after `end`.
    pub span: Span,
}

/// `constrainedby T(...)`.
#[derive(Clone, Debug)]
pub struct ConstrainingClause {
    /// The constraining type.
    pub path: Path,
    /// Its modification.
    pub modification: Option<Modification>,
}

/// The four forms of a class body.
#[derive(Clone, Debug)]
pub enum ClassBody {
    /// `model A ... end A;`
    Long(LongBody),
    /// `type A = input B[3](...)`.
    Short {
        /// `flow`, `input`, ... before the base.
        prefix: TypePrefix,
        /// The base class.
        base: Path,
        /// Array dimensions.
        subscripts: Vec<Subscript>,
        /// Modification of the base.
        modification: Option<Modification>,
    },
    /// `type E = enumeration(a, b "text")`; `None` for `enumeration(:)`.
    Enumeration(Option<Vec<EnumLiteral>>),
    /// `function f = der(g, x, y)`.
    Derivative {
        /// The function differentiated.
        function: Path,
        /// The arguments it is differentiated by.
        by: Vec<Ident>,
    },
}

/// One literal of an enumeration.
#[derive(Clone, Debug)]
pub struct EnumLiteral {
    /// Its name.
    pub name: Ident,
    /// Its description.
    pub description: Option<Box<str>>,
}

/// A class body with sections.
#[derive(Clone, Debug, Default)]
pub struct LongBody {
    /// `class extends X(...)`: the modification, when this is such a class.
    pub class_extends: Option<Option<Modification>>,
    /// Elements of all sections in order.
    pub elements: Vec<Element>,
    /// `equation` sections joined.
    pub equations: Vec<Equation>,
    /// `initial equation` sections joined.
    pub initial_equations: Vec<Equation>,
    /// Each `algorithm` section on its own.
    pub algorithms: Vec<Vec<Statement>>,
    /// Each `initial algorithm` section on its own.
    pub initial_algorithms: Vec<Vec<Statement>>,
    /// `external "C" ...` of a function.
    pub external: Option<Span>,
    /// What stands between `external` and its semicolon, as written.
    pub external_text: Option<Box<str>>,
}

/// An element of a class with its visibility.
#[derive(Clone, Debug)]
pub struct Element {
    /// True in a `protected` section.
    pub protected: bool,
    /// What it is.
    pub kind: ElementKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of elements.
#[derive(Clone, Debug)]
pub enum ElementKind {
    /// `import ...`
    Import(Import),
    /// `extends B(...)`
    Extends(ExtendsClause),
    /// A nested class.
    Class(Box<Class>),
    /// A component clause with one component (a clause with several is split).
    Component(Box<ComponentDeclaration>),
}

/// The forms of `import`.
#[derive(Clone, Debug)]
pub enum Import {
    /// `import A.B;` or `import C = A.B;`
    Single {
        /// The name it goes by here.
        alias: Option<Ident>,
        /// What is imported.
        path: Path,
    },
    /// `import A.*;`
    All(Path),
    /// `import A.{b, c};`
    Some(Path, Vec<Ident>),
}

/// `extends B(mods, break c, break connect(a, b)) annotation(...)`.
#[derive(Clone, Debug)]
pub struct ExtendsClause {
    /// The base class.
    pub base: Path,
    /// Its modification.
    pub modification: Option<Modification>,
}

/// Variability and causality prefixes of a component or short class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TypePrefix {
    /// `flow`
    pub flow: bool,
    /// `stream`
    pub stream: bool,
    /// `discrete`, `parameter`, `constant`
    pub variability: Option<VariabilityPrefix>,
    /// `input`, `output`
    pub causality: Option<CausalityPrefix>,
}

/// Declared variability.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the Modelica keywords")]
pub enum VariabilityPrefix {
    Constant,
    Parameter,
    Discrete,
}

/// Declared causality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the Modelica keywords")]
pub enum CausalityPrefix {
    Input,
    Output,
}

/// One declared component.
#[derive(Clone, Debug)]
pub struct ComponentDeclaration {
    /// Its name.
    pub name: Ident,
    /// inner, outer, replaceable, ...
    pub prefixes: ElementPrefixes,
    /// flow, parameter, input, ...
    pub prefix: TypePrefix,
    /// Its type.
    pub class: Path,
    /// Dimensions: those of the type (`Real[3] x`) after those of the name (`x[2]`): `Real[3] x[2]` is `[2, 3]`.
    pub subscripts: Vec<Subscript>,
    /// `(...) = value`
    pub modification: Option<Modification>,
    /// `if condition`
    pub condition: Option<Expr>,
    /// `constrainedby ...`
    pub constraint: Option<ConstrainingClause>,
    /// The description string.
    pub description: Option<Box<str>>,
    /// `annotation(...)`
    pub annotation: Option<Modification>,
}

/// `(arguments) = value`, `= value` or `:= value`.
#[derive(Clone, Debug, Default)]
pub struct Modification {
    /// What stands in brackets.
    pub arguments: Vec<ModificationArgument>,
    /// What stands after `=`.
    pub value: Option<Expr>,
    /// `break` as value (removes the binding, Modelica 3.6).
    pub break_value: bool,
}

/// One argument of a modification.
#[derive(Clone, Debug)]
pub struct ModificationArgument {
    /// `each`
    pub each: bool,
    /// `final`
    pub final_: bool,
    /// What it does.
    pub kind: ModificationArgumentKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of arguments.
#[derive(Clone, Debug)]
pub enum ModificationArgumentKind {
    /// `a.b(...) = value "text"`
    Modify {
        /// The element.
        path: Path,
        /// What is changed.
        modification: Option<Modification>,
        /// A description, if given.
        description: Option<Box<str>>,
    },
    /// `redeclare T x(...)` or `replaceable T x`.
    Component(Box<ComponentDeclaration>),
    /// `redeclare model M = N` and the like.
    Class(Box<Class>),
    /// `break name` in `extends` (3.6).
    BreakComponent(Ident),
    /// `break connect(a, b)` in `extends` (3.6).
    BreakConnect(Box<Expr>, Box<Expr>),
}

/// One dimension or index.
#[derive(Clone, Debug)]
pub enum Subscript {
    /// `:`
    All(Span),
    /// An expression, possibly a range.
    Expr(Expr),
}

/// An equation with its place.
#[derive(Clone, Debug)]
pub struct Equation {
    /// What it says.
    pub kind: EquationKind,
    /// The description string.
    pub description: Option<Box<str>>,
    /// Where it stands, without the semicolon.
    pub span: Span,
}

/// The kinds of equations.
#[derive(Clone, Debug)]
pub enum EquationKind {
    /// `a = b`
    Equal(Expr, Expr),
    /// `connect(a, b)`; both are component references.
    Connect(Expr, Expr),
    /// `if c then ... elseif ... else ... end if`
    If {
        /// Conditions with their equations.
        branches: Vec<(Expr, Vec<Equation>)>,
        /// The equations after `else`.
        otherwise: Vec<Equation>,
    },
    /// `for i in 1:n, j loop ... end for`
    For {
        /// The iterators, outermost first.
        iterators: Vec<ForIndex>,
        /// The body.
        body: Vec<Equation>,
    },
    /// `when c then ... elsewhen ... end when`
    When(Vec<(Expr, Vec<Equation>)>),
    /// `f(...)`: assert, terminate, reinit, Connections.root, ...
    Call(Expr),
}

/// One loop variable.
#[derive(Clone, Debug)]
pub struct ForIndex {
    /// Its name.
    pub name: Ident,
    /// Its range; `None` when deduced from the body.
    pub range: Option<Expr>,
}

/// A statement with its place.
#[derive(Clone, Debug)]
pub struct Statement {
    /// What it does.
    pub kind: StatementKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of statements.
#[derive(Clone, Debug)]
pub enum StatementKind {
    /// `a := b`
    Assign(Expr, Expr),
    /// `(a, , c) := f(x)`
    AssignTuple(Vec<Option<Expr>>, Expr),
    /// `f(x)`
    Call(Expr),
    /// `if`
    If {
        /// Conditions with their statements.
        branches: Vec<(Expr, Vec<Statement>)>,
        /// After `else`.
        otherwise: Vec<Statement>,
    },
    /// `for`
    For {
        /// The iterators, outermost first.
        iterators: Vec<ForIndex>,
        /// The body.
        body: Vec<Statement>,
    },
    /// `while`
    While(Expr, Vec<Statement>),
    /// `when`
    When(Vec<(Expr, Vec<Statement>)>),
    /// `break`
    Break,
    /// `return`
    Return,
}

/// An expression with its place.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands.
    pub span: Span,
}

impl Expr {
    /// The number, where it is written as one, with a sign or without.
    pub fn as_number(&self) -> Option<f64> {
        match &self.kind {
            ExprKind::Real(x) => Some(*x),
            ExprKind::Integer(i) => Some(*i as f64),
            ExprKind::Unary(UnaryOp::Minus, inner) => inner.as_number().map(|x| -x),
            ExprKind::Unary(UnaryOp::Plus, inner) => inner.as_number(),
            _ => None,
        }
    }
}

impl Expr {
    /// Shows the expressions directly inside this one, in their order; not the ranges of iterators, which have a scope of
    /// their own, nor indices in the name of a function.
    pub fn each_child<'a>(&'a self, see: &mut dyn FnMut(&'a Expr)) {
        let indices = |subscripts: &'a [Subscript]| {
            subscripts.iter().filter_map(|s| match s {
                Subscript::Expr(e) => Some(e),
                Subscript::All(_) => None,
            })
        };
        match &self.kind {
            ExprKind::Reference(r) => r.parts.iter().flat_map(|p| indices(&p.subscripts)).for_each(see),
            ExprKind::Unary(_, a) => see(a),
            ExprKind::Binary(_, a, b) => [&**a, &**b].into_iter().for_each(see),
            ExprKind::If { branches, otherwise } => {
                branches.iter().flat_map(|(c, value)| [c, value]).for_each(&mut *see);
                see(otherwise);
            }
            ExprKind::Range { from, step, to } => {
                [Some(from), step.as_ref(), Some(to)].into_iter().flatten().for_each(|e| see(e));
            }
            ExprKind::Call { args, named, .. } => args.iter().chain(named.iter().map(|(_, e)| e)).for_each(see),
            ExprKind::Comprehension { body, .. } => see(body),
            ExprKind::PartialApplication { named, .. } => named.iter().for_each(|(_, e)| see(e)),
            ExprKind::Array(items) => items.iter().for_each(see),
            ExprKind::Matrix(rows) => rows.iter().flatten().for_each(see),
            ExprKind::Tuple(items) => items.iter().flatten().for_each(see),
            ExprKind::Index(inner, subscripts) => {
                see(inner);
                indices(subscripts).for_each(see);
            }
            ExprKind::Integer(_)
            | ExprKind::Real(_)
            | ExprKind::String(_)
            | ExprKind::Boolean(_)
            | ExprKind::End
            | ExprKind::Error => {}
        }
    }
}

/// The kinds of expressions.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A number written without `.` or exponent that fits in 64 bits.
    Integer(i64),
    /// A number.
    Real(f64),
    /// A string, escapes resolved.
    String(Box<str>),
    /// `true`, `false`
    Boolean(bool),
    /// `a.b[i].c`
    Reference(ComponentReference),
    /// `op a`
    Unary(UnaryOp, Box<Expr>),
    /// `a op b`
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `if c then a elseif d then b else e`
    If {
        /// Conditions with their values.
        branches: Vec<(Expr, Expr)>,
        /// After `else`.
        otherwise: Box<Expr>,
    },
    /// `from:to`, `from:step:to`
    Range {
        /// First value.
        from: Box<Expr>,
        /// Step, 1 when absent.
        step: Option<Box<Expr>>,
        /// Last value.
        to: Box<Expr>,
    },
    /// `f(a, b, name = c)`; `der`, `initial` and `pure` too.
    Call {
        /// What is called.
        function: ComponentReference,
        /// Positional arguments.
        args: Vec<Expr>,
        /// Named arguments.
        named: Vec<(Ident, Expr)>,
    },
    /// `f(expr for i in 1:n)` and `{expr for i in 1:n}` (then `function` is `None`).
    Comprehension {
        /// `sum`, `max`, ... or none for an array.
        function: Option<ComponentReference>,
        /// The element.
        body: Box<Expr>,
        /// The iterators, outermost first.
        iterators: Vec<ForIndex>,
    },
    /// `function f(x = 1)` as an argument.
    PartialApplication {
        /// The function.
        function: Path,
        /// Bound arguments.
        named: Vec<(Ident, Expr)>,
    },
    /// `{a, b}`
    Array(Vec<Expr>),
    /// `[a, b; c, d]`
    Matrix(Vec<Vec<Expr>>),
    /// `(a, , c)`: a list of outputs; a single bracketed expression is not a tuple.
    Tuple(Vec<Option<Expr>>),
    /// `(a)[i]`: an index on a bracketed expression (Modelica 3.6).
    Index(Box<Expr>, Vec<Subscript>),
    /// `end` inside a subscript.
    End,
    /// Stands where the text could not be read.
    Error,
}

/// A component reference.
#[derive(Clone, Debug)]
pub struct ComponentReference {
    /// True with a leading dot.
    pub global: bool,
    /// The parts, at least one.
    pub parts: Vec<ReferencePart>,
    /// The whole reference.
    pub span: Span,
}

/// One part of a component reference.
#[derive(Clone, Debug)]
pub struct ReferencePart {
    /// The name.
    pub name: Ident,
    /// Its indices, empty without brackets.
    pub subscripts: Vec<Subscript>,
}

/// Unary operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the Modelica operators")]
pub enum UnaryOp {
    Plus,
    Minus,
    /// `.+`
    ElementPlus,
    /// `.-`
    ElementMinus,
    Not,
}

/// Binary operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the Modelica operators")]
pub enum BinaryOp {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    ElementAdd,
    ElementSub,
    ElementMul,
    ElementDiv,
    ElementPow,
    Lt,
    Le,
    Gt,
    Ge,
    Eq,
    Ne,
    And,
    Or,
}
