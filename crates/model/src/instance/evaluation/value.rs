//! What an expression of the language evaluates to: scalars over the pool, arrays, records, texts.

use bramah_expr::types::{MessagePart, Type};
use bramah_expr::{ExprId, Exprs};
use bramah_external::Object;
use bramah_syntax::ast::Ident;
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

/// A value.
#[derive(Clone, Debug)]
pub enum Val {
    /// A number, truth value or enumeration value, known or symbolic.
    Scalar(ExprId, Type),
    /// A text, possibly with values in it.
    Text(Rc<Vec<MessagePart>>),
    /// An array, row-major; elements are not arrays.
    Array {
        /// Sizes.
        dims: Vec<usize>,
        /// Elements.
        elements: Rc<Vec<Val>>,
    },
    /// A record.
    Record(Rc<Record>),
    /// Several outputs of a function.
    Tuple(Rc<Vec<Val>>),
    /// What a constructor of an external object made.
    Object(Object),
    /// A function given as an argument: its number in the instance, and inputs that it was given already.
    Function(u32, Rc<Vec<(Ident, Val)>>),
}

/// A record: its fields, and the class of an operator record among those of the instance.
#[derive(Clone, Debug)]
pub struct Record {
    /// Names and values in the order of their declaration.
    pub fields: Vec<(Symbol, Val)>,
    /// Number of its class, for an operator record.
    pub class: Option<u32>,
}

impl Val {
    /// A text without values.
    pub fn text(words: impl Into<String>) -> Val {
        Val::Text(Rc::new(vec![MessagePart::Text(words.into())]))
    }

    /// An array.
    pub fn array(dims: Vec<usize>, elements: Vec<Val>) -> Val {
        debug_assert_eq!(dims.iter().product::<usize>(), elements.len());
        Val::Array { dims, elements: Rc::new(elements) }
    }

    /// Sizes; none for anything but arrays.
    pub fn dims(&self) -> &[usize] {
        match self {
            Val::Array { dims, .. } => dims,
            _ => &[],
        }
    }

    /// The elements in row-major order; a scalar is its own only element.
    pub fn elements(&self) -> &[Val] {
        match self {
            Val::Array { elements, .. } => elements,
            other => std::slice::from_ref(other),
        }
    }

    /// The scalar expression and its type.
    pub fn scalar(&self) -> Option<(ExprId, Type)> {
        match self {
            Val::Scalar(e, ty) => Some((*e, *ty)),
            _ => None,
        }
    }

    /// The number, if known.
    pub fn as_number(&self, exprs: &Exprs) -> Option<f64> {
        exprs.as_num(self.scalar()?.0)
    }

    /// The words, if it is a text without symbolic values.
    pub fn as_text(&self, exprs: &Exprs) -> Option<String> {
        let Val::Text(parts) = self else { return None };
        parts.iter().map(|part| words(part, exprs)).collect()
    }

    /// A text for messages, with `...` for values that are not known.
    pub fn in_words(&self, exprs: &Exprs) -> String {
        let Val::Text(parts) = self else { return String::new() };
        parts.iter().map(|part| words(part, exprs).unwrap_or_else(|| "...".to_owned())).collect()
    }

    /// The type of the first scalar inside.
    pub fn element_type(&self) -> Option<Type> {
        match self {
            Val::Scalar(_, ty) => Some(*ty),
            Val::Array { elements, .. } => elements.first().and_then(Val::element_type),
            _ => None,
        }
    }

    /// A few words for messages: "a Real", "an array of size 3", "a record".
    pub fn describe(&self) -> String {
        match self {
            Val::Scalar(_, Type::Real) => "a Real".into(),
            Val::Scalar(_, Type::Integer) => "an Integer".into(),
            Val::Scalar(_, Type::Boolean) => "a Boolean".into(),
            Val::Scalar(_, Type::Enumeration(_)) => "an enumeration value".into(),
            Val::Text(_) => "a String".into(),
            Val::Array { dims, .. } => format!("an array of size {}", size_text(dims)),
            Val::Record(_) => "a record".into(),
            Val::Tuple(_) => "several values".into(),
            Val::Object(_) => "an external object".into(),
            Val::Function(..) => "a function".into(),
        }
    }

    /// The value itself, or the first of several outputs.
    pub fn first_output(&self) -> Val {
        match self {
            Val::Tuple(values) => values.first().unwrap_or(self).clone(),
            other => other.clone(),
        }
    }

    /// All scalars in order.
    pub fn all_scalars(&self) -> Vec<ExprId> {
        let mut found = Vec::new();
        self.scalars(&mut found);
        found
    }

    /// All scalars inside, in order.
    pub fn scalars(&self, out: &mut Vec<ExprId>) {
        match self {
            Val::Scalar(e, _) => out.push(*e),
            Val::Array { elements, .. } => elements.iter().for_each(|v| v.scalars(out)),
            Val::Record(record) => record.fields.iter().for_each(|(_, v)| v.scalars(out)),
            Val::Tuple(values) => values.iter().for_each(|v| v.scalars(out)),
            Val::Function(_, bound) => bound.iter().for_each(|(_, v)| v.scalars(out)),
            Val::Text(_) | Val::Object(_) => {}
        }
    }

    /// The same shape with other scalars.
    pub fn map(&self, change: &mut impl FnMut(ExprId, Type) -> ExprId) -> Val {
        match self {
            Val::Scalar(e, ty) => Val::Scalar(change(*e, *ty), *ty),
            Val::Array { dims, elements } => {
                Val::Array { dims: dims.clone(), elements: Rc::new(elements.iter().map(|v| v.map(change)).collect()) }
            }
            Val::Record(record) => {
                let fields = record.fields.iter().map(|(n, v)| (*n, v.map(change))).collect();
                Val::Record(Rc::new(Record { fields, class: record.class }))
            }
            Val::Tuple(values) => Val::Tuple(Rc::new(values.iter().map(|v| v.map(change)).collect())),
            Val::Function(f, bound) => {
                Val::Function(*f, Rc::new(bound.iter().map(|(n, v)| (*n, v.map(change))).collect()))
            }
            Val::Text(_) | Val::Object(_) => self.clone(),
        }
    }

    /// Combines two values of equal shape scalar by scalar; `None` if the shapes differ.
    pub fn zip(&self, other: &Val, combine: &mut impl FnMut(ExprId, ExprId, Type) -> ExprId) -> Option<Val> {
        Some(match (self, other) {
            (Val::Scalar(a, ta), Val::Scalar(b, tb)) => {
                let ty = wider(*ta, *tb)?;
                Val::Scalar(combine(*a, *b, ty), ty)
            }
            (Val::Array { dims: da, elements: a }, Val::Array { dims: db, elements: b }) if da == db => {
                let elements: Option<Vec<_>> = a.iter().zip(b.iter()).map(|(a, b)| a.zip(b, combine)).collect();
                Val::array(da.clone(), elements?)
            }
            (Val::Record(a), Val::Record(b)) if a.fields.len() == b.fields.len() => {
                let mut fields = Vec::with_capacity(a.fields.len());
                for (name, value) in &a.fields {
                    let (_, other) = b.fields.iter().find(|(n, _)| n == name)?;
                    fields.push((*name, value.zip(other, combine)?));
                }
                Val::Record(Rc::new(Record { fields, class: a.class }))
            }
            (Val::Tuple(a), Val::Tuple(b)) if a.len() == b.len() => {
                let values: Option<Vec<_>> = a.iter().zip(b.iter()).map(|(a, b)| a.zip(b, combine)).collect();
                Val::Tuple(Rc::new(values?))
            }
            (Val::Function(f, a), Val::Function(g, b)) if f == g && a.len() == b.len() => {
                let both: Option<Vec<_>> =
                    a.iter().zip(b.iter()).map(|((n, a), (_, b))| Some((*n, a.zip(b, combine)?))).collect();
                Val::Function(*f, Rc::new(both?))
            }
            (Val::Text(a), Val::Text(b)) if a == b => Val::Text(a.clone()),
            _ => return None,
        })
    }

    /// A sub-array by the first index, or the element of a vector.
    pub fn slice(&self, i: usize) -> Option<Val> {
        let Val::Array { dims, elements } = self else { return None };
        let inner = &dims[1..];
        let step: usize = inner.iter().product();
        if i >= dims[0] {
            return None;
        }
        if inner.is_empty() {
            return elements.get(i).cloned();
        }
        Some(Val::array(inner.to_vec(), elements[i * step..(i + 1) * step].to_vec()))
    }
}

/// The common type of two scalars: Integer fits where Real is needed.
pub fn wider(a: Type, b: Type) -> Option<Type> {
    match (a, b) {
        (a, b) if a == b => Some(a),
        (Type::Real, Type::Integer) | (Type::Integer, Type::Real) => Some(Type::Real),
        _ => None,
    }
}

/// Stacks values of equal shape into an array with one more dimension.
pub fn stack(values: Vec<Val>) -> Option<Val> {
    let inner = values.first().map_or(Vec::new(), |v| v.dims().to_vec());
    if values.iter().any(|v| v.dims() != inner) {
        return None;
    }
    let mut dims = vec![values.len()];
    dims.extend(&inner);
    let elements: Vec<Val> = values.iter().flat_map(|v| v.elements().iter().cloned()).collect();
    Some(Val::array(dims, unify(elements)))
}

/// Integers among Reals become Reals.
fn unify(mut elements: Vec<Val>) -> Vec<Val> {
    let real = elements.iter().any(|v| matches!(v, Val::Scalar(_, Type::Real)));
    if real {
        for v in &mut elements {
            if let Val::Scalar(_, ty @ Type::Integer) = v {
                *ty = Type::Real;
            }
        }
    }
    elements
}

/// `[2, 3]`
pub fn size_text(dims: &[usize]) -> String {
    let parts: Vec<String> = dims.iter().map(usize::to_string).collect();
    format!("[{}]", parts.join(", "))
}

impl Val {
    /// Numbers of the wider of their own and the given type.
    pub(in crate::instance) fn with_type(&self, ty: Type) -> Val {
        match self {
            Val::Scalar(e, own) => Val::Scalar(*e, wider(*own, ty).unwrap_or(*own)),
            Val::Array { dims, elements } => {
                Val::array(dims.clone(), elements.iter().map(|v| v.with_type(ty)).collect())
            }
            other => other.clone(),
        }
    }
}

/// A part of a text, where its value is known.
fn words(part: &MessagePart, exprs: &Exprs) -> Option<String> {
    match part {
        MessagePart::Text(words) => Some(words.clone()),
        MessagePart::Value(e, ty) => {
            let x = exprs.as_num(*e)?;
            Some(match ty {
                Type::Boolean => if x == 0.0 { "false" } else { "true" }.to_owned(),
                _ => bramah_expr::print::number(x, Some(6)),
            })
        }
    }
}
