//! The C interfaces of FMI 2.0.5 and 3.0.2 (Co-Simulation, Model Exchange): pointers of the simulator made references, panics made errors.
//! All `unsafe` of the library is here.
//!
//! What both have in common is a function of [`FmuComponent`]; the functions of one standard only read its arguments.

#![allow(non_snake_case, reason = "names of the standard")]
#![allow(unsafe_code, reason = "a C interface")]

use crate::unit::{CallOutcome, FmuInstance, FmuMode, FmuSnapshot};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

const OK: c_int = 0;
const DISCARD: c_int = 2;
const ERROR: c_int = 3;

/// Where messages go.
enum LoggerTarget {
    Two { logger: Option<Fmi2Logger>, environment: *mut c_void, name: CString },
    Three { logger: Option<Fmi3Logger>, environment: *mut c_void },
}

type Fmi2Logger = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);
type Fmi3Logger = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

impl LoggerTarget {
    fn say(&self, status: c_int, message: &str) {
        let category = if status == OK { c"logStatusWarning" } else { c"logStatusError" };
        let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
        match self {
            // SAFETY: the simulator's own function, with the arguments that its standard fixes; the text is no format.
            LoggerTarget::Two { logger: Some(logger), environment, name } => unsafe {
                logger(*environment, name.as_ptr(), status, category.as_ptr(), c"%s".as_ptr(), text.as_ptr());
            },
            // SAFETY: as above.
            LoggerTarget::Three { logger: Some(logger), environment } => unsafe {
                logger(*environment, status, category.as_ptr(), text.as_ptr());
            },
            _ => {}
        }
    }
}

/// An instance with what C asks of it.
struct FmuComponent {
    unit: FmuInstance,
    log: LoggerTarget,
    terminated: bool,
}

impl FmuComponent {
    fn begin(log: LoggerTarget, resources: PathBuf, token: &str, kind: FmuMode) -> *mut c_void {
        let made = catch_unwind(AssertUnwindSafe(|| FmuInstance::new(&resources, token, kind)));
        match made.unwrap_or_else(|_| Err("this is a bug of bramah".to_owned())) {
            Ok(unit) => Box::into_raw(Box::new(FmuComponent { unit, log, terminated: false })).cast(),
            Err(why) => {
                log.say(ERROR, &why);
                std::ptr::null_mut()
            }
        }
    }

    fn step(&mut self, from: f64, length: f64) -> Result<(), String> {
        let stands = self.unit.time();
        // times that a simulator adds up differ by rounding
        if (from - stands).abs() > 0.01 * length.abs() {
            return Err(format!("a step from {from} s, and the unit stands at {stands} s"));
        }
        self.terminated = self.unit.step_to(from + length)? == CallOutcome::Terminated;
        for warning in self.unit.warnings() {
            self.log.say(OK, &warning);
        }
        Ok(())
    }

    /// An event, with what it warns of.
    fn happen(&mut self) -> Result<FmuEventResult, String> {
        let found = self.unit.exchange(|e| e.event())?;
        for warning in self.unit.warnings() {
            self.log.say(OK, &warning);
        }
        Ok(FmuEventResult { terminate: found.terminated.is_some(), states: found.states_changed, next: found.next })
    }

    /// Numbers of the states.
    fn states(
        &mut self,
        into: &mut [f64],
        of: impl FnOnce(&mut bramah::Exchange<'_>) -> Result<Vec<f64>, bramah::Error>,
    ) -> Result<(), String> {
        self.counted(into.len(), self.unit.states())?;
        into.copy_from_slice(&self.unit.exchange(of)?);
        Ok(())
    }

    fn counted(&self, given: usize, needed: usize) -> Result<(), String> {
        if given == needed { Ok(()) } else { Err(format!("there are {needed} numbers, not {given}")) }
    }

    fn get<T>(&mut self, references: &[u32], values: &mut [T], of: impl Fn(f64) -> T) -> Result<(), String> {
        for (reference, value) in references.iter().zip(values) {
            *value = of(self.unit.get(*reference)?);
        }
        Ok(())
    }

    fn set<T: Copy>(&mut self, references: &[u32], values: &[T], of: impl Fn(T) -> f64) -> Result<(), String> {
        references.iter().zip(values).try_for_each(|(reference, value)| self.unit.set(*reference, of(*value)))
    }
}

/// What came of an event.
struct FmuEventResult {
    terminate: bool,
    states: bool,
    next: Option<f64>,
}

impl FmuEventResult {
    /// In the order of both standards: once more, terminate, other nominal values, other states, a next event. One pass of
    /// a unit is its whole iteration, and nominal values stay.
    fn flags(&self) -> [bool; 5] {
        [false, self.terminate, false, self.states, self.next.is_some()]
    }
}

/// Puts a value into a place of the simulator.
///
/// # Safety
/// Null, or a place for such a value.
unsafe fn put<T>(place: *mut T, value: T) -> Result<(), String> {
    // SAFETY: as the caller promises.
    match unsafe { place.as_mut() } {
        Some(place) => *place = value,
        None => return Err("there is no place for the answer".to_owned()),
    }
    Ok(())
}

/// Acts on an instance; what goes wrong is logged.
///
/// # Safety
/// `instance` is null, or comes from an instantiation of this library and is used by no other thread.
unsafe fn with(instance: *mut c_void, act: impl FnOnce(&mut FmuComponent) -> Result<(), String>) -> c_int {
    // SAFETY: as the caller promises.
    let Some(component) = (unsafe { instance.cast::<FmuComponent>().as_mut() }) else { return ERROR };
    let result = catch_unwind(AssertUnwindSafe(|| act(component)));
    match result.unwrap_or_else(|_| Err("this is a bug of bramah".to_owned())) {
        Ok(()) => OK,
        Err(why) => {
            component.log.say(ERROR, &why);
            ERROR
        }
    }
}

/// A step of the simulator's integrator ends: neither an event nor the end of the run follows from that.
///
/// # Safety
/// As [`with`]; the places are null or places for such values.
unsafe fn step_completed<T: Copy>(instance: *mut c_void, places: [*mut T; 2], no: T) -> c_int {
    // SAFETY: as the caller promises.
    unsafe {
        for place in places {
            if let Some(place) = place.as_mut() {
                *place = no;
            }
        }
        with(instance, |_| Ok(()))
    }
}

/// Where there is no solution a shorter step of the simulator's integrator may help: it is asked to discard this one.
fn discarded(status: c_int) -> c_int {
    if status == ERROR { DISCARD } else { status }
}

/// # Safety
/// Null, or an array of so many values that lives during the call.
unsafe fn slice<'a, T>(pointer: *const T, count: usize) -> &'a [T] {
    if pointer.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: as the caller promises.
    unsafe { std::slice::from_raw_parts(pointer, count) }
}

/// # Safety
/// Null, or an array of so many values that lives during the call and nobody else uses.
unsafe fn slice_mut<'a, T>(pointer: *mut T, count: usize) -> &'a mut [T] {
    if pointer.is_null() || count == 0 {
        return &mut [];
    }
    // SAFETY: as the caller promises.
    unsafe { std::slice::from_raw_parts_mut(pointer, count) }
}

/// # Safety
/// Null, or a text ended by a zero.
unsafe fn text(pointer: *const c_char) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: as the caller promises.
    unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
}

/// A path from `file:///tmp/a%20b` or from a plain path.
fn path(location: &str) -> PathBuf {
    let Some(rest) = location.strip_prefix("file:") else { return location.into() };
    let rest = rest.strip_prefix("//localhost").or(rest.strip_prefix("//")).unwrap_or(rest);
    let mut bytes = Vec::new();
    let mut left = rest.as_bytes();
    while let Some((&first, after)) = left.split_first() {
        let code = after.get(..2).and_then(|h| u8::from_str_radix(std::str::from_utf8(h).ok()?, 16).ok());
        match code.filter(|_| first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                left = &after[2..];
            }
            None => {
                bytes.push(first);
                left = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned().into()
}

/// States of units, shared by both standards.
///
/// # Safety
/// As [`with`]; `place` points to a state of this library or to null.
unsafe fn get_state(instance: *mut c_void, place: *mut *mut c_void) -> c_int {
    // SAFETY: as the caller promises.
    unsafe {
        with(instance, |c| {
            let snapshot = c.unit.snapshot()?;
            let Some(place) = place.as_mut() else { return Err("there is no place for the state".to_owned()) };
            match place.cast::<FmuSnapshot>().as_mut() {
                Some(old) => *old = snapshot,
                None => *place = Box::into_raw(Box::new(snapshot)).cast(),
            }
            Ok(())
        })
    }
}

/// # Safety
/// As [`get_state`].
unsafe fn set_state(instance: *mut c_void, state: *mut c_void) -> c_int {
    // SAFETY: as the caller promises.
    unsafe {
        with(instance, |c| match state.cast::<FmuSnapshot>().as_ref() {
            Some(snapshot) => {
                c.terminated = false;
                c.unit.restore(snapshot)
            }
            None => Err("there is no such state".to_owned()),
        })
    }
}

/// # Safety
/// As [`get_state`].
unsafe fn free_state(place: *mut *mut c_void) -> c_int {
    // SAFETY: as the caller promises; the place is emptied, so that nothing is freed twice.
    unsafe {
        if let Some(place) = place.as_mut()
            && !place.is_null()
        {
            drop(Box::from_raw(place.cast::<FmuSnapshot>()));
            *place = std::ptr::null_mut();
        }
    }
    OK
}

/// # Safety
/// As [`get_state`].
unsafe fn state_size(instance: *mut c_void, state: *mut c_void, size: *mut usize) -> c_int {
    // SAFETY: as the caller promises.
    unsafe {
        with(instance, |_| match (state.cast::<FmuSnapshot>().as_ref(), size.as_mut()) {
            (Some(snapshot), Some(size)) => {
                *size = FmuInstance::bytes(snapshot).len();
                Ok(())
            }
            _ => Err("there is no such state".to_owned()),
        })
    }
}

/// # Safety
/// As [`get_state`]; the bytes are an array of so many.
unsafe fn write_state(instance: *mut c_void, state: *mut c_void, bytes: *mut u8, size: usize) -> c_int {
    // SAFETY: as the caller promises.
    unsafe {
        with(instance, |_| {
            let Some(snapshot) = state.cast::<FmuSnapshot>().as_ref() else { return Err("no such state".to_owned()) };
            let written = FmuInstance::bytes(snapshot);
            let place = slice_mut(bytes, size);
            let Some(place) = place.get_mut(..written.len()) else { return Err("too few bytes".to_owned()) };
            place.copy_from_slice(&written);
            Ok(())
        })
    }
}

/// # Safety
/// As [`write_state`].
unsafe fn read_state(instance: *mut c_void, bytes: *const u8, size: usize, place: *mut *mut c_void) -> c_int {
    // SAFETY: as the caller promises.
    unsafe {
        with(instance, |c| {
            let read = c.unit.read_bytes(slice(bytes, size));
            let snapshot = read.ok_or("these bytes are no state of this model")?;
            let Some(place) = place.as_mut() else { return Err("there is no place for the state".to_owned()) };
            *place = Box::into_raw(Box::new(snapshot)).cast();
            Ok(())
        })
    }
}

/// # Safety
/// As [`with`]; the instance is not used afterwards.
unsafe fn free(instance: *mut c_void) {
    if !instance.is_null() {
        // SAFETY: as the caller promises.
        drop(catch_unwind(AssertUnwindSafe(|| unsafe { drop(Box::from_raw(instance.cast::<FmuComponent>())) })));
    }
}

fn setup(c: &mut FmuComponent, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<(), String> {
    c.unit.setup(start, stop, tolerance);
    Ok(())
}

fn reset(c: &mut FmuComponent) -> Result<(), String> {
    c.unit.reset();
    c.terminated = false;
    Ok(())
}

/// Functions whose arguments and meaning are equal in both standards, under both names.
macro_rules! shared {
    ($($two:ident, $three:ident: ($($arg:ident: $kind:ty),*) $body:expr;)*) => {$(
        /// # Safety
        /// Called as the standard says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $two($($arg: $kind),*) -> c_int {
            // SAFETY: the simulator follows the standard.
            unsafe { $body }
        }
        /// # Safety
        /// Called as the standard says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $three($($arg: $kind),*) -> c_int {
            // SAFETY: the simulator follows the standard.
            unsafe { $body }
        }
    )*};
}

shared! {
    fmi2ExitInitializationMode, fmi3ExitInitializationMode: (c: *mut c_void) with(c, |c| c.unit.start());
    fmi2Terminate, fmi3Terminate: (c: *mut c_void) with(c, |_| Ok(()));
    fmi2EnterEventMode, fmi3EnterEventMode: (c: *mut c_void) with(c, |_| Ok(()));
    fmi2EnterContinuousTimeMode, fmi3EnterContinuousTimeMode: (c: *mut c_void) with(c, |_| Ok(()));
    fmi2SetTime, fmi3SetTime: (c: *mut c_void, time: f64) with(c, |c| {
        c.unit.exchange(|e| {
            e.set_time(time);
            Ok(())
        })
    });
    fmi2SetContinuousStates, fmi3SetContinuousStates: (c: *mut c_void, x: *const f64, n: usize) with(c, |c| {
        let x = slice(x, n);
        c.counted(x.len(), c.unit.states())?;
        c.unit.exchange(|e| {
            e.set_states(x);
            Ok(())
        })
    });
    fmi2GetContinuousStates, fmi3GetContinuousStates:
        (c: *mut c_void, x: *mut f64, n: usize) with(c, |c| c.states(slice_mut(x, n), |e| Ok(e.states())));
    fmi2GetNominalsOfContinuousStates, fmi3GetNominalsOfContinuousStates:
        (c: *mut c_void, x: *mut f64, n: usize) with(c, |c| c.states(slice_mut(x, n), |e| Ok(e.nominals())));
    fmi2GetDerivatives, fmi3GetContinuousStateDerivatives: (c: *mut c_void, x: *mut f64, n: usize)
        discarded(with(c, |c| c.states(slice_mut(x, n), |e| e.derivatives())));
    fmi2GetEventIndicators, fmi3GetEventIndicators: (c: *mut c_void, z: *mut f64, n: usize) discarded(with(c, |c| {
        let z = slice_mut(z, n);
        c.counted(z.len(), c.unit.indicators())?;
        c.unit.exchange(|e| e.indicators().map(|found| z.copy_from_slice(found)))
    }));
    fmi2Reset, fmi3Reset: (c: *mut c_void) with(c, reset);
    fmi2GetFMUstate, fmi3GetFMUState: (c: *mut c_void, state: *mut *mut c_void) get_state(c, state);
    fmi2SetFMUstate, fmi3SetFMUState: (c: *mut c_void, state: *mut c_void) set_state(c, state);
    fmi2FreeFMUstate, fmi3FreeFMUState: (_c: *mut c_void, state: *mut *mut c_void) free_state(state);
    fmi2SerializedFMUstateSize, fmi3SerializedFMUStateSize:
        (c: *mut c_void, state: *mut c_void, size: *mut usize) state_size(c, state, size);
    fmi2SerializeFMUstate, fmi3SerializeFMUState:
        (c: *mut c_void, state: *mut c_void, bytes: *mut u8, size: usize) write_state(c, state, bytes, size);
    fmi2DeSerializeFMUstate, fmi3DeserializeFMUState:
        (c: *mut c_void, bytes: *const u8, size: usize, state: *mut *mut c_void) read_state(c, bytes, size, state);
}

/// Functions that read or set the values of one type.
macro_rules! values_2 {
    ($($get:ident, $set:ident: $kind:ty, $of:expr, $to:expr;)*) => {$(
        /// # Safety
        /// Called as the standard says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(c: *mut c_void, vr: *const u32, n: usize, values: *mut $kind) -> c_int {
            // SAFETY: the simulator follows the standard.
            unsafe { with(c, |c| c.get(slice(vr, n), slice_mut(values, n), $of)) }
        }
        /// # Safety
        /// Called as the standard says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(c: *mut c_void, vr: *const u32, n: usize, values: *const $kind) -> c_int {
            // SAFETY: the simulator follows the standard.
            unsafe { with(c, |c| c.set(slice(vr, n), slice(values, n), $to)) }
        }
    )*};
}

/// The same of FMI 3, where arrays say their length.
macro_rules! values_3 {
    ($($get:ident, $set:ident: $kind:ty, $of:expr, $to:expr;)*) => {$(
        /// # Safety
        /// Called as the standard says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            c: *mut c_void, vr: *const u32, n: usize, values: *mut $kind, count: usize,
        ) -> c_int {
            // SAFETY: the simulator follows the standard.
            unsafe { with(c, |c| c.get(slice(vr, n), slice_mut(values, count), $of)) }
        }
        /// # Safety
        /// Called as the standard says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            c: *mut c_void, vr: *const u32, n: usize, values: *const $kind, count: usize,
        ) -> c_int {
            // SAFETY: the simulator follows the standard.
            unsafe { with(c, |c| c.set(slice(vr, n), slice(values, count), $to)) }
        }
    )*};
}

values_2! {
    fmi2GetReal, fmi2SetReal: f64, |v| v, |v| v;
    fmi2GetInteger, fmi2SetInteger: c_int, |v| v as c_int, f64::from;
    fmi2GetBoolean, fmi2SetBoolean: c_int, |v| c_int::from(v != 0.0), |v| f64::from(u8::from(v != 0));
}

values_3! {
    fmi3GetFloat64, fmi3SetFloat64: f64, |v| v, |v| v;
    fmi3GetInt32, fmi3SetInt32: i32, |v| v as i32, f64::from;
    fmi3GetInt64, fmi3SetInt64: i64, |v| v as i64, |v| v as f64;
    fmi3GetBoolean, fmi3SetBoolean: bool, |v| v != 0.0, |v| f64::from(u8::from(v));
}

// --- FMI 2 ---------------------------------------------------------------------------------------------------------

/// `fmi2CallbackFunctions`, of which the logger is used.
#[repr(C)]
pub struct Fmi2Callbacks {
    logger: Option<Fmi2Logger>,
    allocate: *const c_void,
    free: *const c_void,
    finished: *const c_void,
    environment: *mut c_void,
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    resources: *const c_char,
    functions: *const Fmi2Callbacks,
    _visible: c_int,
    _logging: c_int,
) -> *mut c_void {
    // SAFETY: the simulator follows the standard.
    let (name, guid, resources, functions) = unsafe { (text(name), text(guid), text(resources), functions.as_ref()) };
    let log = LoggerTarget::Two {
        logger: functions.and_then(|f| f.logger),
        environment: functions.map_or(std::ptr::null_mut(), |f| f.environment),
        name: CString::new(name).unwrap_or_default(),
    };
    let kind = if kind == 1 { FmuMode::CoSimulation } else { FmuMode::ModelExchange };
    FmuComponent::begin(log, path(&resources), &guid, kind)
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: *mut c_void) {
    // SAFETY: the simulator follows the standard.
    unsafe { free(c) }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: *mut c_void,
    _on: c_int,
    _n: usize,
    _categories: *const *const c_char,
) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe { with(c, |_| Ok(())) }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    c: *mut c_void,
    has_tolerance: c_int,
    tolerance: f64,
    start: f64,
    has_stop: c_int,
    stop: f64,
) -> c_int {
    let tolerance = (has_tolerance != 0).then_some(tolerance);
    // SAFETY: the simulator follows the standard.
    unsafe { with(c, |c| setup(c, tolerance, start, (has_stop != 0).then_some(stop))) }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(c: *mut c_void) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe { with(c, |_| Ok(())) }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(c: *mut c_void, time: f64, step: f64, _no_return: c_int) -> c_int {
    let mut terminated = false;
    // SAFETY: the simulator follows the standard.
    let status = unsafe {
        with(c, |c| {
            c.step(time, step)?;
            terminated = c.terminated;
            Ok(())
        })
    };
    if status == OK && terminated { DISCARD } else { status }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: *mut c_void, kind: c_int, value: *mut f64) -> c_int {
    // SAFETY: the simulator follows the standard; 2 is `fmi2LastSuccessfulTime`.
    unsafe {
        with(c, |c| match value.as_mut() {
            Some(value) if kind == 2 => {
                *value = c.unit.time();
                Ok(())
            }
            _ => Err("this status is not known".to_owned()),
        })
    }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(c: *mut c_void, kind: c_int, value: *mut c_int) -> c_int {
    // SAFETY: the simulator follows the standard; 3 is `fmi2Terminated`.
    unsafe {
        with(c, |c| match value.as_mut() {
            Some(value) if kind == 3 => {
                *value = c_int::from(c.terminated);
                Ok(())
            }
            _ => Err("this status is not known".to_owned()),
        })
    }
}

/// `fmi2EventInfo`
#[repr(C)]
pub struct Fmi2EventInfo {
    again: c_int,
    terminate: c_int,
    nominals: c_int,
    states: c_int,
    next_defined: c_int,
    next: f64,
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(c: *mut c_void, info: *mut Fmi2EventInfo) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe {
        with(c, |c| {
            let found = c.happen()?;
            let [again, terminate, nominals, states, next_defined] = found.flags().map(c_int::from);
            let next = found.next.unwrap_or_default();
            put(info, Fmi2EventInfo { again, terminate, nominals, states, next_defined, next })
        })
    }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    c: *mut c_void,
    _no_return: c_int,
    event: *mut c_int,
    terminate: *mut c_int,
) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe { step_completed(c, [event, terminate], 0) }
}

// --- FMI 3 ---------------------------------------------------------------------------------------------------------

#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    _count: usize,
    environment: *mut c_void,
    logger: Option<Fmi3Logger>,
    _update: *const c_void,
) -> *mut c_void {
    // SAFETY: the simulator follows the standard.
    let (token, resources) = unsafe { (text(token), text(resources)) };
    FmuComponent::begin(LoggerTarget::Three { logger, environment }, path(&resources), &token, FmuMode::CoSimulation)
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    environment: *mut c_void,
    logger: Option<Fmi3Logger>,
) -> *mut c_void {
    // SAFETY: the simulator follows the standard.
    let (token, resources) = unsafe { (text(token), text(resources)) };
    FmuComponent::begin(LoggerTarget::Three { logger, environment }, path(&resources), &token, FmuMode::ModelExchange)
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    c: *mut c_void,
    again: *mut bool,
    terminate: *mut bool,
    nominals: *mut bool,
    states: *mut bool,
    next_defined: *mut bool,
    next: *mut f64,
) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe {
        with(c, |c| {
            let found = c.happen()?;
            let flags = [again, terminate, nominals, states, next_defined];
            for (place, value) in flags.into_iter().zip(found.flags()) {
                if let Some(place) = place.as_mut() {
                    *place = value;
                }
            }
            if let (Some(place), Some(time)) = (next.as_mut(), found.next) {
                *place = time;
            }
            Ok(())
        })
    }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    c: *mut c_void,
    _no_return: bool,
    event: *mut bool,
    terminate: *mut bool,
) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe { step_completed(c, [event, terminate], false) }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfEventIndicators(c: *mut c_void, count: *mut usize) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe { with(c, |c| put(count, c.unit.indicators())) }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfContinuousStates(c: *mut c_void, count: *mut usize) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe { with(c, |c| put(count, c.unit.states())) }
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateScheduledExecution() -> *mut c_void {
    std::ptr::null_mut()
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(c: *mut c_void) {
    // SAFETY: the simulator follows the standard.
    unsafe { free(c) }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    c: *mut c_void,
    _on: bool,
    _n: usize,
    _categories: *const *const c_char,
) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe { with(c, |_| Ok(())) }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    c: *mut c_void,
    has_tolerance: bool,
    tolerance: f64,
    start: f64,
    has_stop: bool,
    stop: f64,
) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe { with(c, |c| setup(c, has_tolerance.then_some(tolerance), start, has_stop.then_some(stop))) }
}

/// # Safety
/// Called as the standard says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    c: *mut c_void,
    time: f64,
    step: f64,
    _no_return: bool,
    event: *mut bool,
    terminate: *mut bool,
    early: *mut bool,
    last: *mut f64,
) -> c_int {
    // SAFETY: the simulator follows the standard.
    unsafe {
        with(c, |c| {
            let stepped = c.step(time, step);
            for (place, value) in [(event, false), (terminate, c.terminated), (early, false)] {
                if let Some(place) = place.as_mut() {
                    *place = value;
                }
            }
            if let Some(last) = last.as_mut() {
                *last = c.unit.time();
            }
            stepped
        })
    }
}

/// Functions of the standard that these units do not have: whoever calls them gets an error.
macro_rules! refused {
    ($($name:ident)*) => {$(
        #[unsafe(no_mangle)]
        pub extern "C" fn $name() -> c_int {
            ERROR
        }
    )*};
}

refused! {
    fmi2GetString fmi2SetString fmi2GetDirectionalDerivative fmi2SetRealInputDerivatives fmi2GetRealOutputDerivatives
    fmi2CancelStep fmi2GetStatus fmi2GetIntegerStatus fmi2GetStringStatus
    fmi3GetFloat32 fmi3SetFloat32 fmi3GetInt8 fmi3SetInt8 fmi3GetUInt8 fmi3SetUInt8 fmi3GetInt16 fmi3SetInt16
    fmi3GetUInt16 fmi3SetUInt16 fmi3GetUInt32 fmi3SetUInt32 fmi3GetUInt64 fmi3SetUInt64 fmi3GetString fmi3SetString
    fmi3GetBinary fmi3SetBinary fmi3GetClock fmi3SetClock fmi3GetNumberOfVariableDependencies
    fmi3GetVariableDependencies fmi3GetDirectionalDerivative fmi3GetAdjointDerivative fmi3EnterConfigurationMode
    fmi3ExitConfigurationMode fmi3GetIntervalDecimal fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction
    fmi3SetIntervalDecimal fmi3SetIntervalFraction fmi3SetShiftDecimal fmi3SetShiftFraction fmi3EvaluateDiscreteStates
    fmi3EnterStepMode fmi3GetOutputDerivatives fmi3ActivateModelPartition
}
