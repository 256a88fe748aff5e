//! Which modifier reaches which element: arguments travel from the outermost modification inwards, outer before inner.

use crate::instance::LookupContext;
use bramah_syntax::ast::{self, Expr, Modification, ModificationArgumentKind};
use bramah_syntax::diag::Span;
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

/// A step from the value of a modifier to the part meant for one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AccessStep {
    /// The element of an array.
    Index(ArrayPosition),
    /// The field of a record.
    Field(Symbol),
}

/// A place along one dimension of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ArrayPosition {
    /// Counted from 0.
    pub place: u32,
    /// How many places there are.
    pub of: u32,
}

/// An expression with the place in which its names mean something, and the part of its value that is meant.
#[derive(Clone, Debug)]
pub struct Binding<'a> {
    /// The expression; `None` for a value given from outside.
    pub expr: &'a Expr,
    /// Where its names are looked up.
    pub view: LookupContext,
    /// How to get from its value to the part meant.
    pub access: Rc<[AccessStep]>,
    /// `final`
    pub final_: bool,
}

/// One modification on its way inwards.
#[derive(Clone, Debug)]
pub struct Modifier<'a> {
    /// What it does.
    pub kind: ModifierKind<'a>,
    /// Where its names are looked up.
    pub view: LookupContext,
    /// Indices of the arrays passed through; empty under `each`.
    pub access: Rc<[AccessStep]>,
    /// Under `each`: the arrays on the way to the element it names add no index. What stands in its brackets is free
    /// again, and the element's own dimensions count.
    pub each: bool,
    /// `final`
    pub final_: bool,
    /// Comes with the declaration of a class that was redeclared: what the redeclaration itself says counts more.
    pub default: bool,
    /// Where it stands.
    pub span: Span,
}

/// What a modification does.
#[derive(Clone, Copy, Debug)]
pub enum ModifierKind<'a> {
    /// `a.b(...) = value`
    Modify(&'a [ast::Ident], Option<&'a Modification>),
    /// `redeclare T x`
    Component(&'a ast::ComponentDeclaration),
    /// `redeclare model M = N`
    Class(&'a ast::Class),
}

impl<'a> Modifier<'a> {
    /// The argument of a modification; `None` for `break`, which acts when the class's elements are gathered.
    ///
    /// `each` frees the argument from the indices of all arrays passed through so far.
    pub fn new(
        argument: &'a ast::ModificationArgument,
        view: LookupContext,
        access: &Rc<[AccessStep]>,
        each: bool,
    ) -> Option<Modifier<'a>> {
        let kind = match &argument.kind {
            ModificationArgumentKind::Modify { path, modification, .. } => {
                ModifierKind::Modify(&path.parts, modification.as_ref())
            }
            ModificationArgumentKind::Component(c) => ModifierKind::Component(c),
            ModificationArgumentKind::Class(c) => ModifierKind::Class(c),
            ModificationArgumentKind::BreakComponent(_) | ModificationArgumentKind::BreakConnect(..) => return None,
        };
        Some(Modifier {
            kind,
            view,
            access: if argument.each { Rc::from([]) } else { access.clone() },
            each: each || argument.each,
            final_: argument.final_,
            default: false,
            span: argument.span,
        })
    }

    /// The element it is meant for.
    pub fn target(&self) -> Symbol {
        match self.kind {
            ModifierKind::Modify(path, _) => path[0].name,
            ModifierKind::Component(c) => c.name.name,
            ModifierKind::Class(c) => c.name.name,
        }
    }

    /// True when it names exactly this element, not something inside it.
    pub fn ends_here(&self) -> bool {
        !matches!(self.kind, ModifierKind::Modify(path, _) if path.len() > 1)
    }
}

/// What reaches one element: arguments for its inside, outermost first, and its value.
#[derive(Clone, Debug, Default)]
pub struct ElementModifiers<'a> {
    /// Modifications of its elements or attributes, outermost first.
    pub args: Vec<Modifier<'a>>,
    /// Its value.
    pub binding: Option<Binding<'a>>,
    /// `break` as value removed the binding.
    pub no_binding: bool,
    /// The outermost redeclaration of it.
    pub redeclare: Option<(ModifierKind<'a>, LookupContext, Rc<[AccessStep]>, bool)>,
    /// All of them, outermost first, with where their names are looked up.
    pub redeclarations: Vec<(ModifierKind<'a>, LookupContext)>,
    /// A `final` modification reached it, from here on outer ones are errors.
    pub final_: bool,
    /// Where the value was given.
    pub span: Option<Span>,
}

impl<'a> ElementModifiers<'a> {
    /// Takes a modification that was found for this element; call outermost first.
    pub fn take(&mut self, arg: &Modifier<'a>) {
        match arg.kind {
            ModifierKind::Modify(path, modification) if path.len() > 1 => {
                let kind = ModifierKind::Modify(&path[1..], modification);
                self.args.push(Modifier { kind, default: false, ..arg.clone() });
            }
            ModifierKind::Modify(_, Some(m)) => {
                self.modification(m, arg.view, &arg.access, false, arg.final_, arg.span)
            }
            ModifierKind::Modify(_, None) => self.final_ |= arg.final_,
            ModifierKind::Component(_) | ModifierKind::Class(_) => {
                let outermost = self.redeclare.is_none();
                self.redeclarations.push((arg.kind, arg.view));
                if outermost {
                    self.redeclare = Some((arg.kind, arg.view, arg.access.clone(), arg.each));
                }
                // what a redeclaration says of its constraint holds for whatever takes its place
                let constraint = match arg.kind {
                    ModifierKind::Component(c) => c.constraint.as_ref(),
                    _ => None,
                };
                if let Some(m) = constraint.and_then(|c| c.modification.as_ref()) {
                    self.modification(m, arg.view, &arg.access, false, arg.final_, arg.span);
                }
                if let ModifierKind::Component(c) = arg.kind
                    && let Some(m) = c.modification.as_ref().filter(|_| outermost || constraint.is_none())
                {
                    self.modification(m, arg.view, &arg.access, false, arg.final_, arg.span);
                }
            }
        }
    }

    /// Takes a whole modification `(...) = value` for this element.
    pub fn modification(
        &mut self,
        m: &'a Modification,
        view: LookupContext,
        access: &Rc<[AccessStep]>,
        each: bool,
        final_: bool,
        span: Span,
    ) {
        self.args.extend(m.arguments.iter().filter_map(|a| Modifier::new(a, view, access, each)));
        self.final_ |= final_;
        if self.binding.is_some() || self.no_binding {
            return;
        }
        self.no_binding = m.break_value;
        if let Some(expr) = &m.value {
            self.binding = Some(Binding { expr, view, access: access.clone(), final_ });
            self.span = Some(span);
        }
    }
}

/// Adds an array index to the arguments and value meant for one element of an array.
pub fn indexed<'a>(args: &[Modifier<'a>], index: &[ArrayPosition]) -> Rc<[Modifier<'a>]> {
    let extend = |a: &Modifier<'a>| {
        if a.each { a.clone() } else { Modifier { access: extended(&a.access, index), ..a.clone() } }
    };
    args.iter().map(extend).collect()
}

/// Appends indices to an access path.
pub fn extended(access: &Rc<[AccessStep]>, index: &[ArrayPosition]) -> Rc<[AccessStep]> {
    if index.is_empty() {
        return access.clone();
    }
    access.iter().copied().chain(index.iter().map(|&i| AccessStep::Index(i))).collect()
}
