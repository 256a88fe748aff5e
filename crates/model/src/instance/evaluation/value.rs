//! Values of expressions: scalars in the expression pool, arrays, records, texts.
//!
//! The evaluator, the operators and the calls make [`ModelicaValue`]s. `flat` splits them into scalar equations.
//! A scalar is always an index into the pool [`Exprs`]; a known number is a constant node there.

use bramah_expr::types::{MessagePart, ScalarType};
use bramah_expr::{ExprId, Exprs};
use bramah_external::ExternalObject;
use bramah_syntax::ast::Ident;
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

/// A value. Cloning is cheap: arrays and records are shared.
#[derive(Clone, Debug)]
pub enum ModelicaValue {
    /// A number, truth value or enumeration value with its type, known or symbolic. Truth values are 0 and 1.
    Scalar(ExprId, ScalarType),
    /// A String, as literal pieces and values to be inserted.
    Text(Rc<Vec<MessagePart>>),
    /// An array in row-major order. Its elements are no arrays themselves.
    Array {
        /// The size along each dimension.
        dims: Vec<usize>,
        /// As many elements as the product of the sizes.
        elements: Rc<Vec<ModelicaValue>>,
    },
    /// A record with its fields.
    Record(Rc<RecordValue>),
    /// All outputs of a function, in the order of their declaration.
    Tuple(Rc<Vec<ModelicaValue>>),
    /// The result of the constructor of an external object (MLS 12.9.7).
    Object(ExternalObject),
    /// A function passed as an argument: its number in the instance, and the inputs bound by partial application (MLS
    /// 12.4.2.1).
    Function(u32, Rc<Vec<(Ident, ModelicaValue)>>),
}

/// A record value.
#[derive(Clone, Debug)]
pub struct RecordValue {
    /// Names and values of the fields, in the order of their declaration.
    pub fields: Vec<(Symbol, ModelicaValue)>,
    /// The class of an operator record: index into the list of the instance. `None` for other records.
    pub class: Option<u32>,
}

impl ModelicaValue {
    /// A String literal.
    pub fn text(words: impl Into<String>) -> ModelicaValue {
        ModelicaValue::Text(Rc::new(vec![MessagePart::Text(words.into())]))
    }

    /// An array of elements in row-major order.
    pub fn array(dims: Vec<usize>, elements: Vec<ModelicaValue>) -> ModelicaValue {
        debug_assert_eq!(dims.iter().product::<usize>(), elements.len());
        ModelicaValue::Array { dims, elements: Rc::new(elements) }
    }

    /// The sizes of an array; empty for anything else.
    pub fn dims(&self) -> &[usize] {
        match self {
            ModelicaValue::Array { dims, .. } => dims,
            _ => &[],
        }
    }

    /// The elements in row-major order. Anything but an array is its own only element.
    pub fn elements(&self) -> &[ModelicaValue] {
        match self {
            ModelicaValue::Array { elements, .. } => elements,
            other => std::slice::from_ref(other),
        }
    }

    /// The expression and its type. `None` for anything but a scalar.
    pub fn scalar(&self) -> Option<(ExprId, ScalarType)> {
        match self {
            ModelicaValue::Scalar(e, ty) => Some((*e, *ty)),
            _ => None,
        }
    }

    /// The number of a scalar that is known. `None` for symbolic scalars and other values.
    pub fn as_number(&self, exprs: &Exprs) -> Option<f64> {
        exprs.as_num(self.scalar()?.0)
    }

    /// The characters of a String that contains no symbolic values. `None` otherwise.
    pub fn as_text(&self, exprs: &Exprs) -> Option<String> {
        let ModelicaValue::Text(parts) = self else { return None };
        parts.iter().map(|part| words(part, exprs)).collect()
    }

    /// A String for messages, with `...` for values that are not known.
    pub fn in_words(&self, exprs: &Exprs) -> String {
        let ModelicaValue::Text(parts) = self else { return String::new() };
        parts.iter().map(|part| words(part, exprs).unwrap_or_else(|| "...".to_owned())).collect()
    }

    /// The type of the first scalar inside. `None` for empty arrays, Strings and records.
    pub fn element_type(&self) -> Option<ScalarType> {
        match self {
            ModelicaValue::Scalar(_, ty) => Some(*ty),
            ModelicaValue::Array { elements, .. } => elements.first().and_then(ModelicaValue::element_type),
            _ => None,
        }
    }

    /// A description for messages: "a Real", "an array of size `[3]`", "a record".
    /// It tells the kind and, for arrays, the size. It does not show the value itself.
    pub fn describe(&self) -> String {
        match self {
            ModelicaValue::Scalar(_, ScalarType::Real) => "a Real".into(),
            ModelicaValue::Scalar(_, ScalarType::Integer) => "an Integer".into(),
            ModelicaValue::Scalar(_, ScalarType::Boolean) => "a Boolean".into(),
            ModelicaValue::Scalar(_, ScalarType::Enumeration(_)) => "an enumeration value".into(),
            ModelicaValue::Text(_) => "a String".into(),
            ModelicaValue::Array { dims, .. } => format!("an array of size {}", size_text(dims)),
            ModelicaValue::Record(_) => "a record".into(),
            ModelicaValue::Tuple(_) => "several values".into(),
            ModelicaValue::Object(_) => "an external object".into(),
            ModelicaValue::Function(..) => "a function".into(),
        }
    }

    /// The value itself, or the first one of several outputs.
    pub fn first_output(&self) -> ModelicaValue {
        match self {
            ModelicaValue::Tuple(values) => values.first().unwrap_or(self).clone(),
            other => other.clone(),
        }
    }

    /// All scalars inside, in order.
    pub fn all_scalars(&self) -> Vec<ExprId> {
        let mut found = Vec::new();
        self.scalars(&mut found);
        found
    }

    /// Appends all scalars inside to `out`: arrays in row-major order, fields in declaration order.
    /// Strings and external objects have none. Bound inputs of a function value count.
    pub fn scalars(&self, out: &mut Vec<ExprId>) {
        match self {
            ModelicaValue::Scalar(e, _) => out.push(*e),
            ModelicaValue::Array { elements, .. } => elements.iter().for_each(|v| v.scalars(out)),
            ModelicaValue::Record(record) => record.fields.iter().for_each(|(_, v)| v.scalars(out)),
            ModelicaValue::Tuple(values) => values.iter().for_each(|v| v.scalars(out)),
            ModelicaValue::Function(_, bound) => bound.iter().for_each(|(_, v)| v.scalars(out)),
            ModelicaValue::Text(_) | ModelicaValue::Object(_) => {}
        }
    }

    /// A value of the same shape in which `change` has replaced each scalar. Strings stay as they are.
    ///
    /// Types are kept. It walks through arrays, records, tuples and the bound inputs of functions, in the order of
    /// [`Self::scalars`].
    pub fn map(&self, change: &mut impl FnMut(ExprId, ScalarType) -> ExprId) -> ModelicaValue {
        match self {
            ModelicaValue::Scalar(e, ty) => ModelicaValue::Scalar(change(*e, *ty), *ty),
            ModelicaValue::Array { dims, elements } => ModelicaValue::Array {
                dims: dims.clone(),
                elements: Rc::new(elements.iter().map(|v| v.map(change)).collect()),
            },
            ModelicaValue::Record(record) => {
                let fields = record.fields.iter().map(|(n, v)| (*n, v.map(change))).collect();
                ModelicaValue::Record(Rc::new(RecordValue { fields, class: record.class }))
            }
            ModelicaValue::Tuple(values) => {
                ModelicaValue::Tuple(Rc::new(values.iter().map(|v| v.map(change)).collect()))
            }
            ModelicaValue::Function(f, bound) => {
                ModelicaValue::Function(*f, Rc::new(bound.iter().map(|(n, v)| (*n, v.map(change))).collect()))
            }
            ModelicaValue::Text(_) | ModelicaValue::Object(_) => self.clone(),
        }
    }

    /// Combines two values of equal shape scalar by scalar. `None` if their shapes or types do not fit.
    ///
    /// `combine` gets both scalars and their common type, and its result has that type.
    /// - Arrays must have the same sizes, tuples the same length, functions the same number.
    /// - Records must have the same field names; the class of the left one is kept.
    /// - Strings must be equal.
    ///
    /// `None` is no error by itself: the caller reports the difference in its own words.
    pub fn zip(
        &self,
        other: &ModelicaValue,
        combine: &mut impl FnMut(ExprId, ExprId, ScalarType) -> ExprId,
    ) -> Option<ModelicaValue> {
        Some(match (self, other) {
            (ModelicaValue::Scalar(a, ta), ModelicaValue::Scalar(b, tb)) => {
                let ty = wider(*ta, *tb)?;
                ModelicaValue::Scalar(combine(*a, *b, ty), ty)
            }
            (ModelicaValue::Array { dims: da, elements: a }, ModelicaValue::Array { dims: db, elements: b })
                if da == db =>
            {
                let elements: Option<Vec<_>> = a.iter().zip(b.iter()).map(|(a, b)| a.zip(b, combine)).collect();
                ModelicaValue::array(da.clone(), elements?)
            }
            (ModelicaValue::Record(a), ModelicaValue::Record(b)) if a.fields.len() == b.fields.len() => {
                let mut fields = Vec::with_capacity(a.fields.len());
                for (name, value) in &a.fields {
                    // Fields are matched by name: two records may declare them in different orders.
                    let (_, other) = b.fields.iter().find(|(n, _)| n == name)?;
                    fields.push((*name, value.zip(other, combine)?));
                }
                ModelicaValue::Record(Rc::new(RecordValue { fields, class: a.class }))
            }
            (ModelicaValue::Tuple(a), ModelicaValue::Tuple(b)) if a.len() == b.len() => {
                let values: Option<Vec<_>> = a.iter().zip(b.iter()).map(|(a, b)| a.zip(b, combine)).collect();
                ModelicaValue::Tuple(Rc::new(values?))
            }
            (ModelicaValue::Function(f, a), ModelicaValue::Function(g, b)) if f == g && a.len() == b.len() => {
                let both: Option<Vec<_>> =
                    a.iter().zip(b.iter()).map(|((n, a), (_, b))| Some((*n, a.zip(b, combine)?))).collect();
                ModelicaValue::Function(*f, Rc::new(both?))
            }
            // Strings cannot be combined; equal ones stay as they are.
            (ModelicaValue::Text(a), ModelicaValue::Text(b)) if a == b => ModelicaValue::Text(a.clone()),
            _ => return None,
        })
    }

    /// The element at first index `i` (from 0): `a[i + 1, :, ...]`. `None` out of bounds, or for anything but an array.
    /// For `a` of size `[2, 3]` the slice at 0 is the row `a[1, :]` of size `[3]`.
    pub fn slice(&self, i: usize) -> Option<ModelicaValue> {
        let ModelicaValue::Array { dims, elements } = self else { return None };
        // Only the first dimension is indexed; the others form the result.
        let inner = &dims[1..];
        let step: usize = inner.iter().product();
        if i >= dims[0] {
            return None;
        }
        if inner.is_empty() {
            return elements.get(i).cloned();
        }
        Some(ModelicaValue::array(inner.to_vec(), elements[i * step..(i + 1) * step].to_vec()))
    }
}

/// The common type of two scalars. An Integer fits where a Real is needed (MLS 10.6.13). `None` if they do not fit.
pub fn wider(a: ScalarType, b: ScalarType) -> Option<ScalarType> {
    match (a, b) {
        (a, b) if a == b => Some(a),
        (ScalarType::Real, ScalarType::Integer) | (ScalarType::Integer, ScalarType::Real) => Some(ScalarType::Real),
        _ => None,
    }
}

/// Stacks values of equal shape into an array with one more dimension, in front. `None` if their shapes differ.
/// Used for array constructors `{a, b}` and for results of vectorized calls. No values give an empty vector.
pub fn stack(values: Vec<ModelicaValue>) -> Option<ModelicaValue> {
    let inner = values.first().map_or(Vec::new(), |v| v.dims().to_vec());
    if values.iter().any(|v| v.dims() != inner) {
        return None;
    }
    let mut dims = vec![values.len()];
    dims.extend(&inner);
    let elements: Vec<ModelicaValue> = values.iter().flat_map(|v| v.elements().iter().cloned()).collect();
    Some(ModelicaValue::array(dims, unify(elements)))
}

/// Turns Integers into Reals if there is a Real among the elements.
/// `{1, 2.5}` is an array of two Reals (MLS 10.4).
fn unify(mut elements: Vec<ModelicaValue>) -> Vec<ModelicaValue> {
    let real = elements.iter().any(|v| matches!(v, ModelicaValue::Scalar(_, ScalarType::Real)));
    if real {
        for v in &mut elements {
            if let ModelicaValue::Scalar(_, ty @ ScalarType::Integer) = v {
                *ty = ScalarType::Real;
            }
        }
    }
    elements
}

/// Sizes for messages: `[2, 3]`.
pub fn size_text(dims: &[usize]) -> String {
    let parts: Vec<String> = dims.iter().map(usize::to_string).collect();
    format!("[{}]", parts.join(", "))
}

impl ModelicaValue {
    /// The value with each scalar in the wider of its own and the given type.
    /// An Integer becomes a Real if `ty` is Real; all other types stay.
    pub(in crate::instance) fn with_type(&self, ty: ScalarType) -> ModelicaValue {
        match self {
            ModelicaValue::Scalar(e, own) => ModelicaValue::Scalar(*e, wider(*own, ty).unwrap_or(*own)),
            ModelicaValue::Array { dims, elements } => {
                ModelicaValue::array(dims.clone(), elements.iter().map(|v| v.with_type(ty)).collect())
            }
            other => other.clone(),
        }
    }
}

/// One piece of a String as characters. `None` if it is a value that is not known.
/// Numbers are written with six digits, Booleans as `true` and `false`, enumeration values as numbers.
fn words(part: &MessagePart, exprs: &Exprs) -> Option<String> {
    match part {
        MessagePart::Text(words) => Some(words.clone()),
        MessagePart::Value(e, ty) => {
            let x = exprs.as_num(*e)?;
            Some(match ty {
                ScalarType::Boolean => if x == 0.0 { "false" } else { "true" }.to_owned(),
                _ => bramah_expr::print::number(x, Some(6)),
            })
        }
    }
}
