//! The comparison as tables in markdown: one a scene and device, a line a tree and class of rays.

use super::bands::{Band, PUBLISHED, WANTED};
use super::record::TrailRow;
use crate::comparison::ShortStack;
use std::fmt::Write;

/// Tables of all rows. Rows of one comparison must stand together, as [`super::run`] gives them.
#[must_use]
pub fn markdown(rows: &[TrailRow]) -> String {
    let mut text = String::new();
    for part in rows.chunk_by(|a, b| a.scene == b.scene) {
        let mut devices: Vec<&str> = part.iter().map(|row| row.device.as_str()).collect();
        devices.sort_unstable();
        devices.dedup();
        for device in devices {
            let rows: Vec<&TrailRow> = part.iter().filter(|row| row.device == device).collect();
            scene(&mut text, &rows);
        }
    }
    text
}

fn scene(text: &mut String, rows: &[&TrailRow]) {
    let Some(first) = rows.first() else { return };
    let _ = writeln!(text, "## {} on {}\n", first.scene, first.device);
    let _ = writeln!(
        text,
        "Per ray with the full stack{}: inner visits, leaf visits, triangle tests. Then inner visits over those of the full stack, by entries of the short stack{}.\n",
        if first.culls_at_pop { "" } else { ", without culling at pop" },
        if first.rays_per_s.is_some() { "; in brackets the time over that of the full stack" } else { "" }
    );
    let comparisons: Vec<&[&TrailRow]> =
        rows.chunk_by(|a, b| is_same_tree(a, b) && a.rays == b.rays).collect();
    let stacks: Vec<ShortStack> = comparisons
        .first()
        .map(|rows| {
            rows.iter().map(|row| row.short_stack).filter(|stack| *stack != ShortStack::Full).collect()
        })
        .unwrap_or_default();
    let _ = write!(text, "| builder | leaf cap | references | rays | inner | leaf | tests | full, Mrays/s |");
    for stack in &stacks {
        let _ = write!(text, " {stack} |");
    }
    let _ = writeln!(text, " restarts, {} |", stacks.first().map(ToString::to_string).unwrap_or_default());
    let _ = writeln!(text, "|---|---:|---:|---|---:|---:|---:|---:|{}---:|", "---:|".repeat(stacks.len()));
    for comparison in &comparisons {
        line(text, comparison);
    }
    band(text, "the paper", &PUBLISHED, &stacks);
    band(text, "wanted", &WANTED, &stacks);
    let _ = writeln!(text);
    let outside: Vec<_> = rows.iter().filter(|row| row.in_band == Some(false)).collect();
    if outside.is_empty() {
        let _ = writeln!(text, "Every ratio lies in its wanted band.\n");
    } else {
        let _ = writeln!(text, "{} ratios, marked !, lie outside of the wanted band.\n", outside.len());
    }
    reference(text, rows);
}

fn is_same_tree(a: &TrailRow, b: &TrailRow) -> bool {
    (a.builder, a.max_leaf) == (b.builder, b.max_leaf)
}

fn line(text: &mut String, comparison: &[&TrailRow]) {
    let Some(full) = comparison.iter().find(|row| row.short_stack == ShortStack::Full) else { return };
    let growth = 100.0 * (full.references as f64 / full.triangles.max(1) as f64 - 1.0);
    let rate = full.rays_per_s.map_or_else(|| "-".into(), |rate| format!("{:.2}", rate / 1e6));
    let _ = write!(
        text,
        "| {} | {} | {growth:+.1} % | {} | {:.2} | {:.2} | {:.2} | {rate} |",
        full.builder, full.max_leaf, full.rays, full.inner_visits, full.leaf_visits, full.primitive_tests
    );
    let trails = || comparison.iter().filter(|row| row.short_stack != ShortStack::Full);
    for row in trails() {
        let mark = if row.in_band == Some(false) { "!" } else { "" };
        let time = row.ratio_time.map(|ratio| format!(" ({:.2})", ratio.median)).unwrap_or_default();
        let _ = write!(text, " {:.3}{mark}{time} |", row.ratio_inner);
    }
    let restarts = trails().next().map_or(0.0, |row| row.restarts);
    let _ = writeln!(text, " {restarts:.2} |");
}

/// A line that says between what the ratios should lie.
fn band(text: &mut String, name: &str, bands: &[Band], stacks: &[ShortStack]) {
    let _ = write!(text, "| *{name}* | | | | | | | |");
    for &stack in stacks {
        let band = bands.iter().find(|band| stack == ShortStack::Entries(band.short_stack));
        let cell = band.map(|band| format!("*{:.2} to {:.2}*", band.low, band.high)).unwrap_or_default();
        let _ = write!(text, " {cell} |");
    }
    let _ = writeln!(text, " |");
}

/// How far the ratios are from the reference measurements, where there are any.
fn reference(text: &mut String, rows: &[&TrailRow]) {
    let known: Vec<_> = rows.iter().filter(|row| row.reference_ratio.is_some()).collect();
    if known.is_empty() {
        return;
    }
    let _ = writeln!(text, "Beside the reference measurements (ratio here, there, deviation):\n");
    let _ = writeln!(text, "| builder | leaf cap | rays | entries | here | reference | deviation |");
    let _ = writeln!(text, "|---|---:|---|---:|---:|---:|---:|");
    for row in known {
        let (Some(there), Some(deviation)) = (row.reference_ratio, row.deviation_percent) else { continue };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {:.3} | {there:.3} | {deviation:+.1} % |",
            row.builder, row.max_leaf, row.rays, row.short_stack, row.ratio_inner
        );
    }
    let _ = writeln!(text);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::restart_trail::record::tests::row;

    #[test]
    fn what_lies_outside_is_marked() {
        let mut rows = vec![
            row(ShortStack::Full, 1.0),
            row(ShortStack::Entries(0), 3.9),
            row(ShortStack::Entries(1), 1.4),
        ];
        rows[0].reference_ratio = None;
        rows[1].in_band = Some(false);
        let text = markdown(&rows);
        assert!(text.contains("3.900! (1.25)"), "{text}");
        assert!(text.contains("1 ratios, marked !"), "{text}");
        assert!(text.contains("*2.20 to 2.40*") && text.contains("*1.60 to 3.20*"), "{text}");
        assert!(text.contains("| sweep | 4 | +20.0 % | primary | 20.00 | 2.00 | 5.00 | 2.50 |"), "{text}");
        assert!(text.contains("| 1 | 1.400 | 2.000 | +5.0 % |"), "{text}");
        rows[1].in_band = Some(true);
        assert!(markdown(&rows).contains("Every ratio lies in its wanted band."));
        assert_eq!(markdown(&[]), "");
    }
}
