//! The functions of an FMU's library, and all `unsafe` that calling them needs.
//! A library on the disk enters; instances leave, whose methods call the functions of FMI 2.0 or 3.0 alike.
//! `pool` makes the instances and calls them in the order that the standards require.
//! Source: the headers of FMI 2.0.4 and 3.0.2.
//!
//! Faults of the library cannot be contained: one that writes to a wrong address can bring the process down, as in any
//! tool that loads it.

#![allow(unsafe_code, reason = "calls functions of C by pointers that their library gives")]

use super::FmuError;
use super::archive::FmuFiles;
use super::description::{FmuDataType, FmuDescription, FmuInterface, FmuStandard};
use libloading::Library;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::Path;
use std::ptr;
use std::sync::{Arc, Mutex, PoisonError};

/// An instance, a pointer that only the unit can interpret.
type InstancePointer = *mut c_void;
/// The status that nearly all functions return: 0 and 1 are success, larger numbers are failures.
type FmuStatus = c_int;

/// Declares a table of the functions of a library by their names. A library may lack any of them.
macro_rules! functions {
    ($(#[$doc:meta])* $table:ident { $($field:ident: $symbol:literal fn($($arg:ty),*) $(-> $back:ty)?;)* }) => {
        $(#[$doc])*
        #[derive(Debug)]
        struct $table { $($field: Option<unsafe extern "C" fn($($arg),*) $(-> $back)?>,)* }

        impl $table {
            fn load(library: &Library) -> Self {
                // SAFETY: the types are those of the standard's headers for functions of these names.
                unsafe { $table { $($field: library.get($symbol).ok().map(|s| *s),)* } }
            }
        }
    };
}

// The fields are named by what the functions do; both tables use the same names where they can.
functions! {
    /// FMI 2.0
    Two {
        instantiate: "fmi2Instantiate"
            fn(*const c_char, c_int, *const c_char, *const c_char, *const FmuCallbacks, c_int, c_int) -> InstancePointer;
        free: "fmi2FreeInstance" fn(InstancePointer);
        setup: "fmi2SetupExperiment" fn(InstancePointer, c_int, f64, f64, c_int, f64) -> FmuStatus;
        enter_initialization: "fmi2EnterInitializationMode" fn(InstancePointer) -> FmuStatus;
        exit_initialization: "fmi2ExitInitializationMode" fn(InstancePointer) -> FmuStatus;
        reset: "fmi2Reset" fn(InstancePointer) -> FmuStatus;
        get_real: "fmi2GetReal" fn(InstancePointer, *const u32, usize, *mut f64) -> FmuStatus;
        get_integer: "fmi2GetInteger" fn(InstancePointer, *const u32, usize, *mut i32) -> FmuStatus;
        get_boolean: "fmi2GetBoolean" fn(InstancePointer, *const u32, usize, *mut c_int) -> FmuStatus;
        set_real: "fmi2SetReal" fn(InstancePointer, *const u32, usize, *const f64) -> FmuStatus;
        set_integer: "fmi2SetInteger" fn(InstancePointer, *const u32, usize, *const i32) -> FmuStatus;
        set_boolean: "fmi2SetBoolean" fn(InstancePointer, *const u32, usize, *const c_int) -> FmuStatus;
        set_string: "fmi2SetString" fn(InstancePointer, *const u32, usize, *const *const c_char) -> FmuStatus;
        do_step: "fmi2DoStep" fn(InstancePointer, f64, f64, c_int) -> FmuStatus;
        enter_event: "fmi2EnterEventMode" fn(InstancePointer) -> FmuStatus;
        new_states: "fmi2NewDiscreteStates" fn(InstancePointer, *mut EventInfo) -> FmuStatus;
        enter_continuous: "fmi2EnterContinuousTimeMode" fn(InstancePointer) -> FmuStatus;
        completed: "fmi2CompletedIntegratorStep" fn(InstancePointer, c_int, *mut c_int, *mut c_int) -> FmuStatus;
        set_time: "fmi2SetTime" fn(InstancePointer, f64) -> FmuStatus;
        set_states: "fmi2SetContinuousStates" fn(InstancePointer, *const f64, usize) -> FmuStatus;
        get_states: "fmi2GetContinuousStates" fn(InstancePointer, *mut f64, usize) -> FmuStatus;
        get_derivatives: "fmi2GetDerivatives" fn(InstancePointer, *mut f64, usize) -> FmuStatus;
        get_indicators: "fmi2GetEventIndicators" fn(InstancePointer, *mut f64, usize) -> FmuStatus;
        directional: "fmi2GetDirectionalDerivative"
            fn(InstancePointer, *const u32, usize, *const u32, usize, *const f64, *mut f64) -> FmuStatus;
    }
}

// The types of the pointers to values distinguish these functions from those of FMI 2.0, which has fewer types.
functions! {
    /// FMI 3.0
    Three {
        instantiate_me: "fmi3InstantiateModelExchange"
            fn(*const c_char, *const c_char, *const c_char, bool, bool, *mut c_void, FmuLogCallback) -> InstancePointer;
        instantiate_cs: "fmi3InstantiateCoSimulation"
            fn(*const c_char, *const c_char, *const c_char, bool, bool, bool, bool, *const u32, usize, *mut c_void, FmuLogCallback,
               *const c_void) -> InstancePointer;
        free: "fmi3FreeInstance" fn(InstancePointer);
        enter_initialization: "fmi3EnterInitializationMode" fn(InstancePointer, bool, f64, f64, bool, f64) -> FmuStatus;
        exit_initialization: "fmi3ExitInitializationMode" fn(InstancePointer) -> FmuStatus;
        reset: "fmi3Reset" fn(InstancePointer) -> FmuStatus;
        get_float64: "fmi3GetFloat64" fn(InstancePointer, *const u32, usize, *mut f64, usize) -> FmuStatus;
        get_float32: "fmi3GetFloat32" fn(InstancePointer, *const u32, usize, *mut f32, usize) -> FmuStatus;
        get_int8: "fmi3GetInt8" fn(InstancePointer, *const u32, usize, *mut i8, usize) -> FmuStatus;
        get_uint8: "fmi3GetUInt8" fn(InstancePointer, *const u32, usize, *mut u8, usize) -> FmuStatus;
        get_int16: "fmi3GetInt16" fn(InstancePointer, *const u32, usize, *mut i16, usize) -> FmuStatus;
        get_uint16: "fmi3GetUInt16" fn(InstancePointer, *const u32, usize, *mut u16, usize) -> FmuStatus;
        get_int32: "fmi3GetInt32" fn(InstancePointer, *const u32, usize, *mut i32, usize) -> FmuStatus;
        get_uint32: "fmi3GetUInt32" fn(InstancePointer, *const u32, usize, *mut u32, usize) -> FmuStatus;
        get_int64: "fmi3GetInt64" fn(InstancePointer, *const u32, usize, *mut i64, usize) -> FmuStatus;
        get_uint64: "fmi3GetUInt64" fn(InstancePointer, *const u32, usize, *mut u64, usize) -> FmuStatus;
        get_boolean: "fmi3GetBoolean" fn(InstancePointer, *const u32, usize, *mut u8, usize) -> FmuStatus;
        set_float64: "fmi3SetFloat64" fn(InstancePointer, *const u32, usize, *const f64, usize) -> FmuStatus;
        set_float32: "fmi3SetFloat32" fn(InstancePointer, *const u32, usize, *const f32, usize) -> FmuStatus;
        set_int8: "fmi3SetInt8" fn(InstancePointer, *const u32, usize, *const i8, usize) -> FmuStatus;
        set_uint8: "fmi3SetUInt8" fn(InstancePointer, *const u32, usize, *const u8, usize) -> FmuStatus;
        set_int16: "fmi3SetInt16" fn(InstancePointer, *const u32, usize, *const i16, usize) -> FmuStatus;
        set_uint16: "fmi3SetUInt16" fn(InstancePointer, *const u32, usize, *const u16, usize) -> FmuStatus;
        set_int32: "fmi3SetInt32" fn(InstancePointer, *const u32, usize, *const i32, usize) -> FmuStatus;
        set_uint32: "fmi3SetUInt32" fn(InstancePointer, *const u32, usize, *const u32, usize) -> FmuStatus;
        set_int64: "fmi3SetInt64" fn(InstancePointer, *const u32, usize, *const i64, usize) -> FmuStatus;
        set_uint64: "fmi3SetUInt64" fn(InstancePointer, *const u32, usize, *const u64, usize) -> FmuStatus;
        set_boolean: "fmi3SetBoolean" fn(InstancePointer, *const u32, usize, *const u8, usize) -> FmuStatus;
        set_string: "fmi3SetString" fn(InstancePointer, *const u32, usize, *const *const c_char, usize) -> FmuStatus;
        do_step: "fmi3DoStep" fn(InstancePointer, f64, f64, bool, *mut bool, *mut bool, *mut bool, *mut f64) -> FmuStatus;
        enter_event: "fmi3EnterEventMode" fn(InstancePointer) -> FmuStatus;
        update: "fmi3UpdateDiscreteStates"
            fn(InstancePointer, *mut bool, *mut bool, *mut bool, *mut bool, *mut bool, *mut f64) -> FmuStatus;
        enter_continuous: "fmi3EnterContinuousTimeMode" fn(InstancePointer) -> FmuStatus;
        completed: "fmi3CompletedIntegratorStep" fn(InstancePointer, bool, *mut bool, *mut bool) -> FmuStatus;
        set_time: "fmi3SetTime" fn(InstancePointer, f64) -> FmuStatus;
        set_states: "fmi3SetContinuousStates" fn(InstancePointer, *const f64, usize) -> FmuStatus;
        get_states: "fmi3GetContinuousStates" fn(InstancePointer, *mut f64, usize) -> FmuStatus;
        get_derivatives: "fmi3GetContinuousStateDerivatives" fn(InstancePointer, *mut f64, usize) -> FmuStatus;
        get_indicators: "fmi3GetEventIndicators" fn(InstancePointer, *mut f64, usize) -> FmuStatus;
        directional: "fmi3GetDirectionalDerivative"
            fn(InstancePointer, *const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize) -> FmuStatus;
    }
}

/// `fmi3LogMessageCallback` of FMI 3.0: environment, status, category, message.
type FmuLogCallback = unsafe extern "C" fn(*mut c_void, FmuStatus, *const c_char, *const c_char);

/// `fmi2CallbackFunctions` of FMI 2.0. The logger is variadic in C; here it is only passed on, so its type does not
/// matter.
#[repr(C)]
#[derive(Debug)]
struct FmuCallbacks {
    /// `fmi2CallbackLogger`, in `logger.c`.
    logger: unsafe extern "C" fn(),
    /// `fmi2CallbackAllocateMemory`: `calloc` of C.
    allocate: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    /// `fmi2CallbackFreeMemory`: `free` of C.
    free: unsafe extern "C" fn(*mut c_void),
    /// `fmi2StepFinished`, for asynchronous steps: null.
    step_finished: *const c_void,
    /// `fmi2ComponentEnvironment`: the address of the [`FmuMessages`].
    environment: *mut c_void,
}

/// `fmi2EventInfo` of FMI 2.0, in the order of its fields. Flags are 0 or 1.
#[repr(C)]
#[derive(Default)]
struct EventInfo {
    /// `newDiscreteStatesNeeded`.
    again: c_int,
    /// `terminateSimulation`.
    terminate: c_int,
    /// `nominalsOfContinuousStatesChanged`.
    nominals_changed: c_int,
    /// `valuesOfContinuousStatesChanged`.
    values_changed: c_int,
    /// `nextEventTimeDefined`.
    next_defined: c_int,
    /// `nextEventTime` (s).
    next: f64,
}

// `calloc` and `free` are given to the unit, which must use memory functions of its environment in FMI 2.0.
unsafe extern "C" {
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(block: *mut c_void);
    /// Formats the variadic message of FMI 2.0, which Rust cannot do, and calls `bramah_mockup_said`. In `logger.c`.
    fn bramah_mockup_logger();
}

/// The last messages of an instance, oldest first. The unit gets its address and hands it back with each message.
type FmuMessages = Mutex<Vec<String>>;

/// The number of messages that are kept.
const KEPT: usize = 20;

/// Keeps a message of a unit. `logger.c` calls it.
///
/// # Safety
/// `environment` is null or the address that the instance was given; `message` is null or a text of C.
#[unsafe(no_mangle)]
unsafe extern "C" fn bramah_mockup_said(environment: *mut c_void, status: FmuStatus, message: *const c_char) {
    if environment.is_null() || message.is_null() {
        return;
    }
    // SAFETY: what the caller promises; the box behind it lives as long as the instance.
    let (said, message) = unsafe { (&*environment.cast_const().cast::<FmuMessages>(), CStr::from_ptr(message)) };
    let mut lines = said.lock().unwrap_or_else(PoisonError::into_inner);
    // Messages of status OK are routine and would push out those about a failure.
    if status != 0 {
        if lines.len() == KEPT {
            lines.remove(0);
        }
        // A message is cut to 500 characters, because it becomes part of a sentence for the user.
        lines.push(message.to_string_lossy().trim().chars().take(500).collect());
    }
}

/// The callback for messages of FMI 3.0, see [`bramah_mockup_said`].
unsafe extern "C" fn log(environment: *mut c_void, status: FmuStatus, _: *const c_char, message: *const c_char) {
    // SAFETY: what the caller promises.
    unsafe { bramah_mockup_said(environment, status, message) }
}

/// The functions of a library by the version of the standard.
#[derive(Debug)]
enum FmuFunctionTable {
    Two(Two),
    Three(Three),
}

/// A loaded library, with what instances are made from.
#[derive(Debug)]
pub struct FmuLibrary {
    /// Its functions.
    functions: FmuFunctionTable,
    /// The GUID or instantiation token, which the library compares with its own.
    token: CString,
    /// The location of the resources, in the form that the standard requires.
    resources: Option<CString>,
    // Fields are dropped in order: the library after the functions, which point into it, and before its folder.
    _library: Library,
    _unpacked: FmuFiles,
}

impl FmuLibrary {
    /// Loads the library of a unit.
    ///
    /// # Errors
    /// The system cannot load it, for example because another library is missing.
    pub fn load(unpacked: FmuFiles, description: &FmuDescription) -> Result<Self, FmuError> {
        // SAFETY: the library's initializers run, as they would in any tool that loads the unit.
        let library = unsafe { Library::new(&unpacked.library) };
        let library = library.map_err(|why| format!("its library cannot be loaded: {why}"))?;
        let functions = match description.version {
            FmuStandard::Two => FmuFunctionTable::Two(Two::load(&library)),
            FmuStandard::Three => FmuFunctionTable::Three(Three::load(&library)),
        };
        let token = CString::new(description.token.as_str()).map_err(|_| "its token holds a zero")?;
        let resources = unpacked.resources.as_deref().map(|path| resources(path, description.version));
        Ok(FmuLibrary { functions, token, resources, _library: library, _unpacked: unpacked })
    }
}

/// The location of the resources as each standard requires it: a URI in FMI 2.0, a path with a final separator in 3.0.
fn resources(path: &Path, version: FmuStandard) -> CString {
    let path = path.to_string_lossy();
    let text = match version {
        FmuStandard::Two => {
            // All other bytes are percent-encoded, as in any URI.
            let plain = |b: u8| b.is_ascii_alphanumeric() || b"/-_.~".contains(&b);
            let path: String =
                path.bytes().map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect();
            format!("file://{path}")
        }
        FmuStandard::Three => format!("{path}{}", std::path::MAIN_SEPARATOR),
    };
    CString::new(text).unwrap_or_default()
}

/// The result of one pass of the event iteration.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiscreteStateUpdate {
    /// The unit needs another pass.
    pub again: bool,
    /// The unit requests the end of the simulation.
    pub terminate: bool,
    /// The unit has changed its continuous states.
    pub states_changed: bool,
    /// The time of the next event that is known in advance (s).
    pub next: Option<f64>,
}

/// An instance of a unit, freed when dropped.
pub struct ImportedFmuInstance {
    /// The library. It stays loaded as long as an instance exists.
    code: Arc<FmuLibrary>,
    /// The unit's pointer.
    raw: InstancePointer,
    /// Messages of the instance. Boxed, because the unit knows the address.
    said: Box<FmuMessages>,
    /// The callbacks. Boxed for the same reason; FMI 2.0 lets the unit keep the pointer.
    _callbacks: Box<FmuCallbacks>,
}

// SAFETY: one thread at a time uses an instance, which the standards ask for; nothing of it belongs to a thread.
unsafe impl Send for ImportedFmuInstance {}

impl std::fmt::Debug for ImportedFmuInstance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Instance").finish_non_exhaustive()
    }
}

/// Calls a function by its field in both tables, with arguments for each. The result is that of `judge`.
macro_rules! call {
    ($self:ident, two $two:ident($($a:expr),*), three $three:ident($($b:expr),*)) => {
        match &$self.code.functions {
            FmuFunctionTable::Two(f) => {
                let function = f.$two.ok_or_else(|| missing(stringify!($two)))?;
                // SAFETY: the instance lives, and the arguments are those of the header.
                $self.judge(stringify!($two), unsafe { function($self.raw, $($a),*) })
            }
            FmuFunctionTable::Three(f) => {
                let function = f.$three.ok_or_else(|| missing(stringify!($three)))?;
                // SAFETY: the instance lives, and the arguments are those of the header.
                $self.judge(stringify!($three), unsafe { function($self.raw, $($b),*) })
            }
        }
    };
}

/// The error that the library lacks a function that is needed.
/// The name of the field stands for that of the function.
fn missing(function: &str) -> FmuError {
    format!("its library has no function for `{}`", function.replace('_', " ")).into()
}

impl ImportedFmuInstance {
    /// Makes an instance.
    ///
    /// # Errors
    /// The unit refuses, or its library lacks the function. The error quotes the unit's messages.
    pub fn new(code: &Arc<FmuLibrary>, name: &str, kind: FmuInterface) -> Result<Self, FmuError> {
        let said: Box<FmuMessages> = Box::default();
        // The address stays valid when the box is moved into the instance.
        let environment = ptr::from_ref::<FmuMessages>(&said).cast_mut().cast::<c_void>();
        let callbacks = Box::new(FmuCallbacks {
            logger: bramah_mockup_logger,
            allocate: calloc,
            free,
            step_finished: ptr::null(),
            environment,
        });
        let name = CString::new(name).unwrap_or_default();
        let (token, place) = (code.token.as_ptr(), code.resources.as_deref().map_or(ptr::null(), CStr::as_ptr));
        // Logging is on: some units report nothing otherwise, not even why they fail.
        // SAFETY: texts and callbacks live as long as the instance needs them; the types are those of the headers.
        let raw = unsafe {
            match (&code.functions, kind) {
                (FmuFunctionTable::Two(f), _) => {
                    let kind = c_int::from(kind == FmuInterface::CoSimulation);
                    let make = f.instantiate.ok_or_else(|| missing("instantiate"))?;
                    make(name.as_ptr(), kind, token, place, &raw const *callbacks, 0, 1)
                }
                (FmuFunctionTable::Three(f), FmuInterface::ModelExchange) => {
                    let make = f.instantiate_me.ok_or_else(|| missing("instantiate_me"))?;
                    make(name.as_ptr(), token, place, false, true, environment, log)
                }
                (FmuFunctionTable::Three(f), FmuInterface::CoSimulation) => {
                    let make = f.instantiate_cs.ok_or_else(|| missing("instantiate_cs"))?;
                    let (none, never) = (ptr::null(), ptr::null());
                    make(name.as_ptr(), token, place, false, true, false, false, none, 0, environment, log, never)
                }
            }
        };
        if raw.is_null() {
            return Err(with_words("it cannot be instantiated".to_owned(), &said));
        }
        Ok(ImportedFmuInstance { code: code.clone(), raw, said, _callbacks: callbacks })
    }

    /// Turns the status of a function into a result. An error quotes the messages of the unit.
    fn judge(&self, function: &str, status: FmuStatus) -> Result<(), FmuError> {
        let how = match status {
            // OK and Warning. Messages about a call that succeeded would only confuse later ones.
            0 | 1 => {
                self.said.lock().unwrap_or_else(PoisonError::into_inner).clear();
                return Ok(());
            }
            2 => "was discarded",
            // 2 to 4 are Discard, Error and Fatal in both standards; 5 of FMI 2.0 is Pending.
            3 => "failed",
            4 => "failed for good",
            _ => "did not end",
        };
        Err(with_words(format!("its function for `{}` {how}", function.replace('_', " ")), &self.said))
    }

    /// Enters initialization mode, in which inputs can be set and outputs read before the start. `start` is its time
    /// (s).
    ///
    /// # Errors
    /// The unit refuses.
    pub fn enter_initialization(&mut self, start: f64) -> Result<(), FmuError> {
        // FMI 3.0 passes the times with the mode; FMI 2.0 has a function of its own for them.
        if let FmuFunctionTable::Two(f) = &self.code.functions {
            let setup = f.setup.ok_or_else(|| missing("setup"))?;
            // SAFETY: the instance lives.
            self.judge("setup", unsafe { setup(self.raw, 0, 0.0, start, 0, 0.0) })?;
        }
        call!(self, two enter_initialization(), three enter_initialization(false, 0.0, start, false, 0.0))
    }

    /// Leaves initialization mode.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn exit_initialization(&mut self) -> Result<(), FmuError> {
        call!(self, two exit_initialization(), three exit_initialization())
    }

    /// Resets the instance to the state after its creation.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn reset(&mut self) -> Result<(), FmuError> {
        call!(self, two reset(), three reset())
    }

    /// Does a communication step of Co-Simulation (s).
    ///
    /// # Errors
    /// The unit refuses, or requests the end of the simulation.
    pub fn step(&mut self, from: f64, to: f64) -> Result<(), FmuError> {
        // Without event mode and early return, which are not requested at instantiation, only `terminate` has a
        // meaning.
        let (mut event, mut terminate, mut early, mut last) = (false, false, false, from);
        call!(self, two do_step(from, to - from, 1), three do_step(from, to - from, true, &raw mut event, &raw mut terminate, &raw mut early, &raw mut last))?;
        if terminate {
            return Err(with_words("it wants the run to end".to_owned(), &self.said));
        }
        Ok(())
    }

    /// Reads a variable into as many numbers as it has elements.
    /// Boolean values become 0 and 1. Texts cannot be read and give NaN.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn get(&self, passed: FmuDataType, reference: u32, into: &mut [f64]) -> Result<(), FmuError> {
        // FMI 3.0 takes one value reference for a whole array, and the number of its elements.
        let (r, n) = (&raw const reference, into.len());
        /// Reads into numbers of another type, then converts.
        macro_rules! read {
            ($zero:expr, $two:ident, $three:ident, $to:expr) => {{
                let mut raw = vec![$zero; n];
                call!(self, two $two(r, 1, raw.as_mut_ptr().cast()), three $three(r, 1, raw.as_mut_ptr().cast(), n))?;
                into.iter_mut().zip(raw).for_each(|(x, y)| *x = $to(y));
            }};
        }
        let truth = |x: c_int| f64::from(u8::from(x != 0));
        match (passed, &self.code.functions) {
            (FmuDataType::Float64, _) => {
                let to = into.as_mut_ptr();
                return call!(self, two get_real(r, 1, to), three get_float64(r, 1, to, n));
            }
            (FmuDataType::Boolean, FmuFunctionTable::Two(_)) => read!(0 as c_int, get_boolean, get_boolean, truth),
            (FmuDataType::Boolean, FmuFunctionTable::Three(_)) => {
                read!(0_u8, get_boolean, get_boolean, |x| truth(c_int::from(x)))
            }
            (FmuDataType::Float32, _) => read!(0_f32, get_real, get_float32, f64::from),
            (FmuDataType::Int8, _) => read!(0_i8, get_integer, get_int8, f64::from),
            (FmuDataType::UInt8, _) => read!(0_u8, get_integer, get_uint8, f64::from),
            (FmuDataType::Int16, _) => read!(0_i16, get_integer, get_int16, f64::from),
            (FmuDataType::UInt16, _) => read!(0_u16, get_integer, get_uint16, f64::from),
            (FmuDataType::Int32, _) => read!(0_i32, get_integer, get_int32, f64::from),
            (FmuDataType::UInt32, _) => read!(0_u32, get_integer, get_uint32, f64::from),
            (FmuDataType::Int64, _) => read!(0_i64, get_integer, get_int64, |x: i64| x as f64),
            (FmuDataType::UInt64, _) => read!(0_u64, get_integer, get_uint64, |x: u64| x as f64),
            (FmuDataType::String, _) => into.fill(f64::NAN),
        }
        Ok(())
    }

    /// Sets a variable from numbers. Integers are rounded, and any number but 0 counts as true.
    ///
    /// # Errors
    /// The unit refuses.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates")]
    pub fn set(&mut self, passed: FmuDataType, reference: u32, from: &[f64]) -> Result<(), FmuError> {
        let (r, n) = (&raw const reference, from.len());
        /// Converts, then sets numbers of another type.
        macro_rules! write {
            ($to:expr, $two:ident, $three:ident) => {{
                let raw: Vec<_> = from.iter().map(|x| $to(*x)).collect();
                call!(self, two $two(r, 1, raw.as_ptr().cast()), three $three(r, 1, raw.as_ptr().cast(), n))
            }};
        }
        match (passed, &self.code.functions) {
            (FmuDataType::Float64, _) => {
                call!(self, two set_real(r, 1, from.as_ptr()), three set_float64(r, 1, from.as_ptr(), n))
            }
            (FmuDataType::Boolean, FmuFunctionTable::Two(_)) => {
                write!(|x| c_int::from(x != 0.0), set_boolean, set_boolean)
            }
            (FmuDataType::Boolean, FmuFunctionTable::Three(_)) => {
                write!(|x| u8::from(x != 0.0), set_boolean, set_boolean)
            }
            (FmuDataType::Float32, _) => write!(|x| x as f32, set_real, set_float32),
            (FmuDataType::Int8, _) => write!(|x: f64| x.round() as i8, set_integer, set_int8),
            (FmuDataType::UInt8, _) => write!(|x: f64| x.round() as u8, set_integer, set_uint8),
            (FmuDataType::Int16, _) => write!(|x: f64| x.round() as i16, set_integer, set_int16),
            (FmuDataType::UInt16, _) => write!(|x: f64| x.round() as u16, set_integer, set_uint16),
            (FmuDataType::Int32, _) => write!(|x: f64| x.round() as i32, set_integer, set_int32),
            (FmuDataType::UInt32, _) => write!(|x: f64| x.round() as u32, set_integer, set_uint32),
            (FmuDataType::Int64, _) => write!(|x: f64| x.round() as i64, set_integer, set_int64),
            (FmuDataType::UInt64, _) => write!(|x: f64| x.round() as u64, set_integer, set_uint64),
            (FmuDataType::String, _) => Ok(()),
        }
    }

    /// Sets a text variable.
    ///
    /// # Errors
    /// The unit refuses, or the text contains a zero byte.
    pub fn set_text(&mut self, reference: u32, text: &str) -> Result<(), FmuError> {
        let text = CString::new(text).map_err(|_| "a text with a zero inside cannot be passed on")?;
        let (r, texts) = (&raw const reference, [text.as_ptr()]);
        call!(self, two set_string(r, 1, texts.as_ptr()), three set_string(r, 1, texts.as_ptr(), 1))
    }

    /// Sets the time of Model Exchange (s), between events.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn set_time(&mut self, time: f64) -> Result<(), FmuError> {
        call!(self, two set_time(time), three set_time(time))
    }

    /// Sets the continuous states, in the order of the description.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn set_states(&mut self, x: &[f64]) -> Result<(), FmuError> {
        call!(self, two set_states(x.as_ptr(), x.len()), three set_states(x.as_ptr(), x.len()))
    }

    /// Reads the continuous states, in the order of the description.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn states(&self, x: &mut [f64]) -> Result<(), FmuError> {
        call!(self, two get_states(x.as_mut_ptr(), x.len()), three get_states(x.as_mut_ptr(), x.len()))
    }

    /// Reads the derivatives of the continuous states.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn derivatives(&self, dx: &mut [f64]) -> Result<(), FmuError> {
        call!(self, two get_derivatives(dx.as_mut_ptr(), dx.len()), three get_derivatives(dx.as_mut_ptr(), dx.len()))
    }

    /// Reads the event indicators. A change of sign is an event.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn indicators(&self, z: &mut [f64]) -> Result<(), FmuError> {
        call!(self, two get_indicators(z.as_mut_ptr(), z.len()), three get_indicators(z.as_mut_ptr(), z.len()))
    }

    /// Reads the derivatives of some variables by another one, all named by their value references.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn directional(&self, unknowns: &[u32], known: u32, into: &mut [f64]) -> Result<(), FmuError> {
        // The seed is 1, so that the product of the Jacobian with it is the derivative itself.
        let (n, known, seed) = (unknowns.len(), [known], [1.0]);
        let (u, k, s, to) = (unknowns.as_ptr(), known.as_ptr(), seed.as_ptr(), into.as_mut_ptr());
        call!(self, two directional(u, n, k, 1, s, to), three directional(u, n, k, 1, s, 1, to, n))
    }

    /// Tells the unit that a step of the integrator is completed.
    /// What the unit answers is not needed: the caller enters event mode afterwards.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn completed_step(&mut self) -> Result<(), FmuError> {
        let (mut event, mut terminate, mut event3, mut terminate3) = (0, 0, false, false);
        call!(self, two completed(1, &raw mut event, &raw mut terminate), three completed(true, &raw mut event3, &raw mut terminate3))
    }

    /// Enters event mode, in which discrete values may change.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn enter_event(&mut self) -> Result<(), FmuError> {
        call!(self, two enter_event(), three enter_event())
    }

    /// Enters continuous-time mode, which ends event mode and initialization.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn enter_continuous(&mut self) -> Result<(), FmuError> {
        call!(self, two enter_continuous(), three enter_continuous())
    }

    /// Does one pass of the unit's event iteration.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn update(&mut self) -> Result<DiscreteStateUpdate, FmuError> {
        // Both versions write to variables of their own; only those of the unit's version are read.
        let mut info = EventInfo::default();
        let (mut again, mut terminate, mut nominals, mut values, mut defined) = (false, false, false, false, false);
        let mut next = 0.0;
        call!(self, two new_states(&raw mut info), three update(&raw mut again, &raw mut terminate, &raw mut nominals, &raw mut values, &raw mut defined, &raw mut next))?;
        Ok(match &self.code.functions {
            FmuFunctionTable::Two(_) => DiscreteStateUpdate {
                again: info.again != 0,
                terminate: info.terminate != 0,
                states_changed: info.values_changed != 0,
                next: (info.next_defined != 0).then_some(info.next),
            },
            FmuFunctionTable::Three(_) => {
                DiscreteStateUpdate { again, terminate, states_changed: values, next: defined.then_some(next) }
            }
        })
    }
}

impl Drop for ImportedFmuInstance {
    fn drop(&mut self) {
        let free = match &self.code.functions {
            FmuFunctionTable::Two(f) => f.free,
            FmuFunctionTable::Three(f) => f.free,
        };
        if let Some(free) = free {
            // SAFETY: the instance lives and is used no more.
            unsafe { free(self.raw) };
        }
    }
}

/// An error from a sentence and the messages of the unit, which are taken away.
/// Several messages are separated by ` / `.
fn with_words(sentence: String, said: &FmuMessages) -> FmuError {
    let lines = std::mem::take(&mut *said.lock().unwrap_or_else(PoisonError::into_inner));
    let lines: Vec<String> = lines.into_iter().filter(|l| !l.is_empty()).collect();
    if lines.is_empty() { sentence.into() } else { format!("{sentence}; it says: {}", lines.join(" / ")).into() }
}
