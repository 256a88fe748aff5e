//! Draws trajectories, networks, maps and power flows as SVG; from that, PNG pictures and HTML pages.
//!
//! [`select::figure`] chooses which signals of trajectories are drawn and returns a [`Figure`]. [`svg::write`] and
//! [`html::write`] draw it; `png::write` turns any SVG into pixels. `network`, `map`, `matrix` and `sankey` draw from
//! data of their own.
//!
//! All lengths are in SVG units, which are pixels at the usual size. Equal data give equal bytes.

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
