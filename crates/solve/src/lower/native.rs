//! Machine code by Cranelift: the same steps as the interpreter, to the bit.
//!
//! The only place of this folder with `unsafe`: calling the code, and freeing its memory. Why the calls are sound: code
//! reads and writes the array of values only at slots of the layout it was made for ([`NativeEntry`] is run by
//! `Program::run`, which checks the array's length), and the memory lives as long as any [`NativeEntry`] does.

use super::code::KernelCode;
use super::layout::ValueSlot;
use super::translate::NativeTranslator;
use bramah_expr::function::Function;
use bramah_expr::math;
use cranelift_codegen::ir::types::{F64, I32};
use cranelift_codegen::ir::{AbiParam, Signature, Type, UserFuncName};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{FuncId, Linkage, Module, ModuleError, default_libcall_names};
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// What making code gives.
type ModuleResult<T> = Result<T, Box<ModuleError>>;

/// Values, table, number of rows, functions.
type NativeFunction = unsafe extern "C" fn(*mut f64, *const ValueSlot, usize, *const FunctionList);

/// Code in executable memory.
#[derive(Clone, Debug)]
pub struct NativeEntry {
    function: NativeFunction,
    /// Keeps the code alive.
    _memory: Arc<ExecutableMemory>,
}

/// The user's functions, for calls out of machine code.
struct FunctionList<'a> {
    functions: &'a [Function],
}

impl NativeEntry {
    /// Runs straight code.
    pub fn run(&self, values: &mut [f64], functions: &[Function]) {
        self.call(values, &[], 0, functions);
    }

    /// Runs a loop over the rows of `table`.
    pub fn run_table(&self, values: &mut [f64], table: &[ValueSlot], width: usize, functions: &[Function]) {
        self.call(values, table, table.len() / width, functions);
    }

    #[allow(unsafe_code, reason = "machine code is called here and nowhere else")]
    fn call(&self, values: &mut [f64], table: &[ValueSlot], rows: usize, functions: &[Function]) {
        let list = FunctionList { functions };
        // SAFETY: the code was made by `compile` with this signature, lives as long as `self._memory`, and touches
        // `values` only at slots of its layout, whose length the caller has checked.
        unsafe { (self.function)(values.as_mut_ptr(), table.as_ptr(), rows, &raw const list) }
    }
}

/// Owns executable memory.
struct ExecutableMemory {
    module: Option<JITModule>,
}

impl std::fmt::Debug for ExecutableMemory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Memory")
    }
}

// SAFETY: after `compile` nothing touches the module until it is dropped, once, by whoever holds the last `Arc`; the
// memory behind it is only executed.
#[allow(unsafe_code, reason = "see above")]
unsafe impl Send for ExecutableMemory {}
// SAFETY: as for `Send`.
#[allow(unsafe_code, reason = "see above")]
unsafe impl Sync for ExecutableMemory {}

impl Drop for ExecutableMemory {
    #[allow(unsafe_code, reason = "the memory is freed here and nowhere else")]
    fn drop(&mut self) {
        if let Some(module) = self.module.take() {
            // SAFETY: every `NativeEntry` holds this memory, so no code in it can run or be called again.
            unsafe { module.free_memory() }
        }
    }
}

/// Which of the ordered codes a program wants.
#[derive(Clone, Copy, Debug)]
pub struct CodeTicket(usize);

impl CodeTicket {
    /// The place of its entry in the result of [`NativeCompiler::compile`].
    pub fn index(self) -> usize {
        self.0
    }
}

#[derive(Debug)]
enum NativeJob {
    Straight { code: Arc<KernelCode>, targets: Vec<ValueSlot> },
    Loop { code: Arc<KernelCode>, inputs: u32 },
}

/// Collects codes to be compiled together.
#[derive(Debug, Default)]
pub struct NativeCompiler {
    jobs: Vec<NativeJob>,
}

impl NativeCompiler {
    /// Code whose inputs are slots and whose outputs go to `targets`.
    pub fn order_straight(&mut self, code: Arc<KernelCode>, targets: Vec<ValueSlot>) -> CodeTicket {
        self.order(NativeJob::Straight { code, targets })
    }

    /// Code for a loop over a table whose rows hold the slots of inputs and outputs.
    pub fn order_loop(&mut self, code: Arc<KernelCode>, inputs: u32) -> CodeTicket {
        self.order(NativeJob::Loop { code, inputs })
    }

    /// True when nothing was ordered.
    pub fn is_empty(&self) -> bool {
        self.jobs.is_empty()
    }

    fn order(&mut self, job: NativeJob) -> CodeTicket {
        self.jobs.push(job);
        CodeTicket(self.jobs.len() - 1)
    }

    /// Machine code for everything that was ordered, in that order; nothing where the machine is not supported, and
    /// all is then interpreted.
    pub fn compile(&self, functions: &[Function]) -> Vec<NativeEntry> {
        self.try_compile(functions).unwrap_or_default()
    }

    fn try_compile(&self, functions: &[Function]) -> ModuleResult<Vec<NativeEntry>> {
        if self.jobs.is_empty() || !SUPPORTED {
            return Ok(Vec::new());
        }
        let mut builder = JITBuilder::with_flags(&FLAGS, default_libcall_names())?;
        for import in IMPORTS {
            builder.symbol(import.name, (import.address)());
        }
        let mut foundry = NativeModuleBuilder::new(JITModule::new(builder), functions)?;
        let ids = self.jobs.iter().map(|job| foundry.define(job)).collect::<ModuleResult<Vec<FuncId>>>()?;
        foundry.finish(&ids)
    }
}

/// Whether Cranelift knows this machine.
const SUPPORTED: bool = cfg!(any(target_arch = "x86_64", target_arch = "aarch64"));

const FLAGS: [(&str, &str); 5] = [
    ("opt_level", "speed"),
    ("is_pic", "false"),
    ("enable_verifier", "false"),
    ("enable_probestack", "false"),
    ("unwind_info", "false"),
];

/// A function called from machine code.
struct NativeImport {
    name: &'static str,
    address: fn() -> *const u8,
    /// Number of arguments; 0 for [`call_function`].
    arguments: usize,
}

const fn import(name: &'static str, arguments: usize, address: fn() -> *const u8) -> NativeImport {
    NativeImport { name, address, arguments }
}

const IMPORTS: &[NativeImport] = &[
    import("exp", 1, || math::exp as *const u8),
    import("log", 1, || math::log as *const u8),
    import("log10", 1, || math::log10 as *const u8),
    import("sin", 1, || math::sin as *const u8),
    import("cos", 1, || math::cos as *const u8),
    import("tan", 1, || math::tan as *const u8),
    import("asin", 1, || math::asin as *const u8),
    import("acos", 1, || math::acos as *const u8),
    import("atan", 1, || math::atan as *const u8),
    import("sinh", 1, || math::sinh as *const u8),
    import("cosh", 1, || math::cosh as *const u8),
    import("tanh", 1, || math::tanh as *const u8),
    import("floor", 1, || math::floor as *const u8),
    import("pow", 2, || math::pow as *const u8),
    import("atan2", 2, || math::atan2 as *const u8),
    import(CALL_FUNCTION, 0, || call_function as *const u8),
];

/// The name of [`call_function`] in machine code.
pub const CALL_FUNCTION: &str = "call_function";

/// A call of a user function out of machine code.
#[allow(unsafe_code, reason = "raw pointers come from machine code")]
unsafe extern "C" fn call_function(list: *const FunctionList, function: u32, args: *const f64, out: *mut f64) {
    // SAFETY: `list` is the one that `NativeEntry::call` passed in; machine code passes stack slots of the function's number
    // of inputs and outputs.
    unsafe {
        let functions = (*list).functions;
        let function = &functions[function as usize];
        let args = std::slice::from_raw_parts(args, function.inputs as usize);
        let out = std::slice::from_raw_parts_mut(out, function.outputs.len());
        out.fill(f64::NAN);
        function.call(functions, args, out);
    }
}

/// Defines functions in a module.
struct NativeModuleBuilder<'f> {
    module: JITModule,
    functions: &'f [Function],
    context: FunctionBuilderContext,
    imports: FxHashMap<&'static str, FuncId>,
    pointer: Type,
}

impl<'f> NativeModuleBuilder<'f> {
    fn new(mut module: JITModule, functions: &'f [Function]) -> ModuleResult<Self> {
        let pointer = module.target_config().pointer_type();
        let mut imports = FxHashMap::default();
        for &NativeImport { name, arguments, .. } in IMPORTS {
            let signature = import_signature(&module, pointer, arguments);
            imports.insert(name, module.declare_function(name, Linkage::Import, &signature)?);
        }
        Ok(NativeModuleBuilder { module, functions, context: FunctionBuilderContext::new(), imports, pointer })
    }

    fn define(&mut self, job: &NativeJob) -> ModuleResult<FuncId> {
        let mut context = self.module.make_context();
        for _ in 0..4 {
            context.func.signature.params.push(AbiParam::new(self.pointer));
        }
        let id = self.module.declare_anonymous_function(&context.func.signature)?;
        context.func.name = UserFuncName::user(0, id.as_u32());
        let config = self.module.target_config();
        let builder = FunctionBuilder::new(&mut context.func, &mut self.context);
        let mut translator = NativeTranslator::new(builder, &mut self.module, &self.imports, self.functions);
        match job {
            NativeJob::Straight { code, targets } => translator.straight(code, targets),
            NativeJob::Loop { code, inputs } => translator.looped(code, *inputs),
        }
        translator.builder.finalize(config);
        self.module.define_function(id, &mut context)?;
        self.module.clear_context(&mut context);
        Ok(id)
    }

    #[allow(unsafe_code, reason = "an address becomes a function")]
    fn finish(mut self, ids: &[FuncId]) -> ModuleResult<Vec<NativeEntry>> {
        self.module.finalize_definitions()?;
        let addresses: Vec<*const u8> = ids.iter().map(|&id| self.module.get_finalized_function(id)).collect();
        let memory = Arc::new(ExecutableMemory { module: Some(self.module) });
        let entry = |address| {
            // SAFETY: each function was defined with the signature of `NativeFunction`.
            let function = unsafe { std::mem::transmute::<*const u8, NativeFunction>(address) };
            NativeEntry { function, _memory: memory.clone() }
        };
        Ok(addresses.into_iter().map(entry).collect())
    }
}

fn import_signature(module: &JITModule, pointer: Type, arguments: usize) -> Signature {
    let mut signature = module.make_signature();
    if arguments == 0 {
        signature.params.extend([pointer, I32, pointer, pointer].map(AbiParam::new));
    } else {
        signature.params.resize(arguments, AbiParam::new(F64));
        signature.returns.push(AbiParam::new(F64));
    }
    signature
}
