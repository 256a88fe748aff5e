//! Machine code by Cranelift, with the same results as the interpreter to the bit.
//!
//! `program` orders code from a [`NativeCompiler`] and runs the resulting [`NativeEntry`]. `translate` writes the
//! instructions. This is the only file of this folder with `unsafe`: it calls the code and frees its memory. The calls
//! are safe because the code accesses the array of values only at slots of its layout (`Program::run` checks the
//! length of the array), and because the memory lives as long as any [`NativeEntry`].

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

/// The result of building code.
type ModuleResult<T> = Result<T, Box<ModuleError>>;

/// The signature of all compiled functions: values, table, number of rows, user functions.
type NativeFunction = unsafe extern "C" fn(*mut f64, *const ValueSlot, usize, *const FunctionList);

/// One compiled function in executable memory.
#[derive(Clone, Debug)]
pub struct NativeEntry {
    /// Its address.
    function: NativeFunction,
    /// Keeps the memory of the code alive.
    _memory: Arc<ExecutableMemory>,
}

/// The user's functions, as machine code passes them back to [`call_function`].
struct FunctionList<'a> {
    /// The functions, by their numbers in calls.
    functions: &'a [Function],
}

impl NativeEntry {
    /// Runs straight code.
    pub fn run(&self, values: &mut [f64], functions: &[Function]) {
        self.call(values, &[], 0, functions);
    }

    /// Runs a loop over the rows of `table`, each of `width` slots.
    pub fn run_table(&self, values: &mut [f64], table: &[ValueSlot], width: usize, functions: &[Function]) {
        self.call(values, table, table.len() / width, functions);
    }

    /// Calls the machine code.
    #[allow(unsafe_code, reason = "machine code is called here and nowhere else")]
    fn call(&self, values: &mut [f64], table: &[ValueSlot], rows: usize, functions: &[Function]) {
        let list = FunctionList { functions };
        // SAFETY: the code was made by `compile` with this signature, lives as long as `self._memory`, and touches
        // `values` only at slots of its layout, whose length the caller has checked.
        unsafe { (self.function)(values.as_mut_ptr(), table.as_ptr(), rows, &raw const list) }
    }
}

/// Owner of executable memory.
struct ExecutableMemory {
    /// The module that holds the memory; `None` only while it is dropped.
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
    /// Frees the memory, which the module does not do by itself.
    #[allow(unsafe_code, reason = "the memory is freed here and nowhere else")]
    fn drop(&mut self) {
        if let Some(module) = self.module.take() {
            // SAFETY: every `NativeEntry` holds this memory, so no code in it can run or be called again.
            unsafe { module.free_memory() }
        }
    }
}

/// The number of an order, by which the compiled function is found.
#[derive(Clone, Copy, Debug)]
pub struct CodeTicket(usize);

impl CodeTicket {
    /// The index of its entry in the result of [`NativeCompiler::compile`].
    pub fn index(self) -> usize {
        self.0
    }
}

/// One function to be compiled.
#[derive(Debug)]
enum NativeJob {
    /// Straight code with the slots of its outputs.
    Straight { code: Arc<KernelCode>, targets: Vec<ValueSlot> },
    /// A loop over a table, with the number of inputs of a row.
    Loop { code: Arc<KernelCode>, inputs: u32 },
}

/// Collects code that is compiled together.
#[derive(Debug, Default)]
pub struct NativeCompiler {
    /// What has been ordered.
    jobs: Vec<NativeJob>,
}

impl NativeCompiler {
    /// Orders code whose inputs are slots and whose outputs go to `targets`.
    pub fn order_straight(&mut self, code: Arc<KernelCode>, targets: Vec<ValueSlot>) -> CodeTicket {
        self.order(NativeJob::Straight { code, targets })
    }

    /// Orders a loop over a table whose rows hold the slots of inputs and outputs.
    pub fn order_loop(&mut self, code: Arc<KernelCode>, inputs: u32) -> CodeTicket {
        self.order(NativeJob::Loop { code, inputs })
    }

    /// Whether nothing was ordered.
    pub fn is_empty(&self) -> bool {
        self.jobs.is_empty()
    }

    /// Adds an order.
    fn order(&mut self, job: NativeJob) -> CodeTicket {
        self.jobs.push(job);
        CodeTicket(self.jobs.len() - 1)
    }

    /// Compiles everything that was ordered, in that order.
    ///
    /// Empty where Cranelift does not support the machine or fails; everything is then interpreted.
    pub fn compile(&self, functions: &[Function]) -> Vec<NativeEntry> {
        self.try_compile(functions).unwrap_or_default()
    }

    /// As [`NativeCompiler::compile`], with the error of Cranelift.
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

/// Whether Cranelift supports this processor.
const SUPPORTED: bool = cfg!(any(target_arch = "x86_64", target_arch = "aarch64"));

/// Settings of Cranelift.
const FLAGS: [(&str, &str); 5] = [
    ("opt_level", "speed"),
    ("is_pic", "false"),
    ("enable_verifier", "false"),
    ("enable_probestack", "false"),
    ("unwind_info", "false"),
];

/// A function that machine code calls.
struct NativeImport {
    /// Its name in the module.
    name: &'static str,
    /// Its address.
    address: fn() -> *const u8,
    /// Number of arguments; 0 for [`call_function`].
    arguments: usize,
}

/// A function of floating-point numbers.
const fn import(name: &'static str, arguments: usize, address: fn() -> *const u8) -> NativeImport {
    NativeImport { name, address, arguments }
}

/// All imported functions. They are the same as in the interpreter, so that the bits agree.
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

/// Calls a user function from machine code.
#[allow(unsafe_code, reason = "raw pointers come from machine code")]
unsafe extern "C" fn call_function(list: *const FunctionList, function: u32, args: *const f64, out: *mut f64) {
    // SAFETY: `list` is the one that `NativeEntry::call` passed in; machine code passes stack slots of the function's
    // number of inputs and outputs.
    unsafe {
        let functions = (*list).functions;
        let function = &functions[function as usize];
        let args = std::slice::from_raw_parts(args, function.inputs as usize);
        let out = std::slice::from_raw_parts_mut(out, function.outputs.len());
        // an output that the function does not set stays NaN, which the solver detects
        out.fill(f64::NAN);
        function.call(functions, args, out);
    }
}

/// Builds the functions of one module.
struct NativeModuleBuilder<'f> {
    /// The module.
    module: JITModule,
    /// The user's functions.
    functions: &'f [Function],
    /// Workspace of Cranelift, reused for all functions.
    context: FunctionBuilderContext,
    /// The imported functions by name.
    imports: FxHashMap<&'static str, FuncId>,
    /// The type of pointers.
    pointer: Type,
}

impl<'f> NativeModuleBuilder<'f> {
    /// Declares all imports.
    fn new(mut module: JITModule, functions: &'f [Function]) -> ModuleResult<Self> {
        let pointer = module.target_config().pointer_type();
        let mut imports = FxHashMap::default();
        for &NativeImport { name, arguments, .. } in IMPORTS {
            let signature = import_signature(&module, pointer, arguments);
            imports.insert(name, module.declare_function(name, Linkage::Import, &signature)?);
        }
        Ok(NativeModuleBuilder { module, functions, context: FunctionBuilderContext::new(), imports, pointer })
    }

    /// Compiles one function.
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

    /// Makes the code executable and returns the entry of each function.
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

/// The signature of an imported function.
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
