//! Finds the names in a class with what they refer to; definition, references, renaming and colours build on it.
//!
//! A class and a filter enter; a list of [`NameOccurrence`] leaves. The syntax tree is walked once. A name is resolved
//! only when the filter wants it, because resolving may load other files.
//!
//! `scope` is, throughout, the class in which names are looked up.

use bramah_model::resolve::names::{self, NameTarget};
use bramah_model::resolve::{ClassId, Library};
use bramah_syntax::ast::{
    Class, ClassBody, ComponentDeclaration, ComponentReference, ElementKind, Equation, EquationKind, Expr, ExprKind,
    ExtendsClause, ForIndex, Ident, Import, Modification, ModificationArgument, ModificationArgumentKind, Path,
    Statement, StatementKind, Subscript,
};

/// One name in a text.
#[derive(Clone, Copy, Debug)]
pub struct NameOccurrence<'a> {
    /// The identifier with its place.
    pub ident: Ident,
    /// What it refers to. `None` for built-in names and names that cannot be resolved.
    pub target: Option<NameTarget<'a>>,
    /// It is the declaration itself, not a use.
    pub declares: bool,
    /// The class around it.
    pub scope: ClassId,
}

/// The wanted names in a class and its nested classes, in the order of the syntax tree.
///
/// `wanted` is asked for each identifier. It usually compares the place of the identifier or its text.
pub fn of_class<'a>(
    library: &mut Library<'a>,
    id: ClassId,
    wanted: &dyn Fn(&Ident) -> bool,
) -> Vec<NameOccurrence<'a>> {
    let mut walk = OccurrenceFinder { library, wanted, found: Vec::new(), locals: Vec::new() };
    walk.class(id);
    walk.found
}

/// The wanted names in the `within` clause of the file of a class.
///
/// Each part of the clause is a name of its own: `within A.B;` names the packages `A` and `A.B`.
pub fn of_within<'a>(
    library: &mut Library<'a>,
    id: ClassId,
    wanted: &dyn Fn(&Ident) -> bool,
) -> Vec<NameOccurrence<'a>> {
    let file = library.class(id).span.file;
    let text = &library.sources.get(file).text;
    // Only the text up to the first semicolon is parsed, since the clause comes first.
    let head = text.find(';').map_or("", |end| &text[..=end]);
    let Some(path) = bramah_syntax::parse(file, head).tree.within else { return Vec::new() };
    let mut found = Vec::new();
    for (i, part) in path.parts.iter().enumerate().filter(|(_, part)| wanted(part)) {
        let parts: Vec<_> = path.parts[..=i].iter().map(|p| p.name).collect();
        let target = names::named(library, None, &parts, true).map(NameTarget::Class);
        found.push(NameOccurrence { ident: *part, target, declares: false, scope: id });
    }
    found
}

/// The class whose elements a modifier names. It is resolved only when a name in the modifier is wanted.
///
/// References instead of copies link it to the enclosing modifier, so that building it costs nothing.
#[derive(Clone, Copy)]
enum ModifierTarget<'a, 'c> {
    /// The class of this name, looked up in another class.
    Type(ClassId, &'a Path),
    /// The class of an element of the enclosing modifier's class.
    Element(&'c ModifierTarget<'a, 'c>, &'a Path),
    /// A class that is resolved already.
    Class(ClassId),
}

/// The walk over a syntax tree.
struct OccurrenceFinder<'l, 'a> {
    /// Resolves names and loads the classes they refer to.
    library: &'l mut Library<'a>,
    /// Which names are wanted.
    wanted: &'l dyn Fn(&Ident) -> bool,
    /// The wanted names so far.
    found: Vec<NameOccurrence<'a>>,
    /// Variables of the enclosing loops, innermost last.
    locals: Vec<Ident>,
}

impl<'a> OccurrenceFinder<'_, 'a> {
    /// Adds a wanted name and resolves it.
    ///
    /// `target` is called only when the name is wanted, since resolving may read other files.
    fn add(&mut self, scope: ClassId, ident: Ident, target: impl FnOnce(&mut Self) -> Option<NameTarget<'a>>) {
        if (self.wanted)(&ident) {
            let target = target(self);
            self.found.push(NameOccurrence { ident, target, declares: false, scope });
        }
    }

    /// Adds a wanted declaration.
    ///
    /// The target is known, because the declaration is the target itself.
    fn declare(&mut self, scope: ClassId, ident: Ident, target: NameTarget<'a>) {
        if (self.wanted)(&ident) {
            self.found.push(NameOccurrence { ident, target: Some(target), declares: true, scope });
        }
    }

    /// Walks a class.
    ///
    /// The order is that of the text: constraint, elements, equations, algorithms and the name after `end`.
    fn class(&mut self, id: ClassId) {
        let class: &'a Class = self.library.class(id);
        self.declare(id, class.name, NameTarget::Class(id));
        if let Some(constraint) = &class.constraint {
            self.path(id, &constraint.path);
            self.modification(id, ModifierTarget::Type(id, &constraint.path), constraint.modification.as_ref());
        }
        match &class.body {
            ClassBody::Long(body) => {
                for element in &body.elements {
                    self.element(id, &element.kind);
                }
                self.equations(id, &body.equations);
                self.equations(id, &body.initial_equations);
                for statements in body.algorithms.iter().chain(&body.initial_algorithms) {
                    self.statements(id, statements);
                }
                self.end_name(id, class);
            }
            ClassBody::Short { base, subscripts, modification, .. } => {
                // The base of a short class is looked up around it: in `type T = T2`, `T2` is not an element of `T`.
                let around = self.library.parent(id).unwrap_or(id);
                self.path(around, base);
                self.subscripts(around, subscripts);
                self.modification(around, ModifierTarget::Type(around, base), modification.as_ref());
            }
            ClassBody::Enumeration(literals) => {
                for literal in literals.iter().flatten() {
                    self.declare(id, literal.name, NameTarget::Literal(id, literal));
                }
            }
            ClassBody::Derivative { function, .. } => self.path(id, function),
        }
    }

    /// Adds the name after `end`, which the syntax tree does not keep. Its place follows from the end of the class.
    fn end_name(&mut self, id: ClassId, class: &Class) {
        let name = class.name.name;
        let length = name.as_str().len() as u32;
        let mut span = class.span;
        span.start = span.end.saturating_sub(length);
        // The name must lie behind the declaring one and match, else the class ends in another way.
        if span.start > class.name.span.end && self.library.sources.text(span) == name.as_str() {
            self.declare(id, Ident { name, span }, NameTarget::Class(id));
        }
    }

    /// Walks an element of a class.
    fn element(&mut self, scope: ClassId, kind: &'a ElementKind) {
        match kind {
            ElementKind::Import(import) => self.import(scope, import),
            ElementKind::Extends(ExtendsClause { base, modification }) => {
                self.path(scope, base);
                self.modification(scope, ModifierTarget::Type(scope, base), modification.as_ref());
            }
            ElementKind::Class(class) => {
                // Nested classes get their own number, as their names are looked up in them.
                let id = self.library.enter(class, Some(scope));
                self.class(id);
            }
            ElementKind::Component(component) => {
                self.declared(scope, component);
                self.component(scope, component);
            }
        }
    }

    /// Adds the declaration of a component.
    fn declared(&mut self, scope: ClassId, component: &'a ComponentDeclaration) {
        if (self.wanted)(&component.name)
            && let Some(target) = names::element(self.library, scope, component.name.name)
        {
            self.declare(scope, component.name, target);
        }
    }

    /// Walks everything of a component but its name: type, subscripts, modifiers, condition, constraint.
    ///
    /// A redeclaration inside a modifier has no declaring name, so both callers treat the name themselves.
    fn component(&mut self, scope: ClassId, component: &'a ComponentDeclaration) {
        self.path(scope, &component.class);
        self.subscripts(scope, &component.subscripts);
        let modified = ModifierTarget::Type(scope, &component.class);
        self.modification(scope, modified, component.modification.as_ref());
        component.condition.iter().for_each(|e| self.expression(scope, e));
        if let Some(constraint) = &component.constraint {
            self.path(scope, &constraint.path);
            self.modification(scope, ModifierTarget::Type(scope, &constraint.path), constraint.modification.as_ref());
        }
    }

    /// Adds the names of an import. They are looked up from the top level.
    ///
    /// `import A.{b, c}` names `A.b` and `A.c`.
    fn import(&mut self, scope: ClassId, import: &'a Import) {
        match import {
            Import::Single { path, .. } | Import::All(path) => self.dotted(scope, path, true),
            Import::Some(path, names) => {
                self.dotted(scope, path, true);
                for name in names {
                    let parts: Vec<_> = path.parts.iter().map(|p| p.name).chain([name.name]).collect();
                    self.add(scope, *name, |w| names::named(w.library, None, &parts, true).map(NameTarget::Class));
                }
            }
        }
    }

    /// Adds each part of a class name.
    ///
    /// A leading dot makes the name global; it is then looked up from the top level.
    fn path(&mut self, scope: ClassId, path: &'a Path) {
        self.dotted(scope, path, path.global);
    }

    /// Adds each part of a dotted name; `global` looks it up from the top level.
    fn dotted(&mut self, scope: ClassId, path: &'a Path, global: bool) {
        for (i, part) in path.parts.iter().enumerate() {
            // The first `i` parts together name the class that part `i` refers to.
            self.add(scope, *part, |w| {
                let parts: Vec<_> = path.parts[..=i].iter().map(|p| p.name).collect();
                names::named(w.library, Some(scope), &parts, global).map(NameTarget::Class)
            });
        }
    }

    /// Walks a modification of the class `of`.
    ///
    /// Names inside its brackets belong to `of`. Its value is an expression in `scope`.
    fn modification(&mut self, scope: ClassId, of: ModifierTarget<'a, '_>, modification: Option<&'a Modification>) {
        let Some(modification) = modification else { return };
        for argument in &modification.arguments {
            self.argument(scope, of, argument);
        }
        modification.value.iter().for_each(|e| self.expression(scope, e));
    }

    /// Walks one argument of a modification of the class `of`.
    ///
    /// An argument modifies, redeclares or removes (`break`) an element of the class.
    fn argument(&mut self, scope: ClassId, of: ModifierTarget<'a, '_>, argument: &'a ModificationArgument) {
        match &argument.kind {
            ModificationArgumentKind::Modify { path, modification, .. } => {
                // A dotted name `a.b = 1` modifies an element of an element.
                for (i, part) in path.parts.iter().enumerate() {
                    self.add(scope, *part, |w| w.element_of(of, &path.parts[..=i]));
                }
                self.modification(scope, ModifierTarget::Element(&of, path), modification.as_ref());
            }
            ModificationArgumentKind::Component(component) => {
                self.add(scope, component.name, |w| w.element_of(of, &[component.name]));
                self.component(scope, component);
            }
            ModificationArgumentKind::Class(class) => {
                self.add(scope, class.name, |w| w.element_of(of, &[class.name]));
                if let ClassBody::Short { base, modification, .. } = &class.body {
                    self.path(scope, base);
                    self.modification(scope, ModifierTarget::Type(scope, base), modification.as_ref());
                }
            }
            ModificationArgumentKind::BreakComponent(name) => self.add(scope, *name, |w| w.element_of(of, &[*name])),
            ModificationArgumentKind::BreakConnect(a, b) => {
                self.expression(scope, a);
                self.expression(scope, b);
            }
        }
    }

    /// The element that a dotted name refers to in the class `of`.
    ///
    /// `None`: the class cannot be resolved or has no such element.
    fn element_of(&mut self, of: ModifierTarget<'a, '_>, parts: &[Ident]) -> Option<NameTarget<'a>> {
        let mut class = self.modified(of)?;
        let (last, before) = parts.split_last()?;
        for part in before {
            let target = names::element(self.library, class, part.name)?;
            class = names::inside(self.library, target)?;
        }
        names::element(self.library, class, last.name)
    }

    /// Resolves the class of a modifier. `None`: it cannot be resolved.
    fn modified(&mut self, of: ModifierTarget<'a, '_>) -> Option<ClassId> {
        match of {
            ModifierTarget::Type(scope, path) => names::resolve(self.library, scope, path),
            ModifierTarget::Element(around, path) => {
                let target = self.element_of(*around, &path.parts)?;
                names::inside(self.library, target)
            }
            ModifierTarget::Class(id) => Some(id),
        }
    }

    /// Walks subscripts; a colon has no names.
    fn subscripts(&mut self, scope: ClassId, subscripts: &'a [Subscript]) {
        for subscript in subscripts {
            if let Subscript::Expr(e) = subscript {
                self.expression(scope, e);
            }
        }
    }

    /// Adds each part of a component reference.
    ///
    /// Subscripts are walked too; their names are looked up in the same class.
    fn reference(&mut self, scope: ClassId, reference: &'a ComponentReference) {
        for (i, part) in reference.parts.iter().enumerate() {
            self.add(scope, part.name, |w| w.meant(scope, reference, i));
            self.subscripts(scope, &part.subscripts);
        }
    }

    /// What part `last` of a reference refers to.
    ///
    /// The first part is a loop variable, a global name or a name in scope. Each further part is an element of the part
    /// before.
    ///
    /// `None`: one of the parts cannot be resolved.
    fn meant(&mut self, scope: ClassId, reference: &ComponentReference, last: usize) -> Option<NameTarget<'a>> {
        let first = reference.parts[0].name;
        // Loop variables hide elements of the class; the innermost one wins.
        let local = self.locals.iter().rev().find(|l| l.name == first.name && !reference.global);
        let mut target = match local {
            Some(local) => NameTarget::Iterator(*local),
            None if reference.global => NameTarget::Class(self.library.top(first.name)?),
            None => names::lookup(self.library, scope, first.name)?,
        };
        for part in &reference.parts[1..=last] {
            let class = names::inside(self.library, target)?;
            target = names::element(self.library, class, part.name.name)?;
        }
        Some(target)
    }

    /// Walks an expression.
    ///
    /// References and calls are handled here. All other kinds of expressions only have children.
    fn expression(&mut self, scope: ClassId, e: &'a Expr) {
        match &e.kind {
            ExprKind::Reference(reference) => self.reference(scope, reference),
            ExprKind::Call { function, args, named } => {
                self.reference(scope, function);
                args.iter().for_each(|a| self.expression(scope, a));
                // Named arguments are inputs of the called function.
                self.named(scope, |w| w.meant(scope, function, function.parts.len() - 1), named);
            }
            ExprKind::Comprehension { function, body, iterators } => {
                function.iter().for_each(|f| self.reference(scope, f));
                // The loop variables of a comprehension are known in its body only.
                self.within(scope, iterators, |w| w.expression(scope, body));
            }
            ExprKind::PartialApplication { function, named } => {
                self.path(scope, function);
                let of = |w: &mut Self| names::resolve(w.library, scope, function).map(NameTarget::Class);
                self.named(scope, of, named);
            }
            _ => e.each_child(&mut |inner| self.expression(scope, inner)),
        }
    }

    /// Adds named arguments of a call. `function` resolves the function that they belong to.
    ///
    /// The values of the arguments are walked as expressions.
    fn named(
        &mut self,
        scope: ClassId,
        function: impl Fn(&mut Self) -> Option<NameTarget<'a>>,
        named: &'a [(Ident, Expr)],
    ) {
        for (name, value) in named {
            self.add(scope, *name, |w| {
                let target = function(w)?;
                let class = names::inside(w.library, target)?;
                w.element_of(ModifierTarget::Class(class), &[*name])
            });
            self.expression(scope, value);
        }
    }

    /// Walks the body of a loop with its variables declared.
    ///
    /// Loops of equations, statements and comprehensions are walked alike. The variables are removed again behind the
    /// body.
    fn within(&mut self, scope: ClassId, iterators: &'a [ForIndex], body: impl FnOnce(&mut Self)) {
        let outside = self.locals.len();
        for iterator in iterators {
            // A range is walked before its variable is declared, as it cannot use it.
            iterator.range.iter().for_each(|r| self.expression(scope, r));
            self.locals.push(iterator.name);
            self.declare(scope, iterator.name, NameTarget::Iterator(iterator.name));
        }
        body(self);
        self.locals.truncate(outside);
    }

    /// Walks equations.
    ///
    /// Both sides of an equation or connection are expressions.
    fn equations(&mut self, scope: ClassId, equations: &'a [Equation]) {
        for equation in equations {
            match &equation.kind {
                EquationKind::Equal(a, b) | EquationKind::Connect(a, b) => {
                    self.expression(scope, a);
                    self.expression(scope, b);
                }
                EquationKind::If { branches, otherwise } => {
                    self.branches(scope, branches, Self::equations);
                    self.equations(scope, otherwise);
                }
                EquationKind::For { iterators, body } => {
                    self.within(scope, iterators, |w| w.equations(scope, body));
                }
                EquationKind::When(branches) => self.branches(scope, branches, Self::equations),
                EquationKind::Call(e) => self.expression(scope, e),
            }
        }
    }

    /// Walks statements.
    ///
    /// The left side of an assignment is an expression, too.
    fn statements(&mut self, scope: ClassId, statements: &'a [Statement]) {
        for statement in statements {
            match &statement.kind {
                StatementKind::Assign(a, b) => {
                    self.expression(scope, a);
                    self.expression(scope, b);
                }
                StatementKind::AssignTuple(left, right) => {
                    left.iter().flatten().for_each(|e| self.expression(scope, e));
                    self.expression(scope, right);
                }
                StatementKind::Call(e) => self.expression(scope, e),
                StatementKind::If { branches, otherwise } => {
                    self.branches(scope, branches, Self::statements);
                    self.statements(scope, otherwise);
                }
                StatementKind::For { iterators, body } => {
                    self.within(scope, iterators, |w| w.statements(scope, body));
                }
                StatementKind::While(condition, body) => {
                    self.expression(scope, condition);
                    self.statements(scope, body);
                }
                StatementKind::When(branches) => self.branches(scope, branches, Self::statements),
                StatementKind::Break | StatementKind::Return => {}
            }
        }
    }

    /// Walks conditions and the equations or statements that depend on them.
    ///
    /// Serves `if` and `when`, for equations as well as statements.
    fn branches<T>(
        &mut self,
        scope: ClassId,
        branches: &'a [(Expr, Vec<T>)],
        body: impl Fn(&mut Self, ClassId, &'a [T]),
    ) {
        for (condition, guarded) in branches {
            self.expression(scope, condition);
            body(self, scope, guarded);
        }
    }
}
