//! Objects entered, speeds, and the times of rebuilds, as SVG.

use super::paper::REBUILD_1000_MS;
use super::record::{RebuildRow, TwoLevelRow};
use crate::charts::{Area, PlotError, failed, name_series, sheet};
use plotters::prelude::*;

/// Pixels of a chart.
const CHART: (u32, u32) = (680, 520);
/// The classes of rays and their colours.
const CLASSES: [(&str, RGBColor); 3] = [
    ("primary", RGBColor(27, 94, 160)),
    ("shadow", RGBColor(120, 60, 140)),
    ("diffuse", RGBColor(190, 80, 30)),
];

/// A group of bars, one a class of rays.
type Bars<'a> = Vec<(String, Vec<(usize, f64)>)>;

/// A chart for each scene: the objects' structures that rays enter, for each kind without oriented boxes and with. Counts are the
/// same on all devices; those of the first are drawn.
///
/// # Errors
/// When there is nothing to draw.
pub fn plot_objects(rows: &[TwoLevelRow]) -> Result<String, PlotError> {
    let value = |row: &TwoLevelRow| row.objects_entered;
    sheet(
        rows,
        |row| &row.scene,
        CHART,
        |area, rows| bars(area, rows, "objects' structures entered a ray", "structures", None, &value),
    )
}

/// A chart for each scene: the speed of two levels over that of one kd-tree, of the first device; by the clock where it was
/// measured, else by the model of what nodes cost. The line is one kd-tree.
///
/// # Errors
/// When there is nothing to draw.
pub fn plot_speeds(rows: &[TwoLevelRow]) -> Result<String, PlotError> {
    let is_timed = rows.iter().any(|row| row.relative_to_single_kd.is_some());
    let by = if is_timed { "measured" } else { "by the model" };
    let value = move |row: &TwoLevelRow| {
        let by_model = Some(row.cost_relative_to_single_kd);
        row.bottom.as_ref().and(if is_timed { row.relative_to_single_kd } else { by_model })
    };
    sheet(
        rows,
        |row| &row.scene,
        CHART,
        |area, rows| bars(area, rows, &format!("speed over one kd-tree, {by}"), "ratio", Some(1.0), &value),
    )
}

fn bars(
    area: &Area<'_>,
    rows: &[TwoLevelRow],
    caption: &str,
    unit: &str,
    line: Option<f64>,
    value: &dyn Fn(&TwoLevelRow) -> Option<f64>,
) -> Result<(), PlotError> {
    let Some(first) = rows.first() else { return Ok(()) };
    let mut groups: Bars<'_> = Vec::new();
    for row in rows.iter().filter(|row| row.device == first.device) {
        let class = CLASSES.iter().position(|(name, _)| *name == row.rays);
        let (Some(value), Some(class)) = (value(row), class) else { continue };
        let name = group_name(row);
        match groups.iter_mut().find(|(other, _)| *other == name) {
            Some((_, bars)) => bars.push((class, value)),
            None => groups.push((name, vec![(class, value)])),
        }
    }
    let all = || groups.iter().flat_map(|(_, bars)| bars.iter().map(|&(_, value)| value));
    let highest = all().fold(line.unwrap_or(0.5), f64::max);
    let count = groups.len().max(1) as f64;
    // To the right of the bars there is room for the names of the classes.
    let mut chart = ChartBuilder::on(area)
        .caption(format!("{}: {caption}", first.scene), ("sans-serif", 15))
        .margin(12)
        .x_label_area_size(34)
        .y_label_area_size(190)
        .build_cartesian_2d(0.0..highest * 1.3, 0.0..count)
        .map_err(failed)?;
    // The first group is the highest.
    let name = |y: &f64| {
        let is_middle = (y.fract() - 0.5).abs() < 1e-6;
        let group = groups.get((count - y) as usize).filter(|_| is_middle);
        group.map_or_else(String::new, |(name, _)| name.clone())
    };
    chart
        .configure_mesh()
        .disable_y_mesh()
        .x_desc(unit)
        .y_labels(2 * groups.len() + 1)
        .y_label_formatter(&name)
        .y_label_style(("sans-serif", 10))
        .x_label_formatter(&|x| format!("{x:.1}"))
        .light_line_style(WHITE)
        .draw()
        .map_err(failed)?;
    for (class, (class_name, color)) in CLASSES.into_iter().enumerate() {
        let of_class = groups.iter().enumerate().flat_map(|(group, (_, bars))| {
            let top = count - group as f64 - 0.14 - 0.24 * class as f64;
            let own = bars.iter().filter(move |(other, _)| *other == class);
            own.map(move |&(_, value)| {
                Rectangle::new([(0.0, top), (value, top - 0.22)], color.mix(0.75).filled())
            })
        });
        chart
            .draw_series(of_class)
            .map_err(failed)?
            .label(class_name)
            .legend(move |(x, y)| Rectangle::new([(x, y - 4), (x + 12, y + 4)], color.filled()));
    }
    if let Some(value) = line {
        let ends = [(value, 0.0), (value, count)];
        chart.draw_series(LineSeries::new(ends, BLACK.stroke_width(1))).map_err(failed)?;
    }
    name_series(&mut chart)
}

/// What the objects have, in which boxes, and what is unusual about the rest.
fn group_name(row: &TwoLevelRow) -> String {
    let mut name = row.bottom.clone().unwrap_or_default();
    if row.oriented_boxes == Some(true) {
        name.push_str(", oriented");
    }
    if row.walk.starts_with("smart-stack") {
        name.push_str(", smart stack");
    }
    if row.structure.contains("opening=by-cost") {
        name.push_str(", opened by cost");
    } else if row.structure.contains("opening=") {
        name.push_str(", opened blindly");
    }
    name
}

/// The times of the top level over the number of objects, on logarithmic axes, and the paper's.
///
/// # Errors
/// When there is nothing to draw.
pub fn plot_rebuilds(rows: &[RebuildRow]) -> Result<String, PlotError> {
    let times = |row: &RebuildRow| [row.rebuild_ms, row.refit_ms, row.restructure_ms, row.frame_ms];
    // A clock that shows no time has no place on the axis.
    let shown = || rows.iter().flat_map(times).filter(|&time| time > 0.0);
    let lowest = shown().fold(REBUILD_1000_MS, f64::min) / 1.5;
    let highest = shown().fold(REBUILD_1000_MS, f64::max) * 1.5;
    let counts = || rows.iter().map(|row| row.objects as f64);
    let (fewest, most) = (counts().fold(1000.0, f64::min) / 1.3, counts().fold(1000.0, f64::max) * 1.3);
    if rows.is_empty() {
        return Err(failed("there are no rows"));
    }
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, CHART).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let mut chart = ChartBuilder::on(&root)
            .caption("following objects that move, one thread", ("sans-serif", 17))
            .margin(12)
            .x_label_area_size(36)
            .y_label_area_size(56)
            .build_cartesian_2d((fewest..most).log_scale(), (lowest..highest).log_scale())
            .map_err(failed)?;
        chart
            .configure_mesh()
            .x_desc("objects")
            .y_desc("milliseconds")
            .x_label_formatter(&|count| format!("{count:.0}"))
            .light_line_style(WHITE)
            .draw()
            .map_err(failed)?;
        let series = [
            ("rebuild", RGBColor(27, 94, 160)),
            ("refit", RGBColor(40, 140, 70)),
            ("refit and restructure", RGBColor(120, 60, 140)),
            ("a frame: transforms and rebuild", RGBColor(190, 80, 30)),
        ];
        for (place, (name, color)) in series.into_iter().enumerate() {
            let points: Vec<(f64, f64)> = rows
                .iter()
                .map(|row| (row.objects as f64, times(row)[place]))
                .filter(|&(_, time)| time > 0.0)
                .collect();
            chart
                .draw_series(LineSeries::new(points.clone(), color.stroke_width(2)))
                .map_err(failed)?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], color.stroke_width(2)));
            let dots = points.iter().map(|&point| Circle::new(point, 3, color.filled()));
            chart.draw_series(dots).map_err(failed)?;
        }
        let paper = std::iter::once(TriangleMarker::new((1000.0, REBUILD_1000_MS), 6, BLACK.filled()));
        chart
            .draw_series(paper)
            .map_err(failed)?
            .label("rebuild, the paper (2010)")
            .legend(|(x, y)| TriangleMarker::new((x + 7, y), 6, BLACK.filled()));
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerRight)
            .label_font(("sans-serif", 10))
            .background_style(WHITE.mix(0.85))
            .draw()
            .map_err(failed)?;
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::two_level::record::tests::{rebuild_row, row};

    #[test]
    fn plots_name_what_they_show() {
        let mut other = row(Some("list"), false, "shadow", 2.0);
        other.scene = "wood".into();
        let rows = [
            row(None, false, "primary", 0.0),
            row(Some("kd-tree"), true, "primary", 1.2),
            row(Some("kd-tree"), false, "diffuse", 3.2),
            other,
        ];
        for svg in [plot_objects(&rows).unwrap(), plot_speeds(&rows).unwrap()] {
            assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
            for word in ["wood: ", "kd-tree, oriented", "diffuse"] {
                assert!(svg.contains(word), "{word}: {svg}");
            }
        }
        assert!(plot_speeds(&rows).unwrap().contains("measured"));
        let untimed = rows.map(|row| TwoLevelRow { relative_to_single_kd: None, ..row });
        assert!(plot_speeds(&untimed).unwrap().contains("by the model"));
        assert!(plot_objects(&[]).is_err() && plot_speeds(&[]).is_err());
        // One structure alone has nothing to show, and that is no failure.
        assert!(plot_objects(&untimed[..1]).is_ok());
    }

    #[test]
    fn rebuilds_are_drawn_on_logarithmic_axes() {
        let svg = plot_rebuilds(&[rebuild_row(100, 0.02), rebuild_row(100_000, 60.0)]).unwrap();
        for word in ["milliseconds", "refit and restructure", "the paper (2010)"] {
            assert!(svg.contains(word), "{word}: {svg}");
        }
        assert!(plot_rebuilds(&[rebuild_row(1, 0.0)]).is_ok());
        assert!(plot_rebuilds(&[]).is_err());
    }
}
