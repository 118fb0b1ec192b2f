//! Elements a ray by setting, one chart a scene, as SVG.

use super::Table;
use super::record::ListRow;
use super::settings::VERTICES;
use crate::charts::{Area, PlotError, failed, name_series, sheet};
use plotters::prelude::*;

/// Pixels of a chart.
const CHART: (u32, u32) = (640, 400);
/// The classes and their colours.
const CLASSES: [(&str, RGBColor); 3] = [
    ("primary", RGBColor(27, 94, 160)),
    ("shadow", RGBColor(120, 60, 140)),
    ("diffuse", RGBColor(190, 80, 30)),
];

/// A chart for each scene: bars of elements a ray, for each setting of the columns and of the best a group; a stroke across
/// a bar is the reference. Spheres that hold vertices alone are left to the tables. Only rows of the first device of a scene
/// are drawn: counts are the same on all.
///
/// # Errors
/// When there is nothing to draw.
pub fn plot(rows: &[ListRow]) -> Result<String, PlotError> {
    sheet(rows, |row| &row.scene, CHART, chart)
}

fn chart(area: &Area<'_>, rows: &[ListRow]) -> Result<(), PlotError> {
    let Some(first) = rows.first() else { return Ok(()) };
    let is_drawn = |row: &&ListRow| {
        let is_ours = row.spheres != Some(VERTICES);
        let has_bar = is_ours && row.ground && matches!(row.table, Table::Columns | Table::Best);
        row.device == first.device && CLASSES.iter().any(|(name, _)| *name == row.rays) && has_bar
    };
    let mut drawn: Vec<&ListRow> = rows.iter().filter(is_drawn).collect();
    // Where neither was asked for, what there is.
    if drawn.is_empty() {
        drawn = rows.iter().filter(|row| row.device == first.device && row.rays != "frame").collect();
    }
    let mut groups: Vec<(Table, &str)> = Vec::new();
    for row in &drawn {
        if !groups.contains(&(row.table, row.setting.as_str())) {
            groups.push((row.table, &row.setting));
        }
    }
    let highest =
        drawn.iter().map(|row| row.elements_per_ray.max(row.reference.unwrap_or(0.0))).fold(1.0, f64::max);
    let mut chart = ChartBuilder::on(area)
        .caption(format!("{}: list elements a ray", first.scene), ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(36)
        .y_label_area_size(46)
        .build_cartesian_2d(0.0..groups.len() as f64, 0.0..highest * 1.12)
        .map_err(failed)?;
    let name = |x: &f64| {
        let is_middle = (x.fract() - 0.5).abs() < 1e-6;
        let group = groups.get(*x as usize).filter(|_| is_middle);
        group.map_or_else(String::new, |(_, setting)| shortened(setting))
    };
    chart
        .configure_mesh()
        .disable_x_mesh()
        .y_desc("elements a ray")
        .x_labels(2 * groups.len() + 1)
        .x_label_formatter(&name)
        .x_label_style(("sans-serif", 9))
        .y_label_formatter(&|y| format!("{y:.0}"))
        .light_line_style(WHITE)
        .draw()
        .map_err(failed)?;
    for (class, (class_name, color)) in CLASSES.into_iter().enumerate() {
        let place = |row: &&ListRow| {
            let group = groups.iter().position(|group| *group == (row.table, row.setting.as_str()))?;
            let left = group as f64 + 0.14 + 0.24 * class as f64;
            Some((left, left + 0.22))
        };
        let of_class: Vec<_> = drawn
            .iter()
            .filter(|row| row.rays == class_name)
            .filter_map(|row| Some((place(row)?, row.elements_per_ray, row.reference)))
            .collect();
        let bars = of_class.iter().map(|&((left, right), height, _)| {
            Rectangle::new([(left, 0.0), (right, height)], color.mix(0.75).filled())
        });
        chart
            .draw_series(bars)
            .map_err(failed)?
            .label(class_name)
            .legend(move |(x, y)| Rectangle::new([(x, y - 4), (x + 12, y + 4)], color.filled()));
        let strokes = of_class.iter().filter_map(|&((left, right), _, reference)| {
            let height = reference?;
            Some(PathElement::new([(left - 0.02, height), (right + 0.02, height)], BLACK.stroke_width(2)))
        });
        chart.draw_series(strokes).map_err(failed)?;
    }
    name_series(&mut chart)
}

/// The part of a name before its first comma: what there is room for.
fn shortened(setting: &str) -> String {
    setting.split(',').next().unwrap_or_default().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traversal_lists::record::tests::row;

    #[test]
    fn a_plot_names_what_it_shows() {
        let mut other = row("8 all", "shadow", 44.0);
        other.scene = "wood".into();
        let rows =
            [row("1", "primary", 70.0), row("6 all", "primary", 49.0), row("6 all", "diffuse", 57.0), other];
        let svg = plot(&rows).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for word in ["wood: list elements a ray", "6 all", "8 all", "diffuse"] {
            assert!(svg.contains(word), "{word}: {svg}");
        }
        assert!(plot(&[]).is_err());
        // Of a run without columns what there is.
        let row = ListRow { table: Table::AsPrinted, ground: false, ..row("6 as printed", "shadow", 40.0) };
        assert!(plot(&[row]).unwrap().contains("6 as printed"));
    }
}
