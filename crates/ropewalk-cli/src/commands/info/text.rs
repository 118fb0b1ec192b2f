//! What is known about a scene, in words.

use super::document::{Defects, Document, Fit, StructureRecord};
use crate::table::{bytes, seconds, thousands};
use std::fmt::Write;

impl Document {
    pub(super) fn to_text(&self) -> String {
        let mut text = format!("{} ({})\n", self.scene, self.format);
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "  {name:<12} {value}");
        };
        let unique = if self.unique_triangles == self.triangles {
            String::new()
        } else {
            format!(" ({} unique)", thousands(self.unique_triangles))
        };
        line("triangles", format!("{}{unique}", thousands(self.triangles)));
        line("vertices", thousands(self.vertices));
        line("objects", format!("{} in {} instances", thousands(self.objects), thousands(self.instances)));
        line("materials", thousands(self.materials));
        line("cameras", thousands(self.cameras));
        line("lights", thousands(self.lights));
        match &self.bounds {
            Some(bounds) => line("bounds", format!("{} to {}", point(bounds.min), point(bounds.max))),
            None => line("bounds", "none: there is nothing in it".into()),
        }
        if self.origin != [0.0; 3] {
            let [x, y, z] = self.origin;
            line("origin", format!("({x}, {y}, {z}); the bounds are relative to it"));
        }
        line("loaded in", seconds(self.load_seconds));
        text.push_str(&self.defects.to_text());
        text.push_str(&self.structure.to_text());
        for fit in &self.gpu {
            text.push_str(&fit.to_text());
        }
        text
    }
}

fn point([x, y, z]: [f32; 3]) -> String {
    format!("({x}, {y}, {z})")
}

impl Defects {
    fn to_text(&self) -> String {
        let mut lines: Vec<String> = [
            (self.not_finite, "triangles with a vertex that is NaN, infinite or too large"),
            (self.out_of_range, "triangles with an index that leads to no vertex"),
            (self.degenerate, "triangles with two equal vertices"),
            (self.collinear, "triangles of three points on a line (kept)"),
        ]
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{} {what}", thousands(count)))
        .collect();
        lines.extend(
            self.skipped
                .iter()
                .map(|row| format!("{} {} (the first: {})", thousands(row.count), row.what, row.first)),
        );
        let mut text =
            if lines.is_empty() { "defects: none found\n" } else { "defects, left out:\n" }.to_owned();
        for line in lines {
            let _ = writeln!(text, "  {line}");
        }
        for note in &self.notes {
            let _ = writeln!(text, "note: {note}");
        }
        text
    }
}

impl StructureRecord {
    fn to_text(&self) -> String {
        let (inner, leaves) = (self.nodes.saturating_sub(self.leaves), thousands(self.leaves));
        let nodes = match (self.width, self.lists) {
            (Some(width), _) if width > 2 => {
                format!("{} of {width} children, and {leaves} leaves", thousands(inner))
            }
            (_, Some(lists)) => {
                format!(
                    "{} elements in each of {lists} lists, of which {leaves} triangles",
                    thousands(self.nodes)
                )
            }
            _ => format!("{} of which {leaves} leaves", thousands(self.nodes)),
        };
        let references = if self.references > self.triangles {
            format!(
                "  references   {} to {} triangles (+{:.1}%): some stand in several leaves\n",
                thousands(self.references),
                thousands(self.triangles),
                100.0 * self.reference_growth
            )
        } else {
            String::new()
        };
        format!(
            "{}\n  nodes        {nodes}, depth {}, at most {} triangles a leaf\n{references}  \
             SAH cost     {:.2}\n  size         {} ({:.1} bytes a triangle)\n  built in     {}\n",
            self.name,
            self.depth,
            self.largest_leaf,
            self.sah_cost,
            bytes(self.bytes as u64),
            self.bytes_per_triangle,
            seconds(self.flatten_seconds + self.build_seconds)
        )
    }
}

impl Fit {
    fn to_text(&self) -> String {
        let verdict = match (&self.problem, self.limit_bytes) {
            (Some(problem), _) => problem.clone(),
            (None, limit) => format!(
                "{}: nodes {}, triangles {}, limit {} a buffer",
                if self.fits { "fits" } else { "does not fit" },
                bytes(self.node_bytes),
                bytes(self.triangle_bytes),
                bytes(limit.unwrap_or(0))
            ),
        };
        format!("{} {}\n  {verdict}\n", self.device, self.name)
    }
}
