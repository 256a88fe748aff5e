//! Results that an [`Instance`](crate::instance::Instance) keeps, so that nothing is computed twice.
//!
//! There is one table for each task. The views of [`crate::instance::views`] fill and read them; nothing else sees
//! them.

use crate::instance::building::given::GivenElement;
#[cfg(feature = "fmi")]
use crate::instance::building::mockup::FmuClass;
use crate::instance::template::Template;
use crate::instance::value::ModelicaValue;
use crate::instance::{ClassRef, LookupContext, NodeId, ScopeId};
use crate::resolve::ClassId;
#[cfg(feature = "fmi")]
use bramah_expr::function::ExternalFunction;
use bramah_expr::types::Variability;
use bramah_expr::{FunctionId, VarId};
use bramah_results::table::TableMatrix;
use bramah_syntax::ast;
use bramah_syntax::diag::FileId;
use bramah_syntax::symbol::Symbol;
use rustc_hash::{FxHashMap, FxHashSet};
use std::rc::Rc;
#[cfg(feature = "fmi")]
use std::sync::Arc;

/// Classes that were looked up. Keys hold the class and its surroundings, because the same text may inherit from
/// different classes at different places.
#[derive(Default)]
pub(in crate::instance) struct ClassTable<'a> {
    /// The template of each class: its elements and bases.
    pub templates: FxHashMap<(ClassId, LookupContext), Rc<Template<'a>>>,
    /// The scopes of packages without modifiers.
    pub packages: FxHashMap<(ClassId, LookupContext), ScopeId>,
    /// The scopes of packages with modifiers. There are few of them, so a linear search is enough.
    pub modified_packages: Vec<(ClassRef<'a>, ScopeId)>,
    /// Scopes that hold only what is written in a class itself. The bases of the class are looked up in these.
    pub uninherited: FxHashMap<(ClassId, LookupContext), ScopeId>,
    /// Classes whose bases are being looked up, innermost last. Meeting one of them again means that it needs itself.
    pub gathering: Vec<(ClassId, LookupContext)>,
    /// Number of bases gathered since `gathering` was last empty.
    pub gathered: usize,
    /// The limit on bases was passed and reported. From then on a lower limit holds, so that the compiler ends soon.
    pub tangled: bool,
    /// Redeclared classes whose constraining classes are being looked up, innermost last.
    pub constrained: Vec<ClassId>,
    /// Functions whose declarations were checked against MLS 12.2.
    pub checked_functions: FxHashSet<ClassId>,
    /// Classes that were checked for what their kind may hold.
    pub checked_classes: FxHashSet<ClassId>,
    /// Classes of operator records. A record value carries an index into this list.
    pub operator_records: Vec<ClassRef<'a>>,
    /// Enumeration types by class: index into `Instance::enumerations`.
    pub enumerations: FxHashMap<ClassId, u32>,
}

/// Functions that were called, and what was made of them.
#[derive(Default)]
pub(in crate::instance) struct FunctionTable<'a> {
    /// Procedures with the shapes of their outputs. The key names the function and the values that are built into it.
    pub procedures: FxHashMap<String, (FunctionId, Vec<ModelicaValue>)>,
    /// External functions that are called during the run. The key names the function and its fixed arguments.
    pub externals: FxHashMap<String, FunctionId>,
    /// Compiled C functions. The key is the source text of the wrapper.
    #[cfg(feature = "fmi")]
    pub compiled_c: FxHashMap<String, Arc<dyn ExternalFunction>>,
    /// Functions passed as arguments. A function value carries an index into this list.
    pub arguments: Vec<ClassRef<'a>>,
    /// Tables read from files, by file and table name.
    pub tables: FxHashMap<(FileId, String), Rc<TableMatrix>>,
    /// FMUs that stand in for components, by file and kind.
    #[cfg(feature = "fmi")]
    pub units: FxHashMap<(String, String), FmuClass>,
}

/// Values and properties of expressions.
#[derive(Default)]
pub(in crate::instance) struct ValueTable {
    /// Values of binding equations that are distributed over the elements of an array or the fields of a record.
    /// The flag of the key is true for values computed with parameters by value.
    pub arrays: FxHashMap<(*const ast::Expr, LookupContext, bool), ModelicaValue>,
    /// Parameters, with whether they get their value at initialization only.
    pub found_at_start: FxHashMap<VarId, bool>,
    /// The variability of each expression, by its number.
    pub variabilities: Vec<Variability>,
}

/// What concerns components while they are being built.
#[derive(Default)]
pub(in crate::instance) struct BuildingTable<'a> {
    /// `inner` components that were added for `outer` ones, by the scope of the model and their name.
    pub inner: FxHashMap<(ScopeId, Symbol), NodeId>,
    /// Whether the type of an `inner` component fits an `outer` declaration.
    pub outer_fits: FxHashMap<(NodeId, *const ast::ComponentDeclaration), bool>,
    /// Values given from outside for single elements of arrays: `a[2].p = 3`.
    pub given_elements: Vec<GivenElement<'a>>,
}
