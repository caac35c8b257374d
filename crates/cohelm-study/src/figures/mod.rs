//! Figures one can put into a talk, as SVG and PNG, with their data as CSV.
//!
//! Every figure is built from plain data by [`ByParticipant`], [`BoxPlot`], [`PairedSlopes`], [`Curves`], [`Flow`],
//! [`Reliability`] or [`ParetoScatter`], takes its colours from one [`Conditions`] for the whole study, and gives the same bytes on every
//! machine. It is drawn once, as a scene of lines, areas and texts, which is written as SVG and painted as PNG; the type is
//! embedded. (A chart library was weighed: what these figures need beyond rectangles and lines, measured text above all,
//! it leaves to its caller, and its box plots draw whiskers to fences where no data are.)

mod axis;
mod box_plot;
mod by_participant;
mod curves;
mod flow;
mod font;
mod frame;
mod palette;
mod pareto;
mod png;
mod reliability;
mod scene;
mod slopes;
mod svg;

pub use axis::{Axis, Extent};
pub use box_plot::BoxPlot;
pub use by_participant::{ByParticipant, Panel};
pub use curves::{Curve, CurvePanel, Curves};
pub use flow::{Flow, Stage};
pub use frame::Heading;
pub use palette::{Colour, Condition, Conditions, Marker};
pub use pareto::{Behind, Better, ParetoPoint, ParetoScatter};
pub use reliability::{Bin, Reliability};
pub use slopes::PairedSlopes;
pub(crate) use svg::{escaped, font_faces};

use crate::csv::Csv;
use scene::Scene;

/// A finished figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    scene: Scene,
    description: String,
    data: Csv,
}

/// Why data make no figure.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FigureError {
    /// There is nothing to draw.
    #[error("the figure has no {of} to show")]
    Nothing {
        /// What is missing, in the plural.
        of: &'static str,
    },
    /// An axis has no single value.
    #[error("the axis {axis:?} has no value to show")]
    NoValues {
        /// Title of the axis.
        axis: String,
    },
    /// A value is NaN or infinite.
    #[error("the axis {axis:?} has a value that is not a finite number; leave missing values out")]
    NotFinite {
        /// Title of the axis.
        axis: String,
    },
    /// Lists that belong together differ in length.
    #[error("the figure has {found} {of}, but {expected} were expected")]
    Length {
        /// What was counted, in the plural.
        of: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
}

impl Figure {
    /// The figure as an SVG file, type embedded.
    pub fn svg(&self) -> String {
        svg::write(&self.scene, &self.description, &font_faces())
    }

    /// The figure as SVG for a document that brings the type along, as [`crate::report`] does.
    pub(crate) fn inline_svg(&self) -> String {
        svg::write(&self.scene, &self.description, "")
    }

    /// The figure as a PNG file with `scale` pixels a point: 2 for a slide, 4 for print.
    pub fn png(&self, scale: f64) -> Vec<u8> {
        png::write(&self.scene, scale)
    }

    /// The numbers behind the figure.
    pub fn csv(&self) -> &Csv {
        &self.data
    }

    /// The figure in words, for those who cannot see it.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// Width and height in points.
    pub fn size(&self) -> (f64, f64) {
        (self.scene.width, self.scene.height)
    }
}

fn require_length(of: &'static str, expected: usize, found: usize) -> Result<(), FigureError> {
    if expected == found { Ok(()) } else { Err(FigureError::Length { of, expected, found }) }
}

fn require_some(of: &'static str, count: usize) -> Result<(), FigureError> {
    if count > 0 { Ok(()) } else { Err(FigureError::Nothing { of }) }
}
