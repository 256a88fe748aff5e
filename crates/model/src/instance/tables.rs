//! What an [`Instance`](crate::instance::Instance) keeps so that nothing is worked out twice: one table for each task.

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

/// Classes that were looked up, by class and by the place from which they are seen.
#[derive(Default)]
pub(in crate::instance) struct ClassTable<'a> {
    /// What a class holds.
    pub templates: FxHashMap<(ClassId, LookupContext), Rc<Template<'a>>>,
    /// The scopes of packages.
    pub packages: FxHashMap<(ClassId, LookupContext), ScopeId>,
    /// The scopes of packages that modifiers change; few, so they are compared one by one.
    pub modified_packages: Vec<(ClassRef<'a>, ScopeId)>,
    /// Classes as they are written, without what they inherit: their bases are looked up there.
    pub uninherited: FxHashMap<(ClassId, LookupContext), ScopeId>,
    /// Classes whose bases are being looked up, innermost last. A class that is met again needs itself.
    pub gathering: Vec<(ClassId, LookupContext)>,
    /// Bases gathered since the outermost entry of `gathering`.
    pub gathered: usize,
    /// More bases were gathered than any library has: from here on the search gives up early.
    pub tangled: bool,
    /// Redeclared classes whose constraints are being looked up, innermost last.
    pub constrained: Vec<ClassId>,
    /// Functions that passed the check of what functions may do.
    pub checked_functions: FxHashSet<ClassId>,
    /// Classes that passed the check of what their kind may hold.
    pub checked_classes: FxHashSet<ClassId>,
    /// Classes of operator records, by the numbers that their values carry.
    pub operator_records: Vec<ClassRef<'a>>,
    /// Enumeration types: index into `Instance::enumerations`.
    pub enumerations: FxHashMap<ClassId, u32>,
}

/// Functions that were called.
#[derive(Default)]
pub(in crate::instance) struct FunctionTable<'a> {
    /// Procedures with the shapes of their outputs, by function and by what is built into them.
    pub procedures: FxHashMap<String, (FunctionId, Vec<ModelicaValue>)>,
    /// External functions that stay calls, by what they are.
    pub externals: FxHashMap<String, FunctionId>,
    /// Compiled C functions, by the text of their wrappers.
    #[cfg(feature = "fmi")]
    pub compiled_c: FxHashMap<String, Arc<dyn ExternalFunction>>,
    /// Functions that were given as arguments, by the numbers that their values carry.
    pub arguments: Vec<ClassRef<'a>>,
    /// Tables read from files, by file and name.
    pub tables: FxHashMap<(FileId, String), Rc<TableMatrix>>,
    /// Units of other tools, by file and kind.
    #[cfg(feature = "fmi")]
    pub units: FxHashMap<(String, String), FmuClass>,
}

/// What is known of values and expressions.
#[derive(Default)]
pub(in crate::instance) struct ValueTable {
    /// Values of arrays that are written as one expression; true for those that count by the values of parameters.
    pub arrays: FxHashMap<(*const ast::Expr, LookupContext, bool), ModelicaValue>,
    /// Parameters, with whether their value is only found at the start of a run.
    pub found_at_start: FxHashMap<VarId, bool>,
    /// When each expression may change, by its number.
    pub variabilities: Vec<Variability>,
}

/// What concerns components while they are being built.
#[derive(Default)]
pub(in crate::instance) struct BuildingTable<'a> {
    /// `inner` components by scope and name.
    pub inner: FxHashMap<(ScopeId, Symbol), NodeId>,
    /// Whether an `inner` component fits an `outer` declaration.
    pub outer_fits: FxHashMap<(NodeId, *const ast::ComponentDeclaration), bool>,
    /// Values given from outside for single elements of arrays.
    pub given_elements: Vec<GivenElement<'a>>,
}
