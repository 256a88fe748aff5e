//! Checks of redeclared components: the replacement must be a subtype of the constraining class (MLS 6.4, 7.3).
//!
//! Only the existence of public elements is compared, not their types. Redeclared classes are checked in `lookup`, with
//! the same [`ComponentBuilder::check_subtype`].

use crate::instance::lookup::LookupResult;
use crate::instance::modifiers::ModifierKind;
use crate::instance::{ComponentBuilder, LookupContext};
use bramah_syntax::ast::{self};
use bramah_syntax::diag::{Code, Diagnostic, Span};

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// Checks a redeclaration of a component against the declaration.
    ///
    /// The declaration must be `replaceable` and not constant, and the class must fit its constraining class (MLS 7.3).
    /// `component` is the outermost redeclaration, `found` its class.
    /// A redeclaration that is an element of a class is checked where its elements are gathered.
    /// The messages show both declarations.
    pub(in crate::instance) fn check_redeclaration(
        &mut self,
        declared: &'a ast::ComponentDeclaration,
        own: LookupContext,
        component: &'a ast::ComponentDeclaration,
        found: &LookupResult<'a>,
    ) {
        // Without a redeclaration the builder passes the declaration itself.
        if std::ptr::eq(declared, component) {
            return;
        }
        if !declared.prefixes.replaceable && !component.prefixes.redeclare {
            return;
        }
        if !declared.prefixes.replaceable {
            self.instance.report(
                Diagnostic::new(Code::BadRedeclare, format!("`{}` is not replaceable", declared.name.name))
                    .at(component.name.span, "redeclared here")
                    .at(declared.name.span, "declared without `replaceable`")
                    .help(format!("write `replaceable` before the declaration of `{}`", declared.name.name)),
            );
            return;
        }
        if declared.prefix.variability == Some(ast::VariabilityPrefix::Constant) {
            self.instance.report(
                Diagnostic::new(
                    Code::BadRedeclare,
                    format!("`{}` is constant and cannot be redeclared", declared.name.name),
                )
                .at(component.name.span, "redeclared here")
                .at(declared.name.span, "declared `constant`")
                .help("give it another value")
                .note("Modelica 3.6, 7.3"),
            );
            return;
        }
        // Without `constrainedby`, the declared class is the constraint (MLS 7.3.2).
        let path = declared.constraint.as_ref().map_or(&declared.class, |c| &c.path);
        let Ok(constraint) = self.instance.names().lookup_path(own, path) else { return };
        self.check_subtype(&constraint, found, component.name.span, path.span);
    }

    /// Checks redeclarations of redeclarations (MLS 7.3).
    ///
    /// Each inner one must be `replaceable`. Each with a `constrainedby` must fit it, as must the final class, and the
    /// constraint must fit that of the declaration before it. `all` lists the redeclarations, outermost first.
    /// `declared` is the innermost step. The check ends with the first violation.
    /// `own` is the place of the declaration, `found` the class of the outermost redeclaration.
    pub(in crate::instance) fn check_chain(
        &mut self,
        declared: &'a ast::ComponentDeclaration,
        own: LookupContext,
        all: &[(ModifierKind<'a>, LookupContext)],
        found: &LookupResult<'a>,
    ) {
        let steps: Vec<(&'a ast::ComponentDeclaration, LookupContext)> = all
            .iter()
            .filter_map(|(kind, view)| match kind {
                ModifierKind::Component(c) => Some((*c, *view)),
                _ => None,
            })
            .chain([(declared, own)])
            .collect();
        for (k, &(step, view)) in steps.iter().enumerate() {
            if k > 0 && !step.prefixes.replaceable && !std::ptr::eq(step, declared) {
                let outer = steps[k - 1].0;
                self.instance.report(
                    Diagnostic::new(Code::BadRedeclare, format!("`{}` is not replaceable any more", step.name.name))
                        .at(outer.name.span, "redeclared again here")
                        .at(step.name.span, "redeclared without `replaceable`")
                        .help("write `redeclare replaceable` at the inner one")
                        .note("Modelica 3.6, 7.3"),
                );
                return;
            }
            let Some(constraint) = &step.constraint else { continue };
            let Ok(promised) = self.instance.names().lookup_path(view, &constraint.path) else { continue };
            let at = step.name.span;
            // Both must fit the constraint of this step: the class written here, and the one that is used in the end.
            let own_class = self.instance.names().lookup_path(view, &step.class).ok();
            let fits = own_class.is_none_or(|c| self.check_subtype(&promised, &c, at, constraint.path.span))
                && self.check_subtype(&promised, found, steps[0].0.name.span, constraint.path.span);
            // The next entry is further in: its constraint is wider or equal.
            let before = steps.get(k + 1).and_then(|(s, v)| {
                let path = s.constraint.as_ref().map_or(&s.class, |c| &c.path);
                Some((self.instance.names().lookup_path(*v, path).ok()?, path.span))
            });
            let keeps = before.is_none_or(|(wider, span)| !fits || self.check_subtype(&wider, &promised, at, span));
            if !fits || !keeps {
                return;
            }
        }
    }

    /// Whether a class has every public element of another one (MLS 6.4). Reports a message if not.
    ///
    /// `at` is the replacement and `constrained` the constraint. Predefined types, and classes with missing bases,
    /// pass.
    /// Elements beyond those of the constraint are allowed: the replacement may have more.
    pub(in crate::instance) fn check_subtype(
        &mut self,
        constraint: &LookupResult<'a>,
        found: &LookupResult<'a>,
        at: Span,
        constrained: Span,
    ) -> bool {
        let (LookupResult::Class(want), LookupResult::Class(have)) = (constraint, found) else { return true };
        let want = self.instance.names().template(want.class, want.parent);
        let have = self.instance.names().template(have.class, have.parent);
        if have.broken || want.broken {
            return true;
        }
        let missing = want.elements.iter().find(|e| !e.protected && !have.by_name.contains_key(&e.name));
        let Some(missing) = missing else { return true };
        let (want, have) = (self.instance.library.full_name(want.class), self.instance.library.full_name(have.class));
        self.instance.report(
            Diagnostic::new(Code::BadRedeclare, format!("`{have}` cannot take the place of `{want}`"))
                .at(at, format!("`{have}` has no `{}`", missing.name))
                .at(constrained, format!("`{want}` is required here"))
                .help(format!("use a class that extends `{want}`")),
        );
        false
    }
}
