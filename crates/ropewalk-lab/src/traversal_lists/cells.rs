//! The cells of the reference measurements: how many counts are near them, and why the others are not.

use super::record::{ListComparison, ListRow};
use super::settings::{BOXES, VERTICES};
use std::fmt::Write;

/// How far a count may be from the reference, in percent.
pub(super) const NEAR: f64 = 5.0;

/// Why counts differ from the reference measurements, as far as trying tells. How far they do is counted.
pub(super) const KNOWN: &str = "The reference's spheres hold the vertices of triangles, as the paper's do. Those of this project hold the triangles' boxes, without which a ray along a triangle's plane could lose its hit, and are larger; so every column is counted with both. Heads are those of rays that begin clearly above their triangle, as all of these do, and pass by what touches its plane, as the reference's do. Its views, ground and light are not known and were found by trying. The cubes' bevels lie on the border of six lists' cones, where rounding decides what is left out.";

/// Cells of the reference measurements, and how many are near.
#[derive(Clone, Copy, Default)]
pub(super) struct Cells {
    pub(super) count: usize,
    near: usize,
    /// The largest deviation, in percent.
    pub(super) farthest: f64,
}

impl Cells {
    pub(super) fn of<'a>(rows: impl Iterator<Item = &'a ListRow>) -> Self {
        rows.filter_map(|row| row.deviation_percent).fold(Self::default(), |cells, deviation| Self {
            count: cells.count + 1,
            near: cells.near + usize::from(deviation.abs() <= NEAR),
            farthest: if deviation.abs() > cells.farthest.abs() { deviation } else { cells.farthest },
        })
    }
}

impl std::fmt::Display for Cells {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} of {} within {NEAR} percent", self.near, self.count)
    }
}

/// How many cells of the reference are near, over all scenes, by what spheres hold. Of each scene the first device counts.
pub(super) fn near_reference(text: &mut String, comparison: &ListComparison) {
    let mut first: Vec<(&str, &str)> = Vec::new();
    for row in &comparison.rows {
        if first.iter().all(|(scene, _)| *scene != row.scene) {
            first.push((&row.scene, &row.device));
        }
    }
    let is_first = |row: &&ListRow| first.contains(&(row.scene.as_str(), row.device.as_str()));
    let of = |spheres: &str, has_heads: Option<bool>| {
        let is_asked = |row: &&ListRow| {
            let heads = row.heads != "disabled" || row.frustum_grid > 0;
            row.spheres == Some(spheres) && has_heads.is_none_or(|has_heads| has_heads == heads)
        };
        Cells::of(comparison.rows.iter().filter(is_first).filter(is_asked))
    };
    if [BOXES, VERTICES].iter().all(|spheres| of(spheres, None).count == 0) {
        return;
    }
    let _ = writeln!(text, "## Beside the reference measurements, all scenes\n");
    let _ = writeln!(
        text,
        "| spheres hold | lists without heads | with heads | all | the farthest | lost hits |"
    );
    let _ = writeln!(text, "|---|---:|---:|---:|---:|---:|");
    for spheres in [BOXES, VERTICES] {
        let (without, with, all) = (of(spheres, Some(false)), of(spheres, Some(true)), of(spheres, None));
        let rows = comparison.rows.iter().filter(is_first);
        let known = rows.filter(|row| row.spheres == Some(spheres) && row.deviation_percent.is_some());
        let lost: usize = known.map(|row| row.lost_hits).sum();
        let farthest = all.farthest;
        let _ = writeln!(text, "| {spheres} | {without} | {with} | {all} | {farthest:+.1} % | {lost} |");
    }
    let _ = writeln!(text, "\n{KNOWN}\n");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traversal_lists::record::tests::row;

    #[test]
    fn what_is_near_is_counted_once_a_scene() {
        let with = |elements: f64| row("6 all", "primary", elements);
        let rows = [with(50.0), with(52.5), with(52.6), with(40.0), row("6 all", "frame", 90.0)];
        let cells = Cells::of(rows.iter());
        assert_eq!((cells.count, cells.near, cells.farthest), (4, 2, -20.0));
        assert_eq!(cells.to_string(), "2 of 4 within 5 percent");
        // What another device counts is the same again.
        let mut rows = rows.to_vec();
        rows.push(ListRow { device: "another".into(), ..with(50.0) });
        let mut text = String::new();
        near_reference(&mut text, &ListComparison { rows, ..ListComparison::default() });
        let boxes = "| boxes | 0 of 0 within 5 percent | 2 of 4 within 5 percent | 2 of 4 within 5 percent | -20.0 % | 0 |";
        assert!(text.contains(boxes), "{text}");
        // Of scenes that it does not have nothing is said.
        let rows = vec![ListRow { deviation_percent: None, ..with(50.0) }];
        let mut text = String::new();
        near_reference(&mut text, &ListComparison { rows, ..ListComparison::default() });
        assert_eq!(text, "");
    }
}
