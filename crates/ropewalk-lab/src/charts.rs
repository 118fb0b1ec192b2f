//! What the plots of the experiments share: a sheet with a chart for each scene, as SVG, and the box that names its series.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use thiserror::Error;

/// Why there is no plot.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("the plot cannot be drawn: {0}")]
pub struct PlotError(String);

/// The place of a chart.
pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A chart of two axes of numbers.
pub(crate) type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Whatever went wrong in drawing.
pub(crate) fn failed(error: impl std::fmt::Display) -> PlotError {
    PlotError(error.to_string())
}

/// A chart of so many pixels for each run of rows of one scene, two beside each other.
pub(crate) fn sheet<R>(
    rows: &[R],
    scene: impl Fn(&R) -> &str,
    chart_size: (u32, u32),
    draw: impl Fn(&Area<'_>, &[R]) -> Result<(), PlotError>,
) -> Result<String, PlotError> {
    let scenes: Vec<&[R]> = rows.chunk_by(|a, b| scene(a) == scene(b)).collect();
    if scenes.is_empty() {
        return Err(failed("there are no rows"));
    }
    let columns = scenes.len().min(2);
    let lines = scenes.len().div_ceil(columns);
    let size = (chart_size.0 * columns as u32, chart_size.1 * lines as u32);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        for (area, rows) in root.split_evenly((lines, columns)).iter().zip(&scenes) {
            draw(area, rows)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

/// Names the series of a chart, in its upper right corner.
pub(crate) fn name_series<'a, 'b: 'a>(chart: &mut Chart<'a, 'b>) -> Result<(), PlotError> {
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .label_font(("sans-serif", 10))
        .background_style(WHITE.mix(0.85))
        .draw()
        .map_err(failed)
}
