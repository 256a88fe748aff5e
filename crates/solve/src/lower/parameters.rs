//! Parameters from their bindings, one by one so that any of them can be overridden.

use super::code::KernelCode;
use super::interpret::Bytecode;
use super::layout::{ValueLayout, ValueSlot, slot};
use super::program::KernelDefinitions;
use super::shape::{KernelId, KernelShaper, KernelTable, ShapingRules};
use bramah_expr::VarId;
use bramah_expr::function::Function;
use bramah_model::structure::Dae;
use rustc_hash::FxHashMap;

/// The bindings of all dependent parameters, in order.
#[derive(Clone, Debug, Default)]
pub struct BindingEvaluator {
    parameters: Vec<(VarId, KernelId, u32)>,
    /// Per parameter the slots of the binding's inputs, then its own.
    table: Vec<ValueSlot>,
    codes: FxHashMap<KernelId, (usize, Bytecode)>,
    scratch: usize,
}

/// The definitions of `dae.parameters`.
pub fn draft(dae: &Dae, shaper: &mut KernelShaper) -> (Vec<VarId>, KernelDefinitions) {
    let inline = FxHashMap::default();
    let rules = ShapingRules { initial: false, inline: &inline, hoist: false };
    let (mut variables, mut defs) = (Vec::new(), KernelDefinitions::default());
    for &v in &dae.parameters {
        if let Some(binding) = dae.variables[v.index()].binding {
            let shaped = shaper.shape(binding, &rules);
            let target = slot(shaper.layout.var(v));
            defs.define(&mut shaper.kernels, target, &shaped);
            variables.push(v);
        }
    }
    (variables, defs)
}

impl BindingEvaluator {
    /// The code of the definitions that [`draft`] made.
    pub fn new(
        variables: &[VarId],
        defs: &KernelDefinitions,
        kernels: &KernelTable,
        layout: &ValueLayout,
    ) -> BindingEvaluator {
        let mut bindings = BindingEvaluator::default();
        for (i, &v) in variables.iter().enumerate() {
            let (kernel, inputs, targets) = defs.get(kernels, i);
            bindings.codes.entry(kernel).or_insert_with(|| {
                let code = KernelCode::new(&kernels.pool, &kernels.get(kernel).outputs);
                (inputs.len(), Bytecode::looped(&code, slot(inputs.len()), layout))
            });
            bindings.parameters.push((v, kernel, slot(bindings.table.len())));
            bindings.table.extend_from_slice(inputs);
            bindings.table.extend_from_slice(targets);
        }
        bindings
    }

    /// How many scratch places the code needs.
    pub fn scratch(&self) -> u32 {
        self.codes.values().map(|(_, code)| code.scratch()).max().unwrap_or(0)
    }

    /// Tells where the scratch region begins.
    pub fn relocate(&mut self, base: ValueSlot) {
        self.scratch = base as usize;
        self.codes.values_mut().for_each(|(_, code)| code.relocate(base));
    }

    /// Computes those parameters for which `wanted` says true.
    pub fn run(&self, functions: &[Function], v: &mut [f64], wanted: impl Fn(VarId) -> bool) {
        for &(parameter, kernel, start) in &self.parameters {
            if !wanted(parameter) {
                continue;
            }
            let (inputs, code) = &self.codes[&kernel];
            let row = &self.table[start as usize..];
            for (place, &input) in (self.scratch..).zip(&row[..*inputs]) {
                v[place] = v[input as usize];
            }
            code.run(functions, v);
            v[row[*inputs] as usize] = v[self.scratch + inputs];
        }
    }
}
