//! Functions of foreign C code, carried out in Rust.
//! Names of C functions enter; functions that equations can call leave ([`builtin`]). The crate `model` asks for them
//! where a Modelica function is declared `external "C"`.
//!
//! They cover tables, texts, random numbers, FFT and LAPACK of the Modelica Standard Library, units of other tools
//! (`mockup`) and C code of a user (`c`). A function is pure: equal arguments give equal results.

#[cfg(feature = "fmi")]
pub mod c;
mod curve;
mod fourier;
mod linear;
#[cfg(feature = "fmi")]
pub mod mockup;
mod options;
mod random;
mod strings;
mod surface;
mod time_table;

use bramah_expr::function::ExternalFunction;
use curve::TableCurve;
use options::{Extrapolation, Smoothness, TimeEvents};
use random::{RandomDraw, RandomGenerator};
use std::sync::Arc;
use surface::TableSurface;
use time_table::TimeTable;

/// A value passed to such a function, or given by it.
#[derive(Clone, Debug)]
pub enum ExternalValue {
    /// A text, always known before the run.
    Text(String),
    /// A number, Boolean value or enumeration literal, or an array of these row by row. Booleans are 0 and 1.
    Numbers {
        /// The size of each dimension. Empty for a scalar.
        dims: Vec<usize>,
        /// The elements. `None` for one that is not known before the run.
        values: Vec<Option<f64>>,
    },
    /// An external object (Modelica 3.6, section 12.9.7).
    Object(ExternalObject),
}

/// The content of an external object, which its constructor made.
#[derive(Clone, Debug)]
pub enum ExternalObject {
    /// `CombiTable1D`: one curve for each chosen column, over one argument.
    Curves(Arc<Vec<TableCurve>>),
    /// `CombiTimeTable`: columns over time.
    Times(Arc<TimeTable>),
    /// `CombiTable2D`: a surface over two arguments.
    Surface(Arc<TableSurface>),
    /// A unit of another tool, with its instances.
    #[cfg(feature = "fmi")]
    MockUp(Arc<mockup::InstancePool>),
}

impl ExternalObject {
    /// The address of the content. It is the same for copies of one object, by which equal calls are recognised.
    pub fn address(&self) -> usize {
        match self {
            ExternalObject::Curves(table) => Arc::as_ptr(table).addr(),
            ExternalObject::Times(table) => Arc::as_ptr(table).addr(),
            ExternalObject::Surface(table) => Arc::as_ptr(table).addr(),
            #[cfg(feature = "fmi")]
            ExternalObject::MockUp(pool) => Arc::as_ptr(pool).addr(),
        }
    }
}

/// How a C function is carried out.
#[derive(Clone, Copy)]
pub enum BuiltinImplementation {
    /// The constructor of an object, from values known before the run. The first arguments are the name of a file, the
    /// name
    /// of a table in it, and the table itself if there is no file. The error ends a sentence about the table.
    Object(fn(&[ExternalValue]) -> Result<ExternalObject, String>),
    /// A function of all numbers that are not part of an object, in order.
    /// Its outputs are the return value, then the output arguments.
    Function(fn(&[ExternalValue]) -> Option<Arc<dyn ExternalFunction>>),
    /// An evaluation at compile time: the return value, then the output arguments. `None` if an argument is not known.
    Values(fn(&[ExternalValue]) -> Option<Vec<ExternalValue>>),
    /// The constructor of a unit of another tool, from its file, kind and texts.
    MockUp,
    /// A function without an effect that a model could see, such as printing.
    Nothing,
}

/// The name by which the Modelica Standard Library says that there is no file or table.
pub const NO_NAME: &str = "NoName";

/// The implementation of a C function by its name. `None` if it is not one of those in Rust.
pub fn builtin(name: &str) -> Option<BuiltinImplementation> {
    use BuiltinImplementation::{Function, MockUp, Nothing, Object, Values};
    Some(match name {
        "bramah_mockup" => MockUp,
        "bramah_mockup_free" => Nothing,
        #[cfg(feature = "fmi")]
        "bramah_mockup_begin" => Function(|g| of_mockup(g, mockup::FmuOperation::Begin)),
        #[cfg(feature = "fmi")]
        "bramah_mockup_start" => Function(|g| of_mockup(g, mockup::FmuOperation::Start)),
        #[cfg(feature = "fmi")]
        "bramah_mockup_advance" => Function(|g| of_mockup(g, mockup::FmuOperation::Advance)),
        #[cfg(feature = "fmi")]
        "bramah_mockup_evaluate" => Function(|g| of_mockup(g, mockup::FmuOperation::Evaluate)),
        #[cfg(feature = "fmi")]
        "bramah_mockup_event" => Function(|g| of_mockup(g, mockup::FmuOperation::Event)),
        "ModelicaStandardTables_CombiTable1D_init2" | "ModelicaStandardTables_CombiTable1D_init3" => Object(curves),
        "ModelicaStandardTables_CombiTimeTable_init2" | "ModelicaStandardTables_CombiTimeTable_init3" => Object(times),
        "ModelicaStandardTables_CombiTable2D_init2" | "ModelicaStandardTables_CombiTable2D_init3" => Object(map),
        "ModelicaStandardTables_CombiTable1D_getValue" => Function(|g| {
            curves_of(g).map(|table| Arc::new(CurveLookup { table, order: 0 }) as Arc<dyn ExternalFunction>)
        }),
        "ModelicaStandardTables_CombiTimeTable_getValue" => Function(|g| {
            times_of(g).map(|table| Arc::new(TimeTableLookup { table, order: 0 }) as Arc<dyn ExternalFunction>)
        }),
        "ModelicaStandardTables_CombiTimeTable_nextTimeEvent" => {
            Function(|g| times_of(g).map(|table| Arc::new(NextTableEvent(table)) as Arc<dyn ExternalFunction>))
        }
        "ModelicaStandardTables_CombiTable2D_getValue" => Function(|g| {
            map_of(g).map(|table| Arc::new(SurfaceLookup { table, orders: [0, 0] }) as Arc<dyn ExternalFunction>)
        }),
        "ModelicaStandardTables_CombiTable1D_minimumAbscissa" => Values(|g| one(curves_of(g)?[0].from())),
        "ModelicaStandardTables_CombiTable1D_maximumAbscissa" => Values(|g| one(curves_of(g)?[0].to())),
        "ModelicaStandardTables_CombiTimeTable_minimumTime" => Values(|g| one(times_of(g)?.curves[0].from())),
        "ModelicaStandardTables_CombiTimeTable_maximumTime" => Values(|g| one(times_of(g)?.curves[0].to())),
        "ModelicaStandardTables_CombiTable2D_minimumAbscissa" => Values(|g| row(&map_of(g)?.range()[0])),
        "ModelicaStandardTables_CombiTable2D_maximumAbscissa" => Values(|g| row(&map_of(g)?.range()[1])),
        "ModelicaRandom_xorshift64star" => Function(|_| Some(Arc::new(RandomDraw(RandomGenerator::Star64)))),
        "ModelicaRandom_xorshift128plus" => Function(|_| Some(Arc::new(RandomDraw(RandomGenerator::Plus128)))),
        "ModelicaRandom_xorshift1024star" => Function(|_| Some(Arc::new(RandomDraw(RandomGenerator::Star1024)))),
        "ModelicaRandom_setInternalState_xorshift1024star" | "ModelicaInternal_print" => Nothing,
        "ModelicaFFT_kiss_fftr" => Function(|_| Some(Arc::new(fourier::Spectrum::default()))),
        "dgesv" => Function(|_| Some(Arc::new(linear::LinearSolve::default()))),
        "dgelsy" => Values(linear::least_squares),
        "ModelicaStrings_length" => Values(|g| one(text(g, 0)?.len() as f64)),
        "ModelicaStrings_substring" => {
            Values(|g| Some(vec![ExternalValue::Text(strings::substring(text(g, 0)?, number(g, 1)?, number(g, 2)?))]))
        }
        "ModelicaStrings_compare" => Values(|g| one(strings::compare(text(g, 0)?, text(g, 1)?, number(g, 2)? != 0.0))),
        "ModelicaStrings_skipWhiteSpace" => Values(|g| one(strings::skip_white_space(text(g, 0)?, number(g, 1)?))),
        "ModelicaStrings_scanIdentifier" => Values(|g| scanned(g, strings::identifier)),
        "ModelicaStrings_scanString" => Values(|g| scanned(g, strings::quoted)),
        "ModelicaStrings_scanInteger" => Values(|g| {
            let unsigned = number(g, 2)? != 0.0;
            scanned_number(g, |t| strings::integer(t, unsigned))
        }),
        "ModelicaStrings_scanReal" => Values(|g| {
            let unsigned = number(g, 2)? != 0.0;
            scanned_number(g, |t| strings::real(t, unsigned))
        }),
        "ModelicaStrings_hashString" => Values(|g| one(strings::hash(text(g, 0)?))),
        _ => return None,
    })
}

/// A single known number as result.
/// Functions at compile time return lists of values.
fn one(x: f64) -> Option<Vec<ExternalValue>> {
    Some(vec![ExternalValue::Numbers { dims: Vec::new(), values: vec![Some(x)] }])
}

/// A list of known numbers as result.
fn row(x: &[f64]) -> Option<Vec<ExternalValue>> {
    Some(vec![ExternalValue::Numbers { dims: vec![x.len()], values: x.iter().copied().map(Some).collect() }])
}

/// Argument `k`, if it is a text.
/// `None` for another kind of argument.
fn text(given: &[ExternalValue], k: usize) -> Option<&str> {
    match given.get(k)? {
        ExternalValue::Text(text) => Some(text),
        _ => None,
    }
}

/// Argument `k`, if it is a known number. Of an array the first element.
/// `None` if it is not known before the run.
fn number(given: &[ExternalValue], k: usize) -> Option<f64> {
    match given.get(k)? {
        ExternalValue::Numbers { values, .. } => *values.first()?,
        _ => None,
    }
}

/// The results of a scanning function for texts: the position behind the token, and the token or an empty text.
/// The arguments are the text and the position at which to begin.
fn scanned(given: &[ExternalValue], token: impl Fn(&str) -> Option<(usize, String)>) -> Option<Vec<ExternalValue>> {
    let (next, found) = strings::scan(text(given, 0)?, number(given, 1)?, token);
    Some(vec![one(next)?.remove(0), ExternalValue::Text(found.unwrap_or_default())])
}

/// The same for numbers: the position behind the token, and its value or 0.
fn scanned_number(given: &[ExternalValue], token: impl Fn(&str) -> Option<(usize, f64)>) -> Option<Vec<ExternalValue>> {
    let (next, found) = strings::scan(text(given, 0)?, number(given, 1)?, token);
    Some(vec![one(next)?.remove(0), one(found.unwrap_or(0.0))?.remove(0)])
}

/// The curves of the object in the first argument.
/// `None` if the argument is another object.
fn curves_of(given: &[ExternalValue]) -> Option<Arc<Vec<TableCurve>>> {
    match given.first()? {
        ExternalValue::Object(ExternalObject::Curves(table)) => Some(table.clone()),
        _ => None,
    }
}

/// The time table of the object in the first argument.
/// `None` if the argument is another object.
fn times_of(given: &[ExternalValue]) -> Option<Arc<TimeTable>> {
    match given.first()? {
        ExternalValue::Object(ExternalObject::Times(table)) => Some(table.clone()),
        _ => None,
    }
}

/// The surface of the object in the first argument.
/// `None` if the argument is another object.
fn map_of(given: &[ExternalValue]) -> Option<Arc<TableSurface>> {
    match given.first()? {
        ExternalValue::Object(ExternalObject::Surface(table)) => Some(table.clone()),
        _ => None,
    }
}

/// A function of the unit in the first argument.
/// `None` if the argument is another object.
#[cfg(feature = "fmi")]
fn of_mockup(given: &[ExternalValue], task: mockup::FmuOperation) -> Option<Arc<dyn ExternalFunction>> {
    match given.first()? {
        ExternalValue::Object(ExternalObject::MockUp(pool)) => {
            Some(Arc::new(mockup::FmuFunction::new(pool.clone(), task)))
        }
        _ => None,
    }
}

/// A table that was passed as a matrix, by columns of equal length.
struct TableColumns(Vec<Vec<f64>>);

impl TableColumns {
    /// The table in the third argument.
    ///
    /// # Errors
    /// There is no matrix with at least one row and two columns, or its elements are not known before the run.
    fn of(given: &[ExternalValue]) -> Result<Self, String> {
        let Some(ExternalValue::Numbers { dims, values }) = given.get(2) else { return Err("it has no table".into()) };
        let &[rows, columns] = dims.as_slice() else { return Err("its table is no matrix".into()) };
        let known: Option<Vec<f64>> = values.iter().copied().collect();
        let known = known.ok_or("its table is not known before the run")?;
        if rows == 0 || columns < 2 {
            return Err(format!(
                "its table has {rows} rows and {columns} columns, and at least one row and two columns are needed"
            ));
        }
        Ok(TableColumns((0..columns).map(|j| (0..rows).map(|i| known[i * columns + j]).collect()).collect()))
    }

    /// The columns whose numbers, counted from 1, are in argument `k`.
    ///
    /// # Errors
    /// A number is not known, or there is no such column.
    fn chosen(&self, given: &[ExternalValue], k: usize) -> Result<Vec<Vec<f64>>, String> {
        let Some(ExternalValue::Numbers { values, .. }) = given.get(k) else { return Err("it says no columns".into()) };
        let chosen = values.iter().map(|x| {
            // Number 0 wraps to an index that no table has.
            let at = x.ok_or("its columns are not known before the run")? as usize;
            let column = self.0.get(at.wrapping_sub(1));
            column.cloned().ok_or(format!("its table has {} columns and no column {at}", self.0.len()))
        });
        chosen.collect()
    }
}

/// Checks that abscissae do not decrease, or with `strictly` that they increase.
///
/// # Errors
/// The first pair of abscissae that is out of order.
fn grows(x: &[f64], strictly: bool) -> Result<(), String> {
    let wrong = |w: &[f64]| w[1] < w[0] || strictly && w[1] == w[0];
    match x.windows(2).find(|w| wrong(w)) {
        Some(w) => Err(format!("its abscissae do not increase: {} follows {}", w[1], w[0])),
        None => Ok(()),
    }
}

/// Argument `k` read by `of`; `what` names it in the error.
///
/// # Errors
/// The argument is not known before the run, or is no literal of the enumeration.
fn option<T>(given: &[ExternalValue], k: usize, of: fn(f64) -> Option<T>, what: &str) -> Result<T, String> {
    number(given, k).and_then(of).ok_or(format!("its {what} is not known"))
}

/// The constructor of `CombiTable1D`. Arguments: file, table name, table, then options by the numbers used here.
/// Columns other than the first are values.
fn curves(given: &[ExternalValue]) -> Result<ExternalObject, String> {
    let columns = TableColumns::of(given)?;
    let smoothness = option(given, 7, Smoothness::from_number, "smoothness")?;
    // The older function `init2` has no argument for extrapolation.
    let extrapolation = option(given, 8, Extrapolation::from_number, "extrapolation").unwrap_or(Extrapolation::Slope);
    // Jumps are not allowed here: without events their side would be undefined.
    grows(&columns.0[0], true)?;
    let curve = |y: &Vec<f64>| TableCurve::new(&columns.0[0], y, smoothness, extrapolation);
    Ok(ExternalObject::Curves(Arc::new(columns.chosen(given, 5)?.iter().map(curve).collect())))
}

/// The constructor of `CombiTimeTable`.
/// Arguments that C needs as sizes of arrays are skipped.
fn times(given: &[ExternalValue]) -> Result<ExternalObject, String> {
    let columns = TableColumns::of(given)?;
    let options = (
        option(given, 8, Smoothness::from_number, "smoothness")?,
        option(given, 9, Extrapolation::from_number, "extrapolation")?,
        option(given, 11, TimeEvents::from_number, "kind of time events").unwrap_or(TimeEvents::Always),
    );
    let (start, shift) = (option(given, 5, Some, "start time")?, option(given, 10, Some, "shift of time")?);
    // Two rows with equal times are a jump.
    grows(&columns.0[0], false)?;
    Ok(ExternalObject::Times(Arc::new(TimeTable::new(
        &columns.0[0],
        &columns.chosen(given, 6)?,
        options,
        (start, shift),
    ))))
}

/// The constructor of `CombiTable2D`: the first column and the first row of the table are the axes.
/// Values are at the crossings of both.
fn map(given: &[ExternalValue]) -> Result<ExternalObject, String> {
    let columns = TableColumns::of(given)?;
    if columns.0[0].len() < 2 {
        return Err("its table has one row, and at least two are needed".into());
    }
    let smoothness = option(given, 5, Smoothness::from_number, "smoothness")?;
    let extrapolation = option(given, 6, Extrapolation::from_number, "extrapolation").unwrap_or(Extrapolation::Slope);
    let first = columns.0[0][1..].to_vec();
    let second: Vec<f64> = columns.0[1..].iter().map(|c| c[0]).collect();
    grows(&first, true)?;
    grows(&second, true)?;
    let values: Vec<f64> = (1..=first.len()).flat_map(|i| columns.0[1..].iter().map(move |c| c[i])).collect();
    Ok(ExternalObject::Surface(Arc::new(TableSurface::new([first, second], &values, smoothness, extrapolation))))
}

/// `CombiTable1D_getValue`: arguments are the number of a column from 1, and the abscissa.
#[derive(Debug)]
struct CurveLookup {
    /// The curves, one for each column.
    table: Arc<Vec<TableCurve>>,
    /// The order of the derivative by the abscissa.
    order: usize,
}

impl ExternalFunction for CurveLookup {
    fn value(&self, _: usize, args: &[f64]) -> f64 {
        let curve = self.table.get((args[0] as usize).wrapping_sub(1));
        curve.map_or(f64::NAN, |c| c.value(args[1], self.order, false))
    }

    fn partial(&self, input: usize) -> Option<Arc<dyn ExternalFunction>> {
        (input == 1).then(|| {
            Arc::new(CurveLookup { table: self.table.clone(), order: self.order + 1 }) as Arc<dyn ExternalFunction>
        })
    }
}

/// `CombiTimeTable_getValue`: arguments are the number of a column from 1, time, the next event, and that before the
/// event.
#[derive(Debug)]
struct TimeTableLookup {
    /// The columns.
    table: Arc<TimeTable>,
    /// The order of the derivative by time.
    order: usize,
}

impl ExternalFunction for TimeTableLookup {
    fn value(&self, _: usize, args: &[f64]) -> f64 {
        let column = (args[0] as usize).wrapping_sub(1);
        if column >= self.table.curves.len() {
            return f64::NAN;
        }
        self.table.value(column, [args[1], args[2], args[3]], self.order)
    }

    fn partial(&self, input: usize) -> Option<Arc<dyn ExternalFunction>> {
        (input == 1).then(|| {
            Arc::new(TimeTableLookup { table: self.table.clone(), order: self.order + 1 }) as Arc<dyn ExternalFunction>
        })
    }
}

/// `CombiTimeTable_nextTimeEvent`: the argument is time (s).
#[derive(Debug)]
struct NextTableEvent(Arc<TimeTable>);

impl ExternalFunction for NextTableEvent {
    fn value(&self, _: usize, args: &[f64]) -> f64 {
        self.0.next_event(args[0])
    }

    // The event time is constant between events.
    fn partial(&self, _: usize) -> Option<Arc<dyn ExternalFunction>> {
        None
    }
}

/// `CombiTable2D_getValue`: the arguments are the abscissae of both axes.
#[derive(Debug)]
struct SurfaceLookup {
    /// The surface.
    table: Arc<TableSurface>,
    /// The orders of the derivative by each argument.
    orders: [usize; 2],
}

impl ExternalFunction for SurfaceLookup {
    fn value(&self, _: usize, args: &[f64]) -> f64 {
        self.table.value([args[0], args[1]], self.orders)
    }

    fn partial(&self, input: usize) -> Option<Arc<dyn ExternalFunction>> {
        let mut orders = self.orders;
        orders[input] += 1;
        Some(Arc::new(SurfaceLookup { table: self.table.clone(), orders }))
    }
}
