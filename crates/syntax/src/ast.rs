//! The syntax tree of the full Modelica 3.6 grammar (specification, appendix A). It knows no semantics.
//!
//! The parser makes it, `print` writes it back as text, and the crates `model` and `editor` read it.
//! Nodes own their children. Names are interned ([`Symbol`]); places are spans of bytes ([`Span`]).
//! What the grammar allows in several notations is one node: a clause with several components becomes several
//! [`Element`]s, sections of equations are joined, and brackets around an expression leave no trace but its span.

use super::symbol::Symbol;
use crate::diag::Span;

/// An identifier and its place. Quoted identifiers keep their quotes: `'a b'` and `a` are different names.
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
    /// True with a leading dot: lookup then begins at the root, not in the enclosing classes.
    pub global: bool,
    /// The identifiers between the dots, at least one.
    pub parts: Vec<Ident>,
    /// The whole name.
    pub span: Span,
}

impl Path {
    /// The identifiers joined by dots, without a leading dot.
    #[inline]
    pub fn dotted(&self) -> String {
        self.parts.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(".")
    }
}

/// One file: an optional `within` clause, and classes.
#[derive(Clone, Debug, Default)]
pub struct StoredDefinition {
    /// The package that the classes belong to. `None` without the clause, and for a bare `within;`.
    pub within: Option<Path>,
    /// The classes at the top level, in order. Their prefixes say whether each is `final`.
    pub classes: Vec<Class>,
}

/// The kind of a class: general, or specialised to some purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the Modelica keywords")]
pub enum ClassKind {
    Class,
    Model,
    Block,
    /// A `record`, or an `operator record` if `operator` is true.
    Record {
        operator: bool,
    },
    /// A `connector`, or an `expandable connector` if `expandable` is true.
    Connector {
        expandable: bool,
    },
    Type,
    Package,
    /// A `function`, or an `operator function` if `operator` is true.
    /// `purity` is `Some(true)` for `pure`, `Some(false)` for `impure`, `None` without either word.
    Function {
        operator: bool,
        purity: Option<bool>,
    },
    Operator,
}

impl ClassKind {
    /// The keywords of the kind as messages quote them. The purity of functions is left out.
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

/// The prefixes of classes and components, each true if it is written. Those that do not apply stay false.
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

/// A class definition, in any of the forms of [`ClassBody`].
#[derive(Clone, Debug)]
pub struct Class {
    /// Its name.
    pub name: Ident,
    /// The kind: `model`, `function`, and so on.
    pub kind: ClassKind,
    /// `partial`, `replaceable`, `encapsulated`, and so on.
    pub prefixes: ElementPrefixes,
    /// The `constrainedby` clause of a replaceable class.
    pub constraint: Option<ConstrainingClause>,
    /// The part behind the name, without description and annotation.
    pub body: ClassBody,
    /// The description string.
    pub description: Option<Box<str>>,
    /// The annotations of the class, merged. In a long class they stand inside the body.
    pub annotation: Option<Modification>,
    /// From the first prefix to the name after `end`.
    pub span: Span,
}

/// A clause `constrainedby T(...)`: what replaces the element must be a subtype of `T` (section 7.3.2).
#[derive(Clone, Debug)]
pub struct ConstrainingClause {
    /// The constraining type.
    pub path: Path,
    /// The modification that every replacement gets too.
    pub modification: Option<Modification>,
}

/// The forms of a class body.
#[derive(Clone, Debug)]
pub enum ClassBody {
    /// With sections: `model A ... end A;`.
    Long(LongBody),
    /// By a base class: `type A = input B[3](...)`.
    Short {
        /// `flow`, `input`, ... before the base.
        prefix: TypePrefix,
        /// The base class.
        base: Path,
        /// Array dimensions, empty for a scalar.
        subscripts: Vec<Subscript>,
        /// Modification of the base.
        modification: Option<Modification>,
    },
    /// `type E = enumeration(a, b "text")`. `None` for `enumeration(:)`, whose literals are left open.
    Enumeration(Option<Vec<EnumLiteral>>),
    /// The partial derivative of a function: `function f = der(g, x, y)` (section 12.7.2).
    Derivative {
        /// The function differentiated.
        function: Path,
        /// The inputs by which it is differentiated, one after the other.
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

/// The body of a long class. The order of its sections is not kept, as it has no meaning.
#[derive(Clone, Debug, Default)]
pub struct LongBody {
    /// `Some` for `model extends X(...)`, which changes the inherited class `X` (section 7.3.1).
    /// The inner option is its modification.
    pub class_extends: Option<Option<Modification>>,
    /// Imports, base classes, nested classes and components, in the order of the text.
    pub elements: Vec<Element>,
    /// `equation` sections joined.
    pub equations: Vec<Equation>,
    /// `initial equation` sections joined.
    pub initial_equations: Vec<Equation>,
    /// Each `algorithm` section on its own.
    pub algorithms: Vec<Vec<Statement>>,
    /// Each `initial algorithm` section on its own.
    pub initial_algorithms: Vec<Vec<Statement>>,
    /// The place of `external "C" ...;` in a function, without the semicolon.
    pub external: Option<Span>,
    /// The text between `external` and its semicolon, as written.
    pub external_text: Option<Box<str>>,
}

/// One element of a class, with its visibility and place.
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
    /// One component. A clause with several is split; they share prefixes and type.
    Component(Box<ComponentDeclaration>),
}

/// The forms of `import` (section 13.2.1).
#[derive(Clone, Debug)]
pub enum Import {
    /// `import A.B;` or `import C = A.B;`
    Single {
        /// The name by which it is known here. `None` for the last identifier of the path.
        alias: Option<Ident>,
        /// What is imported.
        path: Path,
    },
    /// `import A.*;` makes all names of a package known.
    All(Path),
    /// `import A.{b, c};` makes some names of a package known.
    Some(Path, Vec<Ident>),
}

/// An `extends` clause: `extends B(mods, break c, break connect(a, b))`. Its annotation is not kept.
#[derive(Clone, Debug)]
pub struct ExtendsClause {
    /// The base class.
    pub base: Path,
    /// The modification of what is inherited, deselections by `break` included.
    pub modification: Option<Modification>,
}

/// The type prefixes of a component or short class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TypePrefix {
    /// `flow`: connected variables sum to zero.
    pub flow: bool,
    /// `stream`: the value is carried by a flow in the same connector.
    pub stream: bool,
    /// `discrete`, `parameter`, `constant`
    pub variability: Option<VariabilityPrefix>,
    /// `input`, `output`
    pub causality: Option<CausalityPrefix>,
}

/// The declared variability, from what never changes to what changes at events.
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

/// One declared component, for example `parameter Real x[2](min = 0) = {1, 2} if on "text"`.
#[derive(Clone, Debug)]
pub struct ComponentDeclaration {
    /// Its name.
    pub name: Ident,
    /// `inner`, `outer`, `replaceable`, and so on.
    pub prefixes: ElementPrefixes,
    /// `flow`, `parameter`, `input`, and so on.
    pub prefix: TypePrefix,
    /// The name of the type, without dimensions.
    pub class: Path,
    /// All dimensions: those of the name, then those of the type. `Real[3] x[2]` has `[2, 3]`.
    pub subscripts: Vec<Subscript>,
    /// The modification, `(...) = value`.
    pub modification: Option<Modification>,
    /// The condition after `if`: where it is false, the component does not exist.
    pub condition: Option<Expr>,
    /// The `constrainedby` clause of a replaceable component.
    pub constraint: Option<ConstrainingClause>,
    /// The description string.
    pub description: Option<Box<str>>,
    /// `annotation(...)`
    pub annotation: Option<Modification>,
}

/// A modification: `(arguments) = value`, `= value` or `:= value` (section 7.2).
#[derive(Clone, Debug, Default)]
pub struct Modification {
    /// The arguments in brackets, in the order of the text. Empty without brackets.
    pub arguments: Vec<ModificationArgument>,
    /// The value after `=` or `:=`.
    pub value: Option<Expr>,
    /// True for `= break`, which removes the binding that would be inherited. Then `value` is `None`.
    pub break_value: bool,
}

/// One argument of a modification.
#[derive(Clone, Debug)]
pub struct ModificationArgument {
    /// `each`: one value for all elements of an array.
    pub each: bool,
    /// `final`: no outer modification may change it.
    pub final_: bool,
    /// The element concerned, and the change.
    pub kind: ModificationArgumentKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of arguments.
#[derive(Clone, Debug)]
pub enum ModificationArgumentKind {
    /// A change of an element: `a.b(...) = value "text"`.
    Modify {
        /// The element, which may lie several levels deeper.
        path: Path,
        /// The change. `None` for a bare name such as `(x)`.
        modification: Option<Modification>,
        /// A description, if given.
        description: Option<Box<str>>,
    },
    /// `redeclare T x(...)` or `replaceable T x`: another type for a component.
    Component(Box<ComponentDeclaration>),
    /// `redeclare model M = N` or the like: another class.
    Class(Box<Class>),
    /// `break name`: the inherited element is left out (section 7.4).
    BreakComponent(Ident),
    /// `break connect(a, b)`: the inherited connection is left out (section 7.4).
    BreakConnect(Box<Expr>, Box<Expr>),
}

/// One dimension of a declaration, or one index of a reference.
#[derive(Clone, Debug)]
pub enum Subscript {
    /// `:`: an open dimension, or all indices.
    All(Span),
    /// A size or an index, possibly a range.
    Expr(Expr),
}

/// An equation of an `equation` or `initial equation` section, with its place.
#[derive(Clone, Debug)]
pub struct Equation {
    /// What it says.
    pub kind: EquationKind,
    /// The description string.
    pub description: Option<Box<str>>,
    /// Where it stands, without the semicolon.
    pub span: Span,
}

/// The kinds of equations (section 8.3).
#[derive(Clone, Debug)]
pub enum EquationKind {
    /// `a = b`. Neither side is assigned.
    Equal(Expr, Expr),
    /// `connect(a, b)`; both are component references.
    Connect(Expr, Expr),
    /// `if c then ... elseif ... else ... end if`, of which one branch holds at a time.
    If {
        /// Conditions in order, each with the equations that hold if it is the first true one.
        branches: Vec<(Expr, Vec<Equation>)>,
        /// The equations after `else`. Empty without `else`.
        otherwise: Vec<Equation>,
    },
    /// `for i in 1:n, j loop ... end for`: the body for every combination of values.
    For {
        /// The iterators, outermost first.
        iterators: Vec<ForIndex>,
        /// The equations of the loop.
        body: Vec<Equation>,
    },
    /// `when c then ... elsewhen ... end when`: equations that hold at the instants when a condition becomes true.
    When(Vec<(Expr, Vec<Equation>)>),
    /// A call whose outputs are not used: `assert`, `terminate`, `reinit`, `Connections.root`, and so on.
    Call(Expr),
}

/// One loop variable with its range.
#[derive(Clone, Debug)]
pub struct ForIndex {
    /// Its name.
    pub name: Ident,
    /// The range. `None` if it is deduced from how the variable indexes arrays.
    pub range: Option<Expr>,
}

/// A statement of an algorithm section or function, with its place. Its description is not kept.
#[derive(Clone, Debug)]
pub struct Statement {
    /// What it does.
    pub kind: StatementKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of statements (section 11.2).
#[derive(Clone, Debug)]
pub enum StatementKind {
    /// `a := b`.
    Assign(Expr, Expr),
    /// `(a, , c) := f(x)`. `None` where an output is dropped.
    AssignTuple(Vec<Option<Expr>>, Expr),
    /// `f(x)`, a call whose outputs are not used.
    Call(Expr),
    /// `if c then ... elseif ... else ... end if`.
    If {
        /// Conditions in order, each with the statements that it guards.
        branches: Vec<(Expr, Vec<Statement>)>,
        /// The statements after `else`. Empty without `else`.
        otherwise: Vec<Statement>,
    },
    /// `for i in 1:n loop ... end for`.
    For {
        /// The iterators, outermost first.
        iterators: Vec<ForIndex>,
        /// The statements of the loop.
        body: Vec<Statement>,
    },
    /// `while c loop ... end while`.
    While(Expr, Vec<Statement>),
    /// `when c then ... elsewhen ... end when`.
    When(Vec<(Expr, Vec<Statement>)>),
    /// `break`, which leaves the innermost loop.
    Break,
    /// `return`, which leaves the function.
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
    /// The value of a literal number, with or without signs before it. `None` for anything else.
    pub fn as_number(&self) -> Option<f64> {
        match &self.kind {
            ExprKind::Real(x) => Some(*x),
            ExprKind::Integer(i) => Some(*i as f64),
            // The parser has no negative literals: a sign is an operator.
            ExprKind::Unary(UnaryOp::Minus, inner) => inner.as_number().map(|x| -x),
            ExprKind::Unary(UnaryOp::Plus, inner) => inner.as_number(),
            _ => None,
        }
    }
}

impl Expr {
    /// Calls `see` for each expression directly inside this one, in the order of the text.
    /// The ranges of iterators are left out, as they have a scope of their own; so are indices in the name of a
    /// function.
    pub fn each_child<'a>(&'a self, see: &mut dyn FnMut(&'a Expr)) {
        // `:` holds no expression.
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
    /// A number without `.` and exponent that fits in 64 bits.
    Integer(i64),
    /// Any other number. Infinite if it is too large, which is an error.
    Real(f64),
    /// A string without its quotation marks, escapes resolved.
    String(Box<str>),
    /// `true`, `false`
    Boolean(bool),
    /// A name, possibly dotted and indexed: `a.b[i].c`. Constants, components and enumeration literals look alike here.
    Reference(ComponentReference),
    /// A sign or `not` before an operand.
    Unary(UnaryOp, Box<Expr>),
    /// Two operands with an operator between them.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `if c then a elseif d then b else e`
    If {
        /// Conditions in order, each with the value if it is the first true one.
        branches: Vec<(Expr, Expr)>,
        /// The value after `else`.
        otherwise: Box<Expr>,
    },
    /// `from:to` or `from:step:to`, both ends included (section 10.4.3).
    Range {
        /// First value.
        from: Box<Expr>,
        /// The step. `None` stands for 1.
        step: Option<Box<Expr>>,
        /// Last value.
        to: Box<Expr>,
    },
    /// A call: `f(a, b, name = c)`. The keywords `der`, `initial` and `pure` are called in the same way.
    Call {
        /// The name of the function, operator or record.
        function: ComponentReference,
        /// Positional arguments in order.
        args: Vec<Expr>,
        /// Named arguments in the order of the text, which follow the positional ones.
        named: Vec<(Ident, Expr)>,
    },
    /// A reduction, `f(expr for i in 1:n)`, or an array comprehension, `{expr for i in 1:n}`.
    Comprehension {
        /// The function that reduces, such as `sum` or `max`. `None` for an array.
        function: Option<ComponentReference>,
        /// The expression that is evaluated for every combination of the iterators.
        body: Box<Expr>,
        /// The iterators, outermost first.
        iterators: Vec<ForIndex>,
    },
    /// A function with some inputs given, as an argument: `function f(x = 1)` (section 12.4.2.1).
    PartialApplication {
        /// The function.
        function: Path,
        /// The inputs that are given.
        named: Vec<(Ident, Expr)>,
    },
    /// An array with one more dimension than its elements: `{a, b}`.
    Array(Vec<Expr>),
    /// A matrix by its rows, `[a, b; c, d]`. Elements may be arrays, which are concatenated (section 10.4.2).
    Matrix(Vec<Vec<Expr>>),
    /// A list of outputs, `(a, , c)`. `None` where one is missing. A single expression in brackets is not a tuple.
    Tuple(Vec<Option<Expr>>),
    /// An index on an expression in brackets, `(a)[i]` (new in Modelica 3.6).
    Index(Box<Expr>, Vec<Subscript>),
    /// `end` inside a subscript: the size of the dimension that is indexed.
    End,
    /// Stands where no expression could be parsed; an error was reported.
    Error,
}

/// A component reference such as `a.b[2].c`. It may also name a function or class.
#[derive(Clone, Debug)]
pub struct ComponentReference {
    /// True with a leading dot: lookup then begins at the root.
    pub global: bool,
    /// The names between the dots with their indices, at least one.
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

/// The operators before an operand (section 3.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the Modelica operators")]
pub enum UnaryOp {
    Plus,
    Minus,
    /// `.+`, the element-wise sign.
    ElementPlus,
    /// `.-`, the element-wise sign.
    ElementMinus,
    Not,
}

/// The operators between two operands (sections 3.4 and 3.5). `Element...` are the element-wise ones, such as `.*`.
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
