//! The compiled core of the Python package `bramah`: models, runs, steppers, studies.
//!
//! The classes that users see are in `bramah/*.py` and hold objects of this module. Values pass as tuples, lists,
//! dictionaries and NumPy arrays.
//! Only this module releases the interpreter's lock (GIL). During long work it takes the lock again now and then, to
//! ask
//! whether the user pressed Ctrl-C.

mod errors;
mod model;
mod run;
mod stepper;
mod study;
mod threads;

use pyo3::prelude::*;

#[pymodule]
fn _bramah(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<model::Core>()?;
    module.add_class::<run::Run>()?;
    module.add_class::<run::Saved>()?;
    module.add_class::<stepper::Core>()?;
    module.add_function(wrap_pyfunction!(study::identify, module)?)?;
    module.add_function(wrap_pyfunction!(study::diagnose, module)?)
}
