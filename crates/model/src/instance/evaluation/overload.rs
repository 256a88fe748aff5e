//! Operators and constructors that operator records define (MLS 14).
//!
//! [`Operators`] asks here first for each operator. The functions in `operator '+'` of the record class are searched
//! for one whose inputs fit the operands. If none fits, one operand is converted by a constructor, and at last the
//! operator is applied element by element.

use crate::instance::call::{Callee, FormalParameter};
use crate::instance::calls::binding::is_input;
use crate::instance::lookup::{BuiltinType, LookupResult};
use crate::instance::template::Template;
use crate::instance::value::ModelicaValue;
use crate::instance::vectorised::CallArguments;
use crate::instance::{ClassRef, Operators};
use bramah_expr::types::ScalarType;
use bramah_syntax::ast::{BinaryOp, CausalityPrefix, ClassKind, UnaryOp};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;

/// The name of the operator in the record class, as `'+'` for `a + b` and `a .+ b`.
///
/// Elementwise operators have the function of the plain one: they are applied to each element.
fn name_of(op: BinaryOp) -> Option<&'static str> {
    use BinaryOp::{Add, And, Div, ElementAdd, ElementDiv, ElementMul, ElementPow, ElementSub};
    use BinaryOp::{Eq, Ge, Gt, Le, Lt, Mul, Ne, Or, Pow, Sub};
    Some(match op {
        Add | ElementAdd => "'+'",
        Sub | ElementSub => "'-'",
        Mul | ElementMul => "'*'",
        Div | ElementDiv => "'/'",
        Pow | ElementPow => "'^'",
        Lt => "'<'",
        Le => "'<='",
        Gt => "'>'",
        Ge => "'>='",
        Eq => "'=='",
        Ne => "'<>'",
        And => "'and'",
        Or => "'or'",
    })
}

impl<'a> Operators<'_, 'a, '_> {
    /// The number of the class of an operator record, which its values carry. `None` for other classes.
    pub(in crate::instance) fn operator_class(&mut self, class: &ClassRef<'a>) -> Option<u32> {
        let template = self.instance.names().template(class.class, class.parent);
        self.operator_class_of(&template)
    }

    /// Like [`Self::operator_class`], from the template of the class.
    /// Types that extend the record count as the record itself, so that values of both can be combined.
    pub(in crate::instance) fn operator_class_of(&mut self, template: &Template<'a>) -> Option<u32> {
        // `record C = Complex(...)` and `connector C = input Complex` count as `Complex`.
        // Other kinds end here at once, so that plain records cost no search.
        if !matches!(template.kind, ClassKind::Record { operator: true } | ClassKind::Connector { .. }) {
            return None;
        }
        // Bases follow the classes that extend them, so the last one is the record that declares the operators.
        let base = template.bases.last().filter(|b| matches!(b.ast.kind, ClassKind::Record { operator: true }))?;
        let (own, parent) = (base.class, base.parent);
        let known = self.instance.classes.operator_records.iter().position(|c| c.class == own);
        let at = known.unwrap_or_else(|| {
            self.instance.classes.operator_records.push(ClassRef { class: own, parent, args: [].into() });
            self.instance.classes.operator_records.len() - 1
        });
        u32::try_from(at).ok()
    }

    /// The class number of an operator record, or of the elements of an array of them. `None` for other values.
    fn record_class(value: &ModelicaValue) -> Option<u32> {
        match value {
            ModelicaValue::Record(record) => record.class,
            ModelicaValue::Array { elements, .. } => elements.first().and_then(Self::record_class),
            _ => None,
        }
    }

    /// Applies a binary operator if one side is an operator record.
    /// The outer `None` means that neither side is one, the inner one that a message was reported.
    /// A function of one of both classes is enough: `2 * z` finds the operator of `z`.
    pub(in crate::instance) fn overloaded_binary(
        &mut self,
        op: BinaryOp,
        a: &ModelicaValue,
        b: &ModelicaValue,
        span: Span,
    ) -> Option<Option<ModelicaValue>> {
        let classes: Vec<u32> = [a, b].into_iter().filter_map(Self::record_class).collect();
        if classes.is_empty() {
            return None;
        }
        Some(self.apply_binary(op, a, b, &classes, span))
    }

    /// Chooses and calls the function for a binary operator (MLS 14.5).
    ///
    /// `classes` are the classes of the operands that are operator records. `None` after a message.
    ///
    /// 1. Functions of both classes whose inputs fit the operands as they are. More than one is reported as ambiguous.
    /// 2. Functions whose inputs fit after one operand was converted by a constructor.
    /// 3. The operator applied to corresponding elements of arrays.
    ///
    /// `op` is the operator; elementwise operators use the functions of the plain ones.
    fn apply_binary(
        &mut self,
        op: BinaryOp,
        a: &ModelicaValue,
        b: &ModelicaValue,
        classes: &[u32],
        span: Span,
    ) -> Option<ModelicaValue> {
        let name = name_of(op)?;
        let mut functions = Vec::new();
        // Both operands may have the same class: each function is a candidate once.
        for &class in classes {
            for f in self.operators(class, name) {
                if !functions.iter().any(|g: &Callee<'a>| g.name == f.name) {
                    functions.push(f);
                }
            }
        }
        let fitting = self.fitting(&functions, &[a.clone(), b.clone()]);
        if fitting.len() > 1 {
            return self.ambiguous(name, span);
        }
        if let Some(&f) = fitting.first() {
            return self.instance.calls().call_function(&functions[f], vec![a.clone(), b.clone()], Vec::new(), span);
        }
        // No function fits: convert one operand to the class of the other one, first the left one.
        for &class in classes {
            for (x, y) in [
                (self.converted_to(a, class, span), Some(b.clone())),
                (Some(a.clone()), self.converted_to(b, class, span)),
            ] {
                let (Some(x), Some(y)) = (x, y) else { continue };
                if let [f] = self.fitting(&functions, &[x.clone(), y.clone()])[..] {
                    return self.instance.calls().call_function(&functions[f], vec![x, y], Vec::new(), span);
                }
            }
        }
        self.by_elements(op, a, b, span)
    }

    /// Applies an operator element by element: to arrays of one size, or to an array and a single value (MLS 14.5).
    /// `None` after a message. The product of two arrays is left out here.
    /// The operator is chosen for each pair of elements again, which matters only if their classes differ.
    fn by_elements(&mut self, op: BinaryOp, a: &ModelicaValue, b: &ModelicaValue, span: Span) -> Option<ModelicaValue> {
        let (da, db) = (a.dims().to_vec(), b.dims().to_vec());
        let plain = matches!(op, BinaryOp::Add | BinaryOp::Sub | BinaryOp::Eq | BinaryOp::Ne);
        // `+`, `-` and comparisons need equal shapes; the others may combine an array with a scalar.
        let fits = !(da.is_empty() && db.is_empty()) && (da == db || !plain && (da.is_empty() || db.is_empty()));
        let matrices = op == BinaryOp::Mul && !da.is_empty() && !db.is_empty();
        if !fits || matrices {
            let message =
                format!("there is no operator {} for {} and {}", name_of(op).unwrap_or(""), a.describe(), b.describe());
            return self.instance.fail(Code::TypeMismatch, &message, span);
        }
        let dims = if da.is_empty() { db } else { da };
        let count: usize = dims.iter().product();
        let at = |v: &ModelicaValue, i: usize| if v.dims().is_empty() { v.clone() } else { v.elements()[i].clone() };
        let mut elements = Vec::with_capacity(count);
        for i in 0..count {
            elements.push(self.binary(op, at(a, i), at(b, i), span)?);
        }
        Some(ModelicaValue::array(dims, elements))
    }

    /// Applies a unary operator to an operator record, or to each element of an array of them.
    /// The outer `None` means that the value is no operator record, the inner one that a message was reported.
    ///
    /// `+` gives the value itself. For `-` and `not` exactly one function must fit.
    /// The function `'-'` with one input is the unary minus.
    /// An array is treated element by element, so `-z` of a vector of records is a vector.
    pub(in crate::instance) fn overloaded_unary(
        &mut self,
        op: UnaryOp,
        value: &ModelicaValue,
        span: Span,
    ) -> Option<Option<ModelicaValue>> {
        let class = Self::record_class(value)?;
        let name = match op {
            UnaryOp::Minus | UnaryOp::ElementMinus => "'-'",
            UnaryOp::Not => "'not'",
            UnaryOp::Plus | UnaryOp::ElementPlus => return Some(Some(value.clone())),
        };
        if let ModelicaValue::Array { dims, elements } = value {
            let each: Option<Vec<ModelicaValue>> =
                elements.iter().map(|v| self.overloaded_unary(op, v, span).flatten()).collect();
            return Some(each.map(|all| ModelicaValue::array(dims.clone(), all)));
        }
        let functions = self.operators(class, name);
        Some(match self.fitting(&functions, std::slice::from_ref(value))[..] {
            [f] => self.instance.calls().call_function(&functions[f], vec![value.clone()], Vec::new(), span),
            _ => self.instance.fail(
                Code::TypeMismatch,
                &format!("there is no operator {name} for {}", value.describe()),
                span,
            ),
        })
    }

    /// Calls the constructor of an operator record that fits the arguments.
    ///
    /// `None` if the record has no own constructors or none fits; the default constructor is used then.
    /// The inner `None` means that a message was reported.
    ///
    /// Constructors with more than one output are reported.
    /// Several constructors that fit are reported as ambiguous.
    ///
    /// ```text
    /// Complex(1, 2)    // the constructor function of the operator record Complex
    /// ```
    /// The type of each argument must be that of its input, with Integers for Reals.
    pub(in crate::instance) fn overloaded_constructor(
        &mut self,
        class: &ClassRef<'a>,
        given: &CallArguments,
        span: Span,
    ) -> Option<Option<ModelicaValue>> {
        let number = self.operator_class(class)?;
        let functions = self.operators(number, "'constructor'");
        if functions.is_empty() {
            return None;
        }
        for f in &functions {
            let outputs = self.instance.calls().formals(f, |c, _| c.prefix.causality == Some(CausalityPrefix::Output));
            if let [_, second, ..] = outputs.as_slice() {
                let at = second.component.name.span;
                let message = format!("the constructor `{}` has more than one output", f.name);
                return Some(self.instance.fail(Code::BadCall, &message, at));
            }
        }
        let mut fitting = Vec::new();
        for (k, f) in functions.iter().enumerate() {
            if self.takes(f, &given.positional, &given.named) {
                fitting.push(k);
            }
        }
        Some(match fitting[..] {
            [f] => {
                self.instance.calls().call_function(&functions[f], given.positional.clone(), given.named.clone(), span)
            }
            [] => return None,
            _ => self.ambiguous("'constructor'", span),
        })
    }

    /// Reports that several functions fit the operands, and returns `None`.
    fn ambiguous(&mut self, name: &str, span: Span) -> Option<ModelicaValue> {
        let d = Diagnostic::new(Code::BadCall, format!("more than one function of {name} takes these arguments"));
        self.instance.report(
            d.at(span, "not clear which").help("let their inputs differ in type or number").note("Modelica 3.6, 14"),
        );
        None
    }

    /// The functions behind an operator of a record class: the operator itself, or all functions in it.
    ///
    /// ```text
    /// operator record Complex
    ///   operator function '+' ... end '+';          // one function
    ///   operator '-' function negate ...; function subtract ...; end '-';   // several
    /// end Complex;
    /// ```
    fn operators(&mut self, class: u32, name: &str) -> Vec<Callee<'a>> {
        let record = LookupResult::Class(self.instance.classes.operator_records[class as usize].clone());
        let Some(found @ LookupResult::Class(_)) = self.instance.names().member(&record, Symbol::new(name)) else {
            return Vec::new();
        };
        let LookupResult::Class(operator) = &found else { return Vec::new() };
        let template = self.instance.names().template(operator.class, operator.parent);
        if matches!(template.kind, ClassKind::Function { .. }) {
            return vec![self.callee(operator)];
        }
        let names: Vec<Symbol> = template.elements.iter().map(|e| e.name).collect();
        let mut functions = Vec::new();
        for name in names {
            if let Some(LookupResult::Class(f)) = self.instance.names().member(&found, name) {
                functions.push(self.callee(&f));
            }
        }
        functions
    }

    /// A function class, ready to be called.
    fn callee(&mut self, class: &ClassRef<'a>) -> Callee<'a> {
        let template = self.instance.names().template(class.class, class.parent);
        Callee {
            scope: self.instance.names().package(class),
            template,
            name: self.instance.library.full_name(class.class),
        }
    }

    /// The indices of the functions whose inputs fit these positional arguments.
    fn fitting(&mut self, functions: &[Callee<'a>], args: &[ModelicaValue]) -> Vec<usize> {
        (0..functions.len()).filter(|&k| self.takes(&functions[k], args, &[])).collect()
    }

    /// Whether a function can be called with these arguments: all fit, and each other input has a default.
    ///
    /// No message is reported: the caller tries several functions.
    /// A named argument must name an input that no positional one has taken.
    /// Sizes of arrays are not compared, only the number of dimensions.
    fn takes(
        &mut self,
        function: &Callee<'a>,
        args: &[ModelicaValue],
        named: &[(bramah_syntax::ast::Ident, ModelicaValue)],
    ) -> bool {
        let inputs = self.instance.calls().formals(function, is_input);
        if args.len() > inputs.len() || named.iter().any(|(n, _)| inputs[args.len()..].iter().all(|f| f.name != n.name))
        {
            return false;
        }
        for (k, f) in inputs.iter().enumerate() {
            let given = args.get(k).or_else(|| named.iter().find(|(n, _)| n.name == f.name).map(|(_, v)| v));
            let fits = match given {
                // An input without an argument must have a default.
                Some(value) => self.fits_input(f, value),
                None => self.instance.names().reached(f.view.scope, f.index).binding.is_some(),
            };
            if !fits {
                return false;
            }
        }
        true
    }

    /// Whether an argument fits an input: same number of dimensions, same type. Integers fit Reals.
    /// For an input of an operator record type the value must have the same class. Other records never fit.
    fn fits_input(&mut self, f: &FormalParameter<'a>, value: &ModelicaValue) -> bool {
        if f.component.subscripts.len() != value.dims().len() {
            return false;
        }
        let element = value.elements().first();
        match self.instance.names().lookup_path(f.view, &f.component.class) {
            Ok(LookupResult::Builtin(b)) => fits_builtin(b, element),
            Ok(LookupResult::Class(c)) => match self.instance.names().template(c.class, c.parent).builtin {
                Some(b) => fits_builtin(b, element),
                None => {
                    let wanted = self.operator_class(&c);
                    wanted.is_some() && wanted == element.and_then(Self::record_class)
                }
            },
            _ => false,
        }
    }

    /// A scalar value as a record of a class, by a constructor that takes it as its only argument (MLS 14.5).
    /// `None` if there is not exactly one such constructor, or the value is a record or an array already.
    fn converted_to(&mut self, value: &ModelicaValue, class: u32, span: Span) -> Option<ModelicaValue> {
        if Self::record_class(value).is_some() || !value.dims().is_empty() {
            return None;
        }
        let functions = self.operators(class, "'constructor'");
        match self.fitting(&functions, std::slice::from_ref(value))[..] {
            [f] => self.instance.calls().call_function(&functions[f], vec![value.clone()], Vec::new(), span),
            _ => None,
        }
    }
}

/// Whether a value fits a predefined type. An Integer fits a Real.
/// An empty array has no element and fits nothing.
fn fits_builtin(wanted: BuiltinType, value: Option<&ModelicaValue>) -> bool {
    match (wanted, value) {
        (BuiltinType::Real, Some(ModelicaValue::Scalar(_, ScalarType::Real | ScalarType::Integer))) => true,
        (BuiltinType::Integer, Some(ModelicaValue::Scalar(_, ScalarType::Integer))) => true,
        (BuiltinType::Boolean, Some(ModelicaValue::Scalar(_, ScalarType::Boolean))) => true,
        (BuiltinType::String, Some(ModelicaValue::Text(_))) => true,
        (BuiltinType::Enumeration(a), Some(ModelicaValue::Scalar(_, ScalarType::Enumeration(b)))) => a == *b,
        _ => false,
    }
}
