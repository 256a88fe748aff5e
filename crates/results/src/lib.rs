//! Trajectories, which a run or a test bench has recorded: the type, file formats, and comparison.
//!
//! Rows of a run and bytes of files enter; files and [`Trajectory`] values leave. The crates `circuit`, `analysis`,
//! `plot`
//! and `gap` and the command use it. It reads no files itself.

mod cells;
pub mod compare;
mod csv;
mod delay;
pub mod formats;
pub mod glob;
pub mod mat;
pub mod number;
pub mod parquet;
pub mod recording;
mod said_units;
pub mod table;
mod texts;
pub mod trajectory;
mod tube;

pub use compare::{TrajectoryComparison, TubeTolerance, compare};
pub use csv::{CsvUnits, CsvWriter, csv_bytes_per_row};
pub use glob::GlobPatterns;
pub use recording::{ReadStrictness, read_csv};
pub use said_units::contradiction;
pub use trajectory::{Kind, Signal, Trajectory};
