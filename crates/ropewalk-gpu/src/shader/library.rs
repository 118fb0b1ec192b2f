//! The WGSL files that the program carries, by name.

use super::assembly::{AssemblyError, Definitions, assemble};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The one list of files. A test compares it with the folder.
macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../shaders/", $name, ".wgsl")))),*]
    };
}

const SHIPPED: &[(&str, &str)] = shipped![
    "shared/float",
    "shared/status",
    "shared/ray",
    "shared/aabb",
    "shared/hit",
    "shared/triangle",
    "shared/probe",
    "shared/collect_closest",
    "shared/collect_any",
    "shared/collect_count",
    "shared/collect_all",
    "shared/collect_filtered",
    "shared/bvh",
    "shared/wide_bvh",
    "shared/list_buffers",
    "shared/list",
    "shared/sphere",
    "shared/packed_box",
    "shared/list_grid",
    "shared/kd_tree",
    "shared/kd_places",
    "shared/kd_leaf",
    "shared/kd_trail",
    "shared/kd_certain",
    "shared/half_space",
    "shared/outside_spheres",
    "shared/outside_boxes",
    "shared/heads_polygon",
    "shared/heads_frustum",
    "shared/leaf",
    "shared/seek_ray",
    "shared/seek_spheres",
    "shared/seek_boxes",
    "shared/cells",
    "shared/seek_cells",
    "shared/levels",
    "shared/level_cells",
    "shared/level_list",
    "shared/level_stack",
    "shared/smart_stack",
    "shared/enter",
    "shared/seek_levels",
    "shared/invocation",
    "shared/loops",
    "shared/postponed",
    "shared/short_stack_none",
    "shared/short_stack_ring",
    "shared/short_stack_private",
    "shared/short_stack_workgroup",
    "shared/point_query",
    "shared/point_distance",
    "shared/point_foot",
    "shared/point_triangle",
    "shared/point_order",
    "shared/point_closest",
    "shared/point_nearest",
    "shared/point_leaf",
    "shared/seek_point",
    "shared/trail_u32",
    "shared/trail_u64",
    "shared/trail_array",
    "shared/wide_trail_u64",
    "shared/wide_trail_array",
    "walk/walk_bvh_stack",
    "walk/walk_bvh_postponed",
    "walk/walk_bvh_restart_trail",
    "walk/walk_wide_bvh_stack",
    "walk/walk_wide_bvh_restart_trail",
    "walk/walk_list",
    "walk/walk_kd_stack",
    "walk/walk_kd_restart_trail",
    "walk/walk_kd_restart",
    "walk/walk_kd_backtrack",
    "walk/walk_kd_short_stack",
    "walk/walk_kd_ropes",
    "walk/walk_two_level",
    "kernel/result_closest",
    "kernel/result_word",
    "kernel/result_header",
    "kernel/result_all",
    "kernel/result_point_closest",
    "kernel/result_point_nearest",
    "kernel/frame",
    "kernel/batch",
    "kernel/rays",
    "kernel/points",
    "kernel/heads",
    "kernel/program",
];

/// WGSL files by name: a path without its `.wgsl`, such as `shared/ray`.
#[derive(Clone, Debug)]
pub struct ShaderLibrary {
    files: BTreeMap<Cow<'static, str>, Cow<'static, str>>,
}

impl ShaderLibrary {
    /// The files of this crate.
    #[must_use]
    pub fn shipped() -> Self {
        Self { files: SHIPPED.iter().map(|&(name, text)| (name.into(), text.into())).collect() }
    }

    /// The same library with one more file, or another text for one it has.
    #[must_use]
    pub fn with(mut self, name: impl Into<Cow<'static, str>>, text: impl Into<Cow<'static, str>>) -> Self {
        self.files.insert(name.into(), text.into());
        self
    }

    /// The names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(AsRef::as_ref)
    }

    /// The text of a file, as it was written.
    #[must_use]
    pub fn text(&self, name: &str) -> Option<&str> {
        self.files.get(name).map(AsRef::as_ref)
    }

    /// The text of a file with all that it imports, its conditions decided and its constants filled in.
    ///
    /// # Errors
    /// Names the file and the line of what is wrong.
    pub fn assemble(&self, root: &str, definitions: &Definitions) -> Result<String, AssemblyError> {
        assemble(&|name| self.text(name), root, definitions)
    }
}
