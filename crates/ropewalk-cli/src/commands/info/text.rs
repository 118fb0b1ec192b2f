//! What is known about a scene, in words.

use super::document::{Defects, Document, Fit, ListsRecord, StructureRecord};
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
        let mut text = format!("{}\n", self.name);
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "  {name:<12} {value}");
        };
        match &self.lists {
            Some(lists) => {
                line("elements", lists.to_text());
                line("one list", self.of_one_list(lists));
                if lists.one_sided {
                    let share = 100.0 * lists.culled_share;
                    line("one-sided", format!("{share:.1}% of the triangles' places are left out"));
                }
            }
            None => line("nodes", self.nodes_to_text()),
        }
        if self.references > self.triangles {
            let (references, triangles) = (thousands(self.references), thousands(self.triangles));
            let growth = 100.0 * self.reference_growth;
            let places = if self.lists.is_some() { "places of a list" } else { "leaves" };
            line(
                "references",
                format!(
                    "{references} to {triangles} triangles (+{growth:.1}%): some stand in several {places}"
                ),
            );
        }
        line("SAH cost", format!("{:.2}", self.sah_cost));
        let parts = self.lists.as_ref().map(ListsRecord::parts).unwrap_or_default();
        let (size, each) = (bytes(self.bytes as u64), self.bytes_per_triangle);
        line("size", format!("{size} ({each:.1} bytes a triangle){parts}"));
        line("built in", seconds(self.flatten_seconds + self.build_seconds));
        text
    }

    fn nodes_to_text(&self) -> String {
        let (inner, leaves) = (self.nodes.saturating_sub(self.leaves), thousands(self.leaves));
        let nodes = match self.width {
            Some(width) if width > 2 => {
                format!("{} of {width} children, and {leaves} leaves", thousands(inner))
            }
            _ => format!("{} of which {leaves} leaves", thousands(self.nodes)),
        };
        format!("{nodes}, depth {}, at most {} triangles a leaf", self.depth, self.largest_leaf)
    }

    /// A list that leaves nothing out, of all layers together.
    fn of_one_list(&self, lists: &ListsRecord) -> String {
        let whole = if lists.one_sided { ", before any are left out" } else { "" };
        let (nodes, leaves) = (thousands(self.nodes), thousands(self.leaves));
        format!("{nodes} elements, {leaves} of them triangles, depth {}{whole}", self.depth)
    }
}

impl ListsRecord {
    fn to_text(&self) -> String {
        let count = |count: usize, what: &str| match count {
            1 => format!("one {what}"),
            count => format!("{count} {what}s"),
        };
        let layers = match self.layers {
            1 => String::new(),
            layers => format!(" for each of {}", count(layers, "layer")),
        };
        let (elements, each) = (thousands(self.elements), self.bytes_per_element);
        format!("{elements} of {each} bytes, in {}{layers}", count(self.lists, "list"))
    }

    /// Where the memory goes.
    fn parts(&self) -> String {
        let [elements, shared, heads] =
            [self.element_bytes, self.shared_bytes, self.head_bytes].map(|part| bytes(part as u64));
        let heads = if self.head_bytes > 0 { format!(", heads {heads}") } else { String::new() };
        format!(": elements {elements}, vertices and triangles {shared}{heads}")
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

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::{ListOptions, Mesh, Scene, glam::Vec3};

    fn lists(options: &ListOptions) -> ListsRecord {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let mesh = Mesh::new(corners, vec![[0, 1, 2], [0, 1, 3], [3, 2, 1], [3, 2, 0]]);
        ListsRecord::new(&Scene::from_mesh(mesh).build_list(options).unwrap())
    }

    #[test]
    fn lists_are_counted_in_words() {
        let one =
            ListOptions { directions: ropewalk::traversal_list::Directions::One, ..ListOptions::default() };
        assert!(lists(&one).to_text().ends_with(" of 20 bytes, in one list"), "{}", lists(&one).to_text());
        let eight = lists(&ListOptions { moving: Some(0), ..ListOptions::default() });
        assert!(eight.to_text().ends_with(", in 8 lists for each of 2 layers"), "{}", eight.to_text());
        assert!(!eight.parts().contains("heads"), "{}", eight.parts());
    }

    /// The parts of the memory are the whole, and heads are among them.
    #[test]
    fn the_memory_of_lists_goes_somewhere() {
        let best = lists(&ListOptions::BEST);
        assert_eq!(best.element_bytes, 20 * best.elements);
        // A word for each of four triangles and eight lists.
        assert_eq!(best.head_bytes, 4 * 4 * 8);
        // Four vertices, and of each triangle three indices and three words of who it is.
        assert_eq!(best.shared_bytes, 4 * 12 + 4 * (12 + 12));
        assert!(best.parts().contains(", heads 128 bytes"), "{}", best.parts());
        assert!(best.one_sided && best.culled_share > 0.0);
    }
}
