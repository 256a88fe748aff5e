//! A model ready to run: what the front half of the pipeline made, lowered to kernels.

use bramah_expr::VarId;
use bramah_model::compile::{CompileOutcome, Request, analyze, sort, sort_messages};
use bramah_model::flat::FlatModel;
use bramah_model::network::ComponentGraph;
use bramah_model::structure::{self, Dae, StateChoice};
use bramah_solve::lower::{self, ExecutableSystem};
use bramah_syntax::diag::Diagnostic;
use bramah_syntax::world::World;
use std::sync::Arc;

/// A model ready to run.
#[derive(Clone, Debug)]
pub struct CompiledModel {
    /// Scalar variables and equations; kept so that other states can be chosen during a run.
    pub flat: Arc<FlatModel>,
    /// Components and connections of the top level.
    pub graph: ComponentGraph,
    /// Sorted equations.
    pub dae: Arc<Dae>,
    /// Kernels.
    pub system: Arc<ExecutableSystem>,
}

impl CompiledModel {
    /// The same model lowered for other states; for `solve::Control::reselect`.
    pub fn with_states(&self, choice: &StateChoice) -> Option<Arc<ExecutableSystem>> {
        let dae = structure::analyze(&self.flat, choice).value?;
        Some(Arc::new(lower::lower(Arc::new(dae), &lower::LoweringOptions::default())))
    }

    /// The same model whose parameters have these values from the beginning; sorted anew.
    ///
    /// # Errors
    /// Where the equations do not determine the unknowns with these values.
    pub fn with_values(&self, values: &[(VarId, f64)]) -> Result<CompiledModel, Vec<Diagnostic>> {
        let mut flat = FlatModel::clone(&self.flat);
        for &(v, value) in values {
            // The value becomes the binding, as if it had been written in the text.
            flat.variables[v.index()].binding = Some(flat.exprs.num(value));
        }
        let sorted = analyze(&flat);
        let dae = Arc::new(sorted.value.ok_or(sorted.diagnostics)?);
        let system = Arc::new(lower::lower(dae.clone(), &lower::LoweringOptions::default()));
        Ok(CompiledModel { flat: Arc::new(flat), graph: self.graph.clone(), dae, system })
    }
}

/// The whole pipeline.
pub fn compile(
    world: &dyn World,
    request: &Request,
    options: &lower::LoweringOptions,
) -> CompileOutcome<CompiledModel> {
    let CompileOutcome { sources, mut diagnostics, value } = sort(world, request);
    let model = value.map(|(flat, graph, dae)| {
        let dae = Arc::new(dae);
        let system = Arc::new(lower::lower(dae.clone(), options));
        CompiledModel { flat: Arc::new(flat), graph, dae, system }
    });
    // Messages of all stages in the order of their places.
    sort_messages(&mut diagnostics);
    CompileOutcome { sources, diagnostics, value: model }
}
