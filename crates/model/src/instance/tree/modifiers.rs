//! Modifiers on their way from the outside inwards, and what one element receives of them.
//!
//! A component `C c(a.b = 1, redeclare M m)` gives its scope two [`Modifier`]s. Each element of the scope takes those
//! that name it: [`ElementModifiers::take`] removes one part of the name and passes the rest on, or keeps the value.
//! The order is always outermost first, and the first value wins (MLS 7.2.4).
//! [`NameLookup::reached`](crate::instance::NameLookup::reached) is the caller.

use crate::instance::LookupContext;
use bramah_syntax::ast::{self, Expr, Modification, ModificationArgumentKind};
use bramah_syntax::diag::Span;
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

/// A step from the value of a modifier to the part for one element.
/// In `A a[2](x = {1, 2})` the element `a[2].x` takes the value at index 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AccessStep {
    /// One element along the first remaining dimension of an array.
    Index(ArrayPosition),
    /// One field of a record.
    Field(Symbol),
}

/// A position along one dimension of an array, with the size that the value must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ArrayPosition {
    /// The position, counted from 0.
    pub place: u32,
    /// The size of the dimension.
    pub of: u32,
}

/// An expression with the place to look up its names, and the part of its value that is meant.
#[derive(Clone, Debug)]
pub struct Binding<'a> {
    /// The expression as written.
    pub expr: &'a Expr,
    /// Where its names are looked up.
    pub view: LookupContext,
    /// The steps from its value to the part meant, in order. Empty if the complete value is meant.
    pub access: Rc<[AccessStep]>,
    /// Given by a `final` modifier.
    pub final_: bool,
}

/// One modifier on its way inwards.
#[derive(Clone, Debug)]
pub struct Modifier<'a> {
    /// What it modifies and how.
    pub kind: ModifierKind<'a>,
    /// Where its names are looked up.
    pub view: LookupContext,
    /// The steps to take from its values to the part for this element: one for each array dimension passed through.
    /// Empty under `each`, so that all elements get the same value.
    pub access: Rc<[AccessStep]>,
    /// Written with `each` (MLS 7.2.5): the arrays on the way to the element add no index.
    /// Modifiers inside its parentheses, and the element's own dimensions, are indexed as usual.
    pub each: bool,
    /// Written with `final`.
    pub final_: bool,
    /// Comes with the declaration of a class that was redeclared. Modifiers of the redeclaration itself come before it.
    pub default: bool,
    /// Where it stands, for messages.
    pub span: Span,
}

/// What a modification does.
#[derive(Clone, Copy, Debug)]
pub enum ModifierKind<'a> {
    /// `a.b(...) = value`: the parts of the name that are left, and the modification.
    Modify(&'a [ast::Ident], Option<&'a Modification>),
    /// `redeclare T x`, a component redeclaration.
    Component(&'a ast::ComponentDeclaration),
    /// `redeclare model M = N`, a class redeclaration.
    Class(&'a ast::Class),
}

impl<'a> Modifier<'a> {
    /// Makes a modifier from an argument of a modification.
    ///
    /// `None` for `break`, which is applied while the elements of a class are gathered.
    /// `each` passes on that an enclosing modifier has `each`: the arrays passed through then add no index.
    ///
    /// `view` is the place of the modification. `access` are the array indices passed so far, which `each` on the
    /// argument itself drops: `A a[2](each x = 1)` gives both elements 1.
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

    /// The name of the element that it is for: the first part of what is left.
    pub fn target(&self) -> Symbol {
        match self.kind {
            ModifierKind::Modify(path, _) => path[0].name,
            ModifierKind::Component(c) => c.name.name,
            ModifierKind::Class(c) => c.name.name,
        }
    }

    /// True if it modifies this element itself, not something inside of it.
    pub fn ends_here(&self) -> bool {
        !matches!(self.kind, ModifierKind::Modify(path, _) if path.len() > 1)
    }
}

/// What reaches one element: modifiers for its inside, and its value.
#[derive(Clone, Debug, Default)]
pub struct ElementModifiers<'a> {
    /// Modifiers of its elements or attributes, outermost first.
    pub args: Vec<Modifier<'a>>,
    /// Its value. The outermost modifier that has one wins.
    pub binding: Option<Binding<'a>>,
    /// `x = break` removed the value: modifiers further in must not give one.
    pub no_binding: bool,
    /// Its outermost redeclaration: syntax, place to look up names, steps to its values, and whether it has `each`.
    pub redeclare: Option<(ModifierKind<'a>, LookupContext, Rc<[AccessStep]>, bool)>,
    /// All its redeclarations, outermost first, each with the place to look up its names.
    pub redeclarations: Vec<(ModifierKind<'a>, LookupContext)>,
    /// A `final` modifier or declaration reached it, so it cannot be changed from outside.
    pub final_: bool,
    /// Where the value was given.
    pub span: Option<Span>,
}

impl<'a> ElementModifiers<'a> {
    /// Takes a modifier that names this element. Call it with the outermost modifier first.
    ///
    /// What is done depends on its form:
    /// - `x.y = 1` goes on to the inside of the element, as `y = 1`.
    /// - `x(y = 1) = 2` is split into modifiers for the inside and a value.
    /// - `final x` alone only marks the element as final.
    /// - `redeclare T x(...)` is noted, and its own modifiers and those of its constraint are taken.
    ///
    /// ```text
    /// C c(x.y = 1, final z = 2);   // for x: y = 1; for z: the value 2, and final
    /// ```
    pub fn take(&mut self, arg: &Modifier<'a>) {
        match arg.kind {
            // `a.b = 1` at `a`: one part of the name is used up, the rest is for an element inside.
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
                // The modifiers of `constrainedby` in a redeclaration hold for whatever redeclares the element again
                // (MLS 7.3.2).
                let constraint = match arg.kind {
                    ModifierKind::Component(c) => c.constraint.as_ref(),
                    _ => None,
                };
                if let Some(m) = constraint.and_then(|c| c.modification.as_ref()) {
                    self.modification(m, arg.view, &arg.access, false, arg.final_, arg.span);
                }
                // A redeclaration that another one further out replaces loses its modifiers if its `constrainedby` has
                // some.
                if let ModifierKind::Component(c) = arg.kind
                    && let Some(m) = c.modification.as_ref().filter(|_| outermost || constraint.is_none())
                {
                    self.modification(m, arg.view, &arg.access, false, arg.final_, arg.span);
                }
            }
        }
    }

    /// Takes a modification `(...) = value` that is for this element itself.
    ///
    /// `access` and `each` describe the arrays passed on the way, as in [`Modifier`].
    /// `span` is where the value stands. With `x = break` the element loses the value further in.
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
        // Modifiers come outermost first, so the value that is there already wins (MLS 7.2.4).
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

/// Adds array indices to modifiers, for one element of an array. Modifiers with `each` stay as they are.
pub fn indexed<'a>(args: &[Modifier<'a>], index: &[ArrayPosition]) -> Rc<[Modifier<'a>]> {
    let extend = |a: &Modifier<'a>| {
        if a.each { a.clone() } else { Modifier { access: extended(&a.access, index), ..a.clone() } }
    };
    args.iter().map(extend).collect()
}

/// Appends array indices to a list of steps.
pub fn extended(access: &Rc<[AccessStep]>, index: &[ArrayPosition]) -> Rc<[AccessStep]> {
    if index.is_empty() {
        return access.clone();
    }
    access.iter().copied().chain(index.iter().map(|&i| AccessStep::Index(i))).collect()
}
