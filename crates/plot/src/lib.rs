//! Trajectories drawn: SVG and PNG pictures, and a page with zoom and hover.
//!
//! [`select::figure`] chooses what is drawn, [`svg::write`], [`png::write`] and [`html::write`] draw it.

pub mod decimate;
pub mod figure;
pub mod html;
pub mod map;
pub mod matrix;
pub mod network;
#[cfg(feature = "png")]
pub mod png;
pub mod sankey;
pub mod select;
pub mod svg;
mod ticks;

pub use figure::{Figure, FigurePanel, PlotBand, PlotSeries};
