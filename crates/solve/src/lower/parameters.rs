//! Evaluation of parameters from their bindings, one by one, so that each of them can be overridden.
//!
//! [`draft`] collects the bindings, [`BindingEvaluator`] runs them. It is called once per set of parameters, so it is
//! always interpreted.

use super::code::KernelCode;
use super::interpret::Bytecode;
use super::layout::{ValueLayout, ValueSlot, slot};
use super::program::KernelDefinitions;
use super::shape::{KernelId, KernelShaper, KernelTable, ShapingRules};
use bramah_expr::VarId;
use bramah_expr::function::Function;
use bramah_model::structure::Dae;
use rustc_hash::FxHashMap;

/// The bindings of all parameters that have one, in an order in which each reads earlier ones only.
#[derive(Clone, Debug, Default)]
pub struct BindingEvaluator {
    /// For each parameter its variable, its kernel, and where its slots begin in `table`.
    parameters: Vec<(VarId, KernelId, u32)>,
    /// For each parameter the slots of the binding's inputs, then its own slot.
    table: Vec<ValueSlot>,
    /// For each kernel the number of its inputs and its code.
    codes: FxHashMap<KernelId, (usize, Bytecode)>,
    /// First slot of the scratch region.
    scratch: usize,
}

/// The definitions of `dae.parameters`, and the variables in the same order.
pub fn draft(dae: &Dae, shaper: &mut KernelShaper) -> (Vec<VarId>, KernelDefinitions) {
    let inline = FxHashMap::default();
    // nothing is hoisted: hoisted parts are computed from these parameters
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
    /// Makes the code of the definitions from [`draft`].
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

    /// Number of scratch places that the code needs.
    pub fn scratch(&self) -> u32 {
        self.codes.values().map(|(_, code)| code.scratch()).max().unwrap_or(0)
    }

    /// Sets where the scratch region begins.
    pub fn relocate(&mut self, base: ValueSlot) {
        self.scratch = base as usize;
        self.codes.values_mut().for_each(|(_, code)| code.relocate(base));
    }

    /// Computes those parameters for which `wanted` returns true.
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
