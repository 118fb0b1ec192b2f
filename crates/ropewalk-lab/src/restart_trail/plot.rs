//! The ratios over the size of the short stack, one chart a scene, as SVG.

use super::bands::{Band, PUBLISHED, WANTED};
use super::record::TrailRow;
use crate::charts::{Area, PlotError, failed, name_series, sheet};
use plotters::prelude::*;

/// Pixels of a chart.
const CHART: (u32, u32) = (640, 420);
/// How far a chart reaches at least: as far as the bands.
const LEAST_HEIGHT: f64 = 3.4;
const LOWEST: f64 = 0.95;

/// A chart for each scene: a line a tree and class of rays, the wanted bands light and the paper's dark behind them.
/// Only rows of the first device of a scene are drawn: counts are the same on all.
///
/// # Errors
/// When there is nothing to draw.
pub fn plot(rows: &[TrailRow]) -> Result<String, PlotError> {
    sheet(rows, |row| &row.scene, CHART, chart)
}

fn chart(area: &Area<'_>, rows: &[TrailRow]) -> Result<(), PlotError> {
    let Some(first) = rows.first() else { return Ok(()) };
    let rows: Vec<&TrailRow> = rows.iter().filter(|row| row.device == first.device).collect();
    let size = |row: &TrailRow| row.short_stack.entries().map(f64::from);
    let largest = rows.iter().filter_map(|row| size(row)).fold(1.0, f64::max);
    let highest = rows.iter().map(|row| 1.03 * row.ratio_inner).fold(LEAST_HEIGHT, f64::max);
    let mut chart = ChartBuilder::on(area)
        .caption(format!("{}: inner visits over the full stack's", first.scene), ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(36)
        .y_label_area_size(46)
        .build_cartesian_2d(-0.3..largest + 0.3, LOWEST..highest)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .x_desc("entries of the short stack")
        .y_desc("ratio")
        .x_labels(largest as usize + 1)
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| format!("{y:.1}"))
        .light_line_style(WHITE)
        .draw()
        .map_err(failed)?;
    for (bands, shade) in [(&WANTED[..], RGBColor(225, 230, 238)), (&PUBLISHED[..], RGBColor(170, 185, 205))]
    {
        let boxes = bands.iter().map(|band| bar(band, shade));
        chart.draw_series(boxes).map_err(failed)?;
    }
    let comparisons =
        rows.chunk_by(|a, b| (a.builder, a.max_leaf, a.rays) == (b.builder, b.max_leaf, b.rays));
    for comparison in comparisons {
        let points: Vec<(f64, f64)> =
            comparison.iter().filter_map(|row| Some((size(row)?, row.ratio_inner))).collect();
        let Some(head) = comparison.first() else { continue };
        let style = style(head);
        chart.draw_series(LineSeries::new(points.clone(), style)).map_err(failed)?;
        chart
            .draw_series(points.iter().map(|&point| Circle::new(point, 2, style.filled())))
            .map_err(failed)?
            .label(format!("{} {}, {}", head.builder, head.max_leaf, head.rays))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], style));
    }
    name_series(&mut chart)
}

/// A band as a bar around its size.
fn bar(band: &Band, shade: RGBColor) -> Rectangle<(f64, f64)> {
    let size = f64::from(band.short_stack);
    // The bands that are one value would be no line.
    let high = band.high.max(band.low + 0.01);
    Rectangle::new([(size - 0.25, band.low), (size + 0.25, high)], shade.filled())
}

/// A colour a class of rays, dark for SAH trees and light for SBVH trees, thin for small leaves.
fn style(row: &TrailRow) -> ShapeStyle {
    let (red, green, blue) = match row.rays {
        "primary" => (27, 94, 160),
        "ambient-occlusion" => (40, 130, 70),
        "diffuse" => (190, 80, 30),
        "shadow" => (120, 60, 140),
        _ => (80, 80, 80),
    };
    let light = |channel: u8| if row.builder == "sbvh" { channel / 2 + 112 } else { channel };
    let width = match row.max_leaf {
        1 => 1,
        2..=4 => 2,
        _ => 3,
    };
    RGBColor(light(red), light(green), light(blue)).stroke_width(width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::ShortStack;
    use crate::restart_trail::record::tests::row;

    #[test]
    fn a_plot_names_what_it_shows() {
        let mut other = row(ShortStack::Entries(0), 2.2);
        other.scene = "wood".into();
        let rows = [
            row(ShortStack::Full, 1.0),
            row(ShortStack::Entries(0), 9.0),
            row(ShortStack::Entries(1), 1.4),
            other,
        ];
        let svg = plot(&rows).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for word in ["wood", "entries of the short stack", "sweep 4, primary"] {
            assert!(svg.contains(word), "{word}");
        }
        assert!(svg.contains("\n9.0\n"), "a ratio of 9 is on the chart");
        assert!(plot(&[]).is_err());
    }
}
