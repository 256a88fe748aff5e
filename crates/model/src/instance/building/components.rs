//! Builds components: from declarations with their modifiers to nodes.
//!
//! [`instantiate`] walks through the model in declaration order. A name in a size or condition may ask for a component
//! earlier, so [`ComponentBuilder::component`] builds it on demand.
//! For one component the steps are: condition, type, dimensions, then one object or variable for each array element.

use crate::instance::building::given::Override;
use crate::instance::evaluation::ranges::ArrayExtent;
use crate::instance::lookup::{BuiltinType, LookupResult, STATE_SELECT, predefined_enumerations};
use crate::instance::modifiers::{
    AccessStep, ArrayPosition, Binding, ElementModifiers, Modifier, ModifierKind, extended, indexed,
};
use crate::instance::template::{ExtendsModificationKind, Template, TemplateElementKind};
use crate::instance::{
    ClassRef, ComponentBuilder, ElementState, InheritedPrefixes, Instance, InstanceNode, InstanceVariable,
    LookupContext, NodeId, ROOT, ScopeId, state,
};
use crate::resolve::{ClassId, Library};
use bramah_expr::types::{ScalarType, StateSelect, Variability};
use bramah_expr::{Exprs, VarId};
use bramah_syntax::ast::{self, ClassKind, Expr, ExprKind, Subscript};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;
use rustc_hash::FxHashMap;
use std::rc::Rc;

/// The most scalar variables of a model. Beyond it a parameter of a size is probably wrong.
const MOST_VARIABLES: usize = 20_000_000;
/// The deepest nesting of components. Beyond it a class probably contains itself.
const DEEPEST: usize = 60;

/// What to instantiate.
#[derive(Clone, Debug)]
pub struct ModelRequest {
    /// The class of the model.
    pub class: ClassId,
    /// Values of parameters and start values from outside, as from the command line.
    pub overrides: Vec<Override>,
}

/// Builds the component tree of a class.
///
/// Messages are collected in the returned [`Instance`]. With an error among them the tree may be incomplete.
///
/// `library` must hold the class and is borrowed for as long as the instance lives.
/// A class that cannot be simulated gives a message and an empty tree.
pub fn instantiate<'a, 'l>(library: &'l mut Library<'a>, request: &ModelRequest) -> Instance<'a, 'l> {
    let mut instance = Instance {
        library,
        scopes: Vec::new(),
        nodes: Vec::new(),
        variables: Vec::new(),
        order: Vec::new(),
        exprs: Exprs::default(),
        enumerations: predefined_enumerations(),
        root: ScopeId(1),
        diagnostics: Vec::new(),
        varied: false,
        streams: crate::instance::StreamConnections::default(),
        connected: FxHashMap::default(),
        overconstrained: crate::instance::overconstrained::OverconstrainedComponents::default(),
        classes: crate::instance::ClassTable::default(),
        functions: crate::instance::FunctionTable::default(),
        values: crate::instance::ValueTable::default(),
        building: crate::instance::BuildingTable::default(),
        eval: state::EvaluationState::default(),
    };
    instance.builder().build_model(request);
    instance
}

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// Builds the complete tree: root scope, components, members of buses, checks, numbers of variables.
    ///
    /// The order matters: buses get their members after all components exist, and variables are numbered when none can
    /// be added any more. Values from outside for elements that nobody met are reported before that.
    fn build_model(&mut self, request: &ModelRequest) {
        let class = self.instance.library.class(request.class);
        let name = self.instance.library.full_name(request.class);
        let nothing = Rc::new(Template::empty(request.class, ClassKind::Class));
        self.instance.names().new_scope(nothing.clone(), String::new(), Rc::from([]), None, class.name.span);
        let parent = self.surroundings(request.class);
        // Scope 0 holds the top level. Enclosing packages get scopes before the model, so its number may be above 1.
        let root = self.instance.scopes.len();
        if root != 1 {
            self.instance.root = ScopeId(u32::try_from(root).expect("small"));
        }
        self.instance.root =
            // The root gets an empty template first: finding its template may already look up names in it.
            self.instance.names().new_scope(nothing, String::new(), Rc::from([]), None, class.name.span);
        if !self.can_run(class, &name) {
            return;
        }
        let template = self.instance.names().template(request.class, parent);
        let args = self.override_args(request);
        let elements = vec![ElementState::Unknown; template.elements.len()];
        let root = self.instance.root;
        let scope = self.instance.scope_mut(root);
        (scope.template, scope.args, scope.elements, scope.component) = (template, args, elements, true);
        // Buses come after all components, because their members are copies of what is connected to them.
        self.build_elements(root, 0);
        self.expand_connectors();
        self.check_streams();
        self.elements_not_met();
        self.number_variables();
    }

    /// Checks that each stream variable belongs to a connector with a flow variable (MLS 15.1).
    /// The search for the flow variable is that of `Instance::stream_flow`, so streams in nested records count too.
    ///
    /// ```text
    /// connector Port
    ///   stream Real h;      // needs a flow variable beside it
    ///   flow Real m_flow;
    /// end Port;
    /// ```
    fn check_streams(&mut self) {
        for i in 0..u32::try_from(self.instance.variables.len()).expect("limited above") {
            if !self.instance.variables[i as usize].stream || self.instance.stream_flow(i).is_some() {
                continue;
            }
            let (name, at) =
                (self.instance.variables[i as usize].name.clone(), self.instance.variables[i as usize].span);
            let d = Diagnostic::new(Code::Restricted, format!("`{name}` is a stream without a flow"));
            let d = d.at(at, "no connector with one `flow` variable around it").instance(name);
            self.instance
                .report(d.note("Modelica 3.6, 15.1").help("declare it in a connector that has a `flow` variable"));
        }
    }

    /// The place from which a class given by its full name sees its surroundings: the packages that enclose it.
    fn surroundings(&mut self, class: ClassId) -> LookupContext {
        let Some(parent) = self.instance.library.parent(class) else { return ROOT };
        let around = self.surroundings(parent);
        let found = ClassRef { class: parent, parent: around, args: Rc::from([]) };
        LookupContext { scope: self.instance.names().package(&found), base: 0 }
    }

    /// Whether a class can be simulated: a model or block that is not partial. Reports a message otherwise.
    ///
    /// Functions, packages, records, connectors and types have no behavior over time (MLS 4.6).
    /// A partial class lacks equations or replaceable parts by intention.
    fn can_run(&mut self, class: &'a ast::Class, name: &str) -> bool {
        let kind = match class.kind {
            ClassKind::Model | ClassKind::Block | ClassKind::Class => None,
            ClassKind::Package => Some("package"),
            ClassKind::Function { .. } => Some("function"),
            ClassKind::Record { .. } => Some("record"),
            ClassKind::Connector { .. } => Some("connector"),
            ClassKind::Type => Some("type"),
            ClassKind::Operator => Some("operator"),
        };
        if let Some(kind) = kind {
            self.instance.report(
                Diagnostic::new(Code::BadModel, format!("`{name}` is a {kind}, not a model"))
                    .at(class.name.span, "only a model or block can be run")
                    .help("name a model with `--model CLASS`"),
            );
            return false;
        }
        if class.prefixes.partial {
            self.instance.report(
                Diagnostic::new(Code::Partial, format!("`{name}` is partial and cannot be run"))
                    .at(class.name.span, "declared `partial`")
                    .help("run a class that extends it"),
            );
            return false;
        }
        true
    }

    /// Builds all components of an instance. `depth` is the number of components around it.
    ///
    /// Modifiers that name nothing are reported before. Classes in the instance are not touched, names ask for them.
    /// Components nested deeper than [`DEEPEST`] are reported as endless.
    fn build_elements(&mut self, scope: ScopeId, depth: usize) {
        let template = self.instance.scope(scope).template.clone();
        self.check_targets(scope, &template);
        if depth > DEEPEST {
            self.too_deep(scope);
            return;
        }
        for (i, element) in (0u32..).zip(&template.elements) {
            if matches!(element.kind, TemplateElementKind::Component(_)) {
                self.component_at(scope, i, depth);
            }
        }
    }

    /// Reports components that contain themselves.
    /// The message shows the component at which the limit was passed.
    fn too_deep(&mut self, scope: ScopeId) {
        let s = self.instance.scope(scope);
        let (span, class) = (s.span, s.template.class);
        let class = self.instance.library.full_name(class);
        self.instance.report(
            Diagnostic::new(Code::Recursion, format!("components of `{class}` are nested without end"))
                .at(span, "this component contains itself")
                .class(class)
                .help("a class cannot hold a component of its own kind"),
        );
    }

    /// Reports modifiers that name no element of the instance, or a protected one.
    ///
    /// Nothing is checked if a base class is missing: the name may belong to it.
    /// For each name only one message appears, even if many array elements have the modifier.
    fn check_targets(&mut self, scope: ScopeId, template: &Template<'a>) {
        if template.broken {
            return;
        }
        let args = self.instance.scope(scope).args.clone();
        for arg in args.iter() {
            let name = match arg.kind {
                ModifierKind::Modify(path, _) => path[0],
                ModifierKind::Component(c) => c.name,
                ModifierKind::Class(c) => c.name,
            };
            if let Some(&i) = template.by_name.get(&name.name) {
                if template.elements[i as usize].protected {
                    self.protected_modifier(name, template);
                }
                continue;
            }
            let class = self.instance.library.full_name(template.class);
            let names: Vec<Symbol> = template.elements.iter().filter(|e| !e.protected).map(|e| e.name).collect();
            // The elements of an array have the same modifiers: one message is enough.
            let reported =
                self.instance.diagnostics.iter().any(|d| d.labels.first().is_some_and(|l| l.span == name.span));
            if !reported {
                self.instance.unknown_modifier(name, &class, &names);
            }
        }
    }

    /// Reports a modifier of a protected element. Only classes that extend the class may modify it (MLS 4.1, 7.2).
    /// It is reported once for each place in the text.
    fn protected_modifier(&mut self, name: ast::Ident, template: &Template<'a>) {
        if self.instance.diagnostics.iter().any(|d| d.labels.first().is_some_and(|l| l.span == name.span)) {
            return;
        }
        let class = self.instance.library.full_name(template.class);
        self.instance.report(
            Diagnostic::new(Code::UnknownModifier, format!("`{}` of `{class}` is protected", name.name))
                .at(name.span, "cannot be modified from outside")
                .class(class)
                .help("modify it in a class that extends this one, or declare it above `protected`"),
        );
    }

    /// The node of a component element, built if necessary.
    /// `None` if its condition is false, if it could not be built, or if it is just being built.
    pub fn component(&mut self, scope: ScopeId, index: u32) -> Option<NodeId> {
        self.component_at(scope, index, 0)
    }

    /// Like [`Self::component`], with the number of components around it.
    ///
    /// The state of the element is `Busy` meanwhile. Afterwards it is the node, or `Absent`.
    /// Messages that were reported on the way are given the component of the model to which they belong.
    fn component_at(&mut self, scope: ScopeId, index: u32, depth: usize) -> Option<NodeId> {
        match &self.instance.scope(scope).elements[index as usize] {
            ElementState::Node(node) => return Some(*node),
            ElementState::Unknown => {}
            // `Busy` here means that the component asks for itself. The caller reports it, if it needs the component.
            ElementState::Busy | ElementState::Absent | ElementState::Class(_) => return None,
        }
        self.instance.scope_mut(scope).elements[index as usize] = ElementState::Busy;
        let mark = self.instance.diagnostics.len();
        let node = self.build_component(scope, index, depth);
        if scope == self.instance.root && self.instance.diagnostics.len() > mark {
            // Messages from inside a library class also name the component of the model that led there.
            let element = &self.instance.scope(scope).template.elements[index as usize];
            let (name, span) = (element.name.as_str().to_owned(), element.span);
            self.instance.point_at(mark, &name, span);
        }
        let state = node.map_or(ElementState::Absent, ElementState::Node);
        self.instance.scope_mut(scope).elements[index as usize] = state;
        node
    }

    /// Builds a component that nobody has built yet. `None` if it is absent or could not be built.
    ///
    /// 1. An `outer` element is replaced by the `inner` component that it stands for.
    /// 2. Modifiers are collected, and the condition is evaluated.
    /// 3. The class is looked up, that of the outermost redeclaration if there is one, and checked.
    /// 4. Prefixes and dimensions are determined.
    /// 5. One node is built for each array element.
    ///
    /// `index` is the element in the template of `scope`. `depth` is the number of components around.
    fn build_component(&mut self, scope: ScopeId, index: u32, depth: usize) -> Option<NodeId> {
        let template = self.instance.scope(scope).template.clone();
        let element = &template.elements[index as usize];
        let TemplateElementKind::Component(declared) = element.kind else { return None };
        let own = LookupContext { scope, base: element.base };
        // A component that is `inner` and `outer` is built as the `inner` one of what is below it.
        if declared.prefixes.outer && !declared.prefixes.inner {
            self.check_outer_unmodified(scope, declared);
            return self.outer_component(scope, declared, own);
        }
        let reached = self.instance.names().reached(scope, index);
        // The condition comes first: an absent component may have a type or sizes that make no sense (MLS 4.4.5).
        if let Some(condition) = &declared.condition
            && !self.instance.evaluator().constant_boolean(condition, own)?
        {
            return None;
        }
        let (component, view) = match reached.redeclare {
            Some((ModifierKind::Component(c), view, ..)) => (c, view),
            _ => (declared, own),
        };
        let found = self.instance.names().class_at(view, &component.class)?;
        #[cfg(feature = "fmi")]
        let found = self.with_unit(found, &reached.args, declared.name.span)?;
        self.check_redeclaration(declared, own, component, &found);
        self.check_chain(declared, own, &reached.redeclarations, &found);
        let plan = ComponentPlan {
            name: joined(&self.instance.scope(scope).name, element.name),
            scope,
            index: Some(index),
            declared,
            prefix: self.prefixes(scope, element.protected, component, declared),
            span: declared.name.span,
            depth,
        };
        // A redeclaration without dimensions keeps those of the declaration.
        let subscripts = if component.subscripts.is_empty() { &declared.subscripts } else { &component.subscripts };
        // Without a value, `:` takes its size from the start value.
        let shape = reached.binding.clone().or_else(|| start_of(&reached.args));
        let dims = self.dimensions(Some(declared.name.name), subscripts, own, shape.as_ref(), 0)?;
        self.build_shaped(&plan, &found, &dims, reached)
    }

    /// The prefixes of a component: its own, those of the redeclared declaration, and those of the components around
    /// it.
    ///
    /// - Variability is the strictest one of the component and what is around it.
    /// - `input` and `output` are those of the component, or else of what is around it.
    /// - `flow`, `stream` and mixing hold for everything inside.
    ///
    /// `component` is the redeclaration if there is one, `declared` the first declaration.
    fn prefixes(
        &self,
        scope: ScopeId,
        protected: bool,
        component: &ast::ComponentDeclaration,
        declared: &ast::ComponentDeclaration,
    ) -> InheritedPrefixes {
        let outer = self.instance.scope(scope).prefix;
        let prefix = if component.prefix.variability.is_some() { component.prefix } else { declared.prefix };
        // `constant` before `parameter` before `discrete`: a record of parameters has parameters as fields.
        let stricter = match (outer.variability, prefix.variability) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        // `HideResult = false` shows protected elements as well (MLS 18.3).
        let said = annotated(declared, "HideResult");
        InheritedPrefixes {
            variability: stricter,
            causality: component.prefix.causality.or(declared.prefix.causality).or(outer.causality),
            flow: outer.flow || component.prefix.flow || declared.prefix.flow,
            stream: outer.stream || component.prefix.stream || declared.prefix.stream,
            hidden: said.unwrap_or(outer.hidden || protected),
            unwanted: said.unwrap_or(outer.unwanted),
            mixes: outer.mixes || annotated(declared, "__bramah_mixes") == Some(true),
            nested: outer.nested,
        }
    }

    /// The array dimensions of an element. `None` after a message.
    ///
    /// `:` takes the size from `binding`, where the first `skip` dimensions are not counted.
    /// `own` is the name of the element: `size(A, 1)` in the dimensions of `A` itself reads the sizes before it.
    ///
    /// - A number or an expression of parameters is evaluated; the parameters become structural.
    /// - `Boolean` or an enumeration gives one element for each of its values.
    /// - `:` takes the size from the value: `Real x[:] = {1, 2}` has two elements.
    ///
    /// Sizes must be known when the model is built, because they determine the number of variables and equations.
    pub(in crate::instance) fn dimensions(
        &mut self,
        own: Option<Symbol>,
        subscripts: &'a [Subscript],
        view: LookupContext,
        binding: Option<&Binding<'a>>,
        skip: usize,
    ) -> Option<Vec<ArrayExtent>> {
        let mut dims = Vec::with_capacity(subscripts.len());
        for (i, s) in subscripts.iter().enumerate() {
            let before = own.and_then(|name| own_size(s, name)).and_then(|k| dims.get(k.checked_sub(1)?));
            let extent = match s {
                Subscript::Expr(_) if before.is_some() => before.copied()?,
                Subscript::Expr(e) => self.instance.evaluator().extent(e, view)?,
                Subscript::All(span) => {
                    let Some(b) = binding else {
                        self.instance.report(
                            Diagnostic::new(Code::NoValue, "the size `:` needs a value to be taken from")
                                .at(*span, "no binding gives this size")
                                .help("write a size, or bind the array to a value"),
                        );
                        return None;
                    };
                    // The shape alone is asked for first, because the value may read variables that are not built yet.
                    let known =
                        if b.access.is_empty() { self.instance.evaluator().shape(b.expr, b.view) } else { None };
                    let sizes = match known {
                        Some(sizes) => sizes,
                        None => self.instance.evaluator().binding_value(b, true)?.dims().to_vec(),
                    };
                    match sizes.get(skip + i) {
                        Some(&size) => ArrayExtent { size, by: ScalarType::Integer },
                        None => {
                            self.instance.report(
                                Diagnostic::new(Code::SizeMismatch, "the value has fewer dimensions than the array")
                                    .at(b.expr.span, "this value")
                                    .at(*span, "should give this size"),
                            );
                            return None;
                        }
                    }
                }
            };
            dims.push(extent);
        }
        Some(dims)
    }

    /// Builds a component with the dimensions `dims` of its declaration and those of its type.
    ///
    /// The dimensions of the type come after those of the declaration: `Triple t[2]` is a 2 by 3 array (MLS 10.1).
    ///
    /// `reached` are the modifiers of the component and its value, which are divided among the array elements.
    /// Arrays with too many elements are reported. Types with an `equalityConstraint` are noted for the network.
    /// `plan` holds what is the same for all elements: name, prefixes and place of the declaration.
    pub(in crate::instance) fn build_shaped(
        &mut self,
        plan: &ComponentPlan<'a>,
        found: &LookupResult<'a>,
        dims: &[ArrayExtent],
        reached: ElementModifiers<'a>,
    ) -> Option<NodeId> {
        let mut all = dims.to_vec();
        let template = match found {
            LookupResult::Class(class) => {
                let t = self.instance.names().template(class.class, class.parent);
                // The type itself comes first, then what it is made of: `type B = Real[3]; type A = B[2]` is 2 by 3.
                for (subscripts, base) in &t.dims {
                    let view = t.bases[*base as usize].parent;
                    all.extend(self.dimensions(None, subscripts, view, reached.binding.as_ref(), dims.len())?);
                }
                Some(t)
            }
            _ => None,
        };
        // Checked before anything is allocated; the product itself may overflow.
        let count = all.iter().try_fold(1usize, |n, d| n.checked_mul(d.size));
        if count.is_none_or(|n| n + self.instance.variables.len() > MOST_VARIABLES) {
            self.instance.report(
                Diagnostic::new(
                    Code::TooLarge,
                    format!("`{}` would have more than {MOST_VARIABLES} elements", plan.name),
                )
                .at(plan.span, "this array")
                .help("check the parameters that give its size"),
            );
            return None;
        }
        let of_type = match found {
            LookupResult::Class(class) => class.args.clone(),
            _ => Rc::from([]),
        };
        let args = (reached.args.into(), of_type);
        let part = ComponentValue { binding: reached.binding, final_: reached.final_ };
        let node = self.build_array(plan, found, template.as_ref(), (&all, dims.len()), &args, part)?;
        if let Some(template) = template {
            self.note_constraints(node, dims.is_empty(), found, &template);
        }
        Some(node)
    }

    /// Builds one node, or one for each element of an array.
    /// `extents` are all dimensions; the first `declared` of them are those of the declaration.
    ///
    /// Each element gets the modifiers with its index appended, so that `A a[2](x = {1, 2})` gives `a[2].x` the value
    /// 2.
    /// Names are `a[1]`, `a[2,3]` and so on. A failure of one element ends the array.
    /// The nodes are in row-major order. Without dimensions the one node is returned itself.
    fn build_array(
        &mut self,
        plan: &ComponentPlan<'a>,
        found: &LookupResult<'a>,
        template: Option<&Rc<Template<'a>>>,
        (extents, declared): (&[ArrayExtent], usize),
        // what the declaration says of the component, and what its class has been modified by
        (args, of_type): &(Rc<[Modifier<'a>]>, Rc<[Modifier<'a>]>),
        part: ComponentValue<'a>,
    ) -> Option<NodeId> {
        let all = |args: Rc<[Modifier<'a>]>, of_type: Rc<[Modifier<'a>]>| match of_type.is_empty() {
            true => args,
            false => args.iter().chain(of_type.iter()).cloned().collect(),
        };
        if extents.is_empty() {
            let args = all(args.clone(), of_type.clone());
            return self.build_one(plan, (&plan.name, &[]), found, template, args, part);
        }
        let dims: Vec<usize> = extents.iter().map(|e| e.size).collect();
        let count: usize = dims.iter().product();
        let mut elements = Vec::with_capacity(count);
        for flat in 0..count {
            let index = unravel(flat, &dims);
            let text: Vec<String> = index.iter().map(|i| (i.place + 1).to_string()).collect();
            let name = format!("{}[{}]", plan.name, text.join(","));
            // Modifiers of the type see only the type's own dimensions: inside the type, the array around it does not
            // exist.
            let args = all(indexed(args, &index), indexed(of_type, &index[declared..]));
            let binding = part.binding.clone().map(|b| Binding { access: extended(&b.access, &index), ..b });
            let part = ComponentValue { binding, ..part.clone() };
            // The same holds for the attributes that the chain of types gives.
            let own = &index[declared..];
            elements.push(self.build_one(plan, (&name, own), found, template, args, part)?);
        }
        Some(self.instance.add_node(InstanceNode::Array {
            dims,
            by: extents.iter().map(|e| e.by).collect(),
            elements: elements.into(),
        }))
    }

    /// Builds one element: a variable of a predefined type or of a class based on one, or an object.
    /// `index` holds the position within the dimensions of the type.
    ///
    /// `args` are the modifiers of this element, `part` is its value.
    /// `None` after a message, or if `found` is neither a class nor a predefined type.
    fn build_one(
        &mut self,
        plan: &ComponentPlan<'a>,
        (name, index): (&str, &[ArrayPosition]),
        found: &LookupResult<'a>,
        template: Option<&Rc<Template<'a>>>,
        args: Rc<[Modifier<'a>]>,
        part: ComponentValue<'a>,
    ) -> Option<NodeId> {
        match (found, template) {
            (LookupResult::Builtin(b), _) => Some(self.build_variable(plan, name, *b, &args, (&[], None), part)),
            (LookupResult::Class(_), Some(t)) => match t.builtin {
                Some(b) => {
                    let chain = self.type_args(t, index);
                    Some(self.build_variable(plan, name, b, &args, (&chain, t.prefix.causality), part))
                }
                None => self.build_object(plan, name, t, args, part),
            },
            _ => None,
        }
    }

    /// The modifiers of attributes along a chain of types, outermost first.
    /// Each is looked up from around the class in which it stands.
    fn type_args(&self, t: &Template<'a>, index: &[ArrayPosition]) -> Vec<Modifier<'a>> {
        let none: Rc<[AccessStep]> = Rc::from([]);
        // A type is scalar inside the class that gives it its dimensions.
        let shaped = t.dims.iter().map(|(_, base)| *base).min().unwrap_or(0);
        let mut chain = Vec::new();
        for s in &t.builtin_args {
            let ExtendsModificationKind::Argument(a) = s.what else { continue };
            let arg = Modifier::new(a, t.bases[s.base as usize].parent, &none, false);
            let own = if s.base <= shaped { index } else { &[] };
            chain.extend(arg.iter().flat_map(|a| indexed(std::slice::from_ref(a), own).to_vec()));
        }
        chain
    }

    /// Builds an instance of a class with components. `None` after a message, if the class cannot be a component.
    ///
    /// 1. Class and prefixes are checked against the rules for components.
    /// 2. The scope is created with the modifiers and, for records, the value.
    /// 3. A component that is no array is made visible, so that its own modifiers can ask for its sizes.
    /// 4. Its elements are built.
    ///
    /// A value for a component that is no record is an error, and the component is built without it.
    /// Connectors of blocks are checked for having a direction (MLS 4.6).
    fn build_object(
        &mut self,
        plan: &ComponentPlan<'a>,
        name: &str,
        template: &Rc<Template<'a>>,
        args: Rc<[Modifier<'a>]>,
        part: ComponentValue<'a>,
    ) -> Option<NodeId> {
        if !self.can_be_component(plan, template) {
            return None;
        }
        self.check_prefixes(plan.declared, template);
        let owner = self.instance.scope(plan.scope).template.kind;
        if matches!((owner, template.kind), (ClassKind::Block, ClassKind::Connector { .. })) && !plan.prefix.hidden {
            self.check_block_port(plan.declared, template);
        }
        let scope =
            self.instance.names().new_scope(template.clone(), name.to_string(), args, Some(plan.scope), plan.span);
        let mut prefix = plan.prefix;
        prefix.causality = plan.prefix.causality.or(template.prefix.causality);
        // Inputs and outputs of connectors at the top level are those of the model.
        prefix.nested = prefix.nested || !matches!(template.kind, ClassKind::Connector { .. });
        // a connector may be a record, as `connector ComplexOutput = output Complex` is
        let record = template.bases.iter().any(|b| matches!(b.ast.kind, ClassKind::Record { .. }));
        let s = self.instance.scope_mut(scope);
        (s.prefix, s.component) = (prefix, true);
        match part.binding {
            Some(b) if record => s.binding = Some(b),
            Some(b) => {
                let class = self.instance.library.full_name(template.class);
                self.instance.report(
                    Diagnostic::new(Code::TypeMismatch, format!("`{name}` is a component and cannot have a value"))
                        .at(b.expr.span, format!("`{class}` is not a type with values"))
                        .help("modify its elements in brackets instead"),
                );
            }
            None => {}
        }
        let node = self.instance.add_node(InstanceNode::Object(scope));
        // Elements of arrays are not entered: the array becomes visible when all of it is built.
        if let Some(index) = plan.index.filter(|_| name == plan.name) {
            // a modifier may ask for sizes of the component that it modifies: its elements are built when asked for
            self.instance.scope_mut(plan.scope).elements[index as usize] = ElementState::Node(node);
        }
        self.build_elements(scope, plan.depth + 1);
        Some(node)
    }

    /// Whether a class can be the type of a component: not a package, function or partial class. Reports a message.
    ///
    /// A partial class may be complete in a redeclaration, so the help says that as well.
    fn can_be_component(&mut self, plan: &ComponentPlan<'a>, template: &Template<'a>) -> bool {
        let ast = template.bases[0].ast;
        let class = || self.instance.library.full_name(template.class);
        let d = match template.kind {
            ClassKind::Package => Diagnostic::new(Code::WrongClassKind, format!("`{}` is a package", class())),
            ClassKind::Function { .. } => Diagnostic::new(Code::WrongClassKind, format!("`{}` is a function", class())),
            _ if ast.prefixes.partial => {
                Diagnostic::new(Code::Partial, format!("`{}` is partial and cannot be a component", class()))
                    .help("use a class that extends it, or redeclare the component")
            }
            _ => return true,
        };
        self.instance.report(d.at(plan.span, format!("`{}` is declared here", plan.name)).instance(plan.name.clone()));
        false
    }

    /// Builds a scalar variable and returns its node.
    ///
    /// Values from outside for single array elements come before the declared value and start attribute.
    /// Booleans, Integers and enumerations without a prefix are discrete (MLS 3.8.4).
    /// The variable gets its number in the flat model later.
    ///
    /// `args` are the modifiers of the variable, `chain` those along the chain of its types, both outermost first.
    /// Attributes that the type does not have are reported.
    /// Strings and external objects are variables here too, although the flat model does not contain them.
    fn build_variable(
        &mut self,
        plan: &ComponentPlan<'a>,
        name: &str,
        builtin: BuiltinType,
        args: &[Modifier<'a>],
        // Modifications of the type chain, and `input` or `output` where the type is a connector declared so.
        (chain, declared): (&[Modifier<'a>], Option<ast::CausalityPrefix>),
        part: ComponentValue<'a>,
    ) -> NodeId {
        let causality = plan.prefix.causality.or(declared);
        let ty = match builtin {
            BuiltinType::Real | BuiltinType::String | BuiltinType::Object => ScalarType::Real,
            BuiltinType::Integer => ScalarType::Integer,
            BuiltinType::Boolean => ScalarType::Boolean,
            BuiltinType::Enumeration(i) => ScalarType::Enumeration(i),
        };
        let variability = match plan.prefix.variability {
            Some(ast::VariabilityPrefix::Constant) => Variability::Constant,
            Some(ast::VariabilityPrefix::Parameter) => Variability::Parameter,
            Some(ast::VariabilityPrefix::Discrete) => Variability::Discrete,
            None if ty != ScalarType::Real => Variability::Discrete,
            None => Variability::Continuous,
        };
        let mut attributes = self.attributes(args.iter().chain(chain), builtin);
        let mut binding = part.binding;
        // Values from outside for single array elements come before everything that is written in the text.
        if !self.instance.building.given_elements.is_empty() {
            if variability <= Variability::Parameter && !plan.prefix.hidden {
                let given = self.given_element(name);
                if given.is_some() && part.final_ {
                    let d = Diagnostic::new(Code::BadSet, format!("`{name}` is final and cannot be set"));
                    self.instance.report(d.at(plan.span, "declared here").help("set what it is made of"));
                }
                binding = given.or(binding);
            }
            if let Some(start) = self.given_element(&format!("{name}.start")) {
                attributes.retain(|a| a.0 != "start");
                attributes.push((Symbol::new("start"), start));
            }
        }
        let data = InstanceVariable {
            name: name.to_string(),
            ty,
            string: builtin == BuiltinType::String,
            object: builtin == BuiltinType::Object,
            variability,
            causality,
            top: !plan.prefix.nested && causality.is_some() && !plan.prefix.hidden,
            flow: plan.prefix.flow,
            stream: plan.prefix.stream,
            hidden: plan.prefix.hidden,
            unwanted: plan.prefix.unwanted,
            mixes: plan.prefix.mixes,
            final_: part.final_,
            structural: false,
            evaluate: annotated(plan.declared, "Evaluate") == Some(true),
            binding,
            attributes,
            state_select: StateSelect::Default,
            description: plan.declared.description.as_deref(),
            span: plan.span,
            scope: plan.scope,
            constant: None,
            busy: false,
            id: VarId(u32::MAX),
        };
        self.instance.variables.push(data);
        let index = u32::try_from(self.instance.variables.len() - 1).expect("limited above");
        // Evaluated now, because it needs the variable's own place for its names.
        let state_select = self.state_select(index);
        self.instance.variables[index as usize].state_select = state_select;
        self.instance.add_node(InstanceNode::Var(index))
    }

    /// The attributes that modifiers give a variable, at most one of each: the first one, which is the outermost.
    /// Reports attributes that the type does not have.
    ///
    /// Modifiers come outermost first, so later ones for the same attribute are dropped (MLS 7.2.4).
    /// A `final` one among those is reported, because something further out has changed it.
    fn attributes<'x>(
        &mut self,
        args: impl Iterator<Item = &'x Modifier<'a>>,
        builtin: BuiltinType,
    ) -> Vec<(Symbol, Binding<'a>)>
    where
        'a: 'x,
    {
        let mut attributes: Vec<(Symbol, Binding<'a>)> = Vec::new();
        for arg in args {
            let ModifierKind::Modify(path, modification) = arg.kind else { continue };
            let attribute = path[0].name;
            if !attributes_of(builtin).contains(&attribute.as_str()) || path.len() > 1 {
                self.instance.unknown_attribute(attribute, path[0].span, builtin);
                continue;
            }
            let Some(expr) = modification.and_then(|m| m.value.as_ref()) else { continue };
            if let Some((_, given)) = attributes.iter().find(|(a, _)| *a == attribute) {
                let outer = given.expr.span;
                self.instance.names().check_final(arg.final_, Some(outer), arg.span, attribute);
                continue;
            }
            let binding = Binding { expr, view: arg.view, access: arg.access.clone(), final_: arg.final_ };
            attributes.push((attribute, binding));
        }
        attributes
    }

    /// The attribute `stateSelect` of variable `i`. Without it, or after a message, the default.
    /// It is needed as a number already here, since it is a property of the variable and no expression of the flat
    /// model.
    fn state_select(&mut self, i: u32) -> StateSelect {
        let attributes = &self.instance.variables[i as usize].attributes;
        let Some((name, b)) = attributes.iter().find(|(n, _)| *n == "stateSelect").cloned() else {
            return StateSelect::Default;
        };
        // The numbers are those of the literals in `StateSelect`; 3 is the default.
        match self.instance.parameters().known_attribute(i, name, &b, ScalarType::Enumeration(STATE_SELECT)) {
            Some(1.0) => StateSelect::Never,
            Some(2.0) => StateSelect::Avoid,
            Some(4.0) => StateSelect::Prefer,
            Some(5.0) => StateSelect::Always,
            _ => StateSelect::Default,
        }
    }
}

/// What is the same for all elements of a component array.
#[derive(Clone)]
pub(in crate::instance) struct ComponentPlan<'a> {
    /// The full name, without array subscripts.
    pub name: String,
    /// The scope that holds the component.
    pub scope: ScopeId,
    /// Its index in the scope's template. `None` for members that connections add to a bus.
    pub index: Option<u32>,
    /// The first declaration, not a redeclaration.
    pub declared: &'a ast::ComponentDeclaration,
    /// Prefixes for its elements.
    pub prefix: InheritedPrefixes,
    /// The name in the declaration, for messages.
    pub span: Span,
    /// The number of components around it.
    pub depth: usize,
}

/// The value of a component on its way to its variables.
#[derive(Clone)]
struct ComponentValue<'a> {
    /// The expression, with the steps to this element.
    binding: Option<Binding<'a>>,
    /// The component is `final`.
    final_: bool,
}

/// The names of the attributes of a predefined type (MLS 4.9).
/// Modifiers of other names are errors. External objects have no attributes.
pub(in crate::instance) fn attributes_of(builtin: BuiltinType) -> &'static [&'static str] {
    match builtin {
        BuiltinType::Real => {
            &["start", "fixed", "min", "max", "nominal", "unit", "displayUnit", "quantity", "stateSelect", "unbounded"]
        }
        BuiltinType::Integer | BuiltinType::Enumeration(_) => &["start", "fixed", "min", "max", "quantity"],
        BuiltinType::Boolean | BuiltinType::String => &["start", "fixed", "quantity"],
        BuiltinType::Object => &[],
    }
}

/// The full name of a component inside `owner`. The model itself has an empty name.
fn joined(owner: &str, name: Symbol) -> String {
    if owner.is_empty() { name.as_str().to_string() } else { format!("{owner}.{name}") }
}

/// The index of an element from its position in row-major order, with the sizes.
/// For `dims` `[2, 3]` the position 4 is `[1, 1]`, counted from 0.
fn unravel(mut flat: usize, dims: &[usize]) -> Vec<ArrayPosition> {
    let small = |n: usize| u32::try_from(n).expect("limited above");
    let mut index = vec![ArrayPosition { place: 0, of: 0 }; dims.len()];
    for (i, &d) in dims.iter().enumerate().rev() {
        index[i] = ArrayPosition { place: small(flat % d), of: small(d) };
        flat /= d;
    }
    index
}

/// The start value that modifiers give an array. It is used to find sizes, so `each` is left out.
/// The array needs it only if its dimensions are `:` and it has no binding equation.
fn start_of<'a>(args: &[Modifier<'a>]) -> Option<Binding<'a>> {
    args.iter().find_map(|arg| match arg.kind {
        ModifierKind::Modify([name], Some(m)) if name.name == "start" && !arg.each => {
            let expr = m.value.as_ref()?;
            Some(Binding { expr, view: arg.view, access: arg.access.clone(), final_: arg.final_ })
        }
        _ => None,
    })
}

/// The value of a Boolean annotation of a component, as `HideResult` (MLS 18.3). `None` if it has none.
fn annotated(c: &ast::ComponentDeclaration, name: &str) -> Option<bool> {
    says(c.annotation.as_ref()?, name)
}

/// The value of a Boolean annotation. `None` if it is missing or not written as `true` or `false`.
/// An annotation is not evaluated, so an expression other than a literal is ignored.
pub(in crate::instance) fn says(annotation: &ast::Modification, name: &str) -> Option<bool> {
    annotation.arguments.iter().find_map(|a| match &a.kind {
        ast::ModificationArgumentKind::Modify { path, modification: Some(m), .. } if path.parts[0].name == name => {
            match m.value.as_ref().map(|v| &v.kind) {
                Some(ExprKind::Boolean(said)) => Some(*said),
                _ => None,
            }
        }
        _ => None,
    })
}

/// `k` if a subscript is `size(A, k)` in the dimensions of `A` itself, else `None`.
///
/// ```text
/// Real A[3, size(A, 1)];   // the second size is that of the first dimension
/// ```
fn own_size(subscript: &Subscript, own: Symbol) -> Option<usize> {
    let Subscript::Expr(Expr { kind: ExprKind::Call { function, args, .. }, .. }) = subscript else { return None };
    let named =
        |e: &Expr| matches!(&e.kind, ExprKind::Reference(r) if r.parts.len() == 1 && r.parts[0].name.name == own);
    match (function.parts.as_slice(), args.as_slice()) {
        ([size], [array, Expr { kind: ExprKind::Integer(k), .. }]) if size.name.name == "size" && named(array) => {
            usize::try_from(*k).ok()
        }
        _ => None,
    }
}
