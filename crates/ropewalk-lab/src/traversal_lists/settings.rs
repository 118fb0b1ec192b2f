//! The settings of each table.

use super::batches::Class;
use ropewalk::traversal_list::{
    Bounds, ChildOrder, Clearance, Cull, Directions, Heads, ListOptions, Reach, Source,
};
use ropewalk::{BuildOptions, Builder, StructureSpec};
use serde::{Serialize, Serializer};

/// A table of the comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// 1, 2, 6 and 8 lists without options and with all, of spheres that hold boxes and of spheres that hold vertices.
    Columns,
    /// The paper's Table 1: its options in all combinations, six lists.
    Table1,
    /// The paper's rule of culling, which loses hits.
    AsPrinted,
    /// The best lists, and the same tree walked in other ways.
    Best,
}

impl Table {
    /// Every table, in the order in which they are made.
    pub const EVERY: [Self; 4] = [Self::Columns, Self::Table1, Self::AsPrinted, Self::Best];

    /// The name in records and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Columns => "columns",
            Self::Table1 => "table-1",
            Self::AsPrinted => "as-printed",
            Self::Best => "best",
        }
    }

    /// Whether the scene stands on the ground.
    #[must_use]
    pub const fn has_ground(self) -> bool {
        matches!(self, Self::Columns | Self::Best)
    }
}

impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// What is tried.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Setting {
    pub(super) table: Table,
    /// Its name in the table; settings that differ in what spheres hold share it.
    pub(super) name: String,
    pub(super) structure: StructureSpec,
    /// Whether frames are timed.
    pub(super) is_timed: bool,
}

impl Setting {
    /// The lists' options, where it is lists.
    pub(super) const fn lists(&self) -> Option<&ListOptions> {
        match &self.structure {
            StructureSpec::List(options) => Some(options),
            _ => None,
        }
    }

    /// Whether it loses hits, and that is known.
    pub(super) fn loses_hits(&self) -> bool {
        self.spheres() == Some(VERTICES) || self.lists().is_some_and(|it| it.cull == Cull::AsPrinted)
    }

    /// What the spheres of lists hold.
    pub(super) fn spheres(&self) -> Option<&'static str> {
        let options = self.lists().filter(|options| options.bounds == Bounds::Sphere)?;
        Some(match options.reach {
            Reach::Boxes => BOXES,
            Reach::Vertices => VERTICES,
        })
    }

    /// What is built for it: the cells of the screen are no part of that.
    pub(super) fn built(&self) -> StructureSpec {
        match self.structure {
            StructureSpec::List(options) => StructureSpec::List(ListOptions { frustum_grid: 0, ..options }),
            other => other,
        }
    }

    /// Whether the rays of a class are asked: of a frame only where it is timed.
    pub(super) fn asks(&self, class: Class) -> bool {
        class != Class::Frame || self.is_timed
    }
}

/// The name in records of spheres that hold the triangles' boxes.
pub(super) const BOXES: &str = "boxes";
/// Of those that hold the triangles' vertices alone, as the paper's and the reference's do.
pub(super) const VERTICES: &str = "vertices";

/// The paper's lists: an octree of spheres, earliest first, and no option.
const PLAIN: ListOptions = ListOptions {
    source: Source::Octree,
    bounds: Bounds::Sphere,
    reach: Reach::Boxes,
    directions: Directions::One,
    order: ChildOrder::EarliestFirst,
    big: 50,
    cull: Cull::None,
    heads: Heads::Disabled,
    clearance: Clearance::Surface,
    frustum_grid: 0,
    moving: None,
};

/// The settings of a table, with pictures of so many cells a side where frustums are culled.
pub(super) fn settings(table: Table, grid: u32) -> Vec<Setting> {
    let setting = |name: &str, options: ListOptions, is_timed| Setting {
        table,
        name: name.into(),
        structure: StructureSpec::List(options),
        is_timed,
    };
    let plain = |directions| ListOptions { directions, ..PLAIN };
    match table {
        Table::Columns => [Reach::Boxes, Reach::Vertices]
            .into_iter()
            .flat_map(|reach| {
                let plain = |directions| ListOptions { reach, ..plain(directions) };
                // All rays that start on triangles start above them, here and in the reference.
                let heads = |directions| ListOptions {
                    heads: Heads::Regular,
                    clearance: Clearance::Above,
                    frustum_grid: grid,
                    ..plain(directions)
                };
                let all = |directions| ListOptions { cull: Cull::Exact, ..heads(directions) };
                let is_timed = reach == Reach::Boxes;
                [
                    setting("1", plain(Directions::One), is_timed),
                    setting("1 heads", heads(Directions::One), is_timed),
                    setting("2", plain(Directions::Two), false),
                    setting("6", plain(Directions::Six), false),
                    setting("6 all", all(Directions::Six), is_timed),
                    setting("8", plain(Directions::Eight), false),
                    setting("8 all", all(Directions::Eight), is_timed),
                ]
            })
            .collect(),
        Table::Table1 => {
            let mut rows = Vec::new();
            // The order of the paper's rows.
            for (order, order_name) in
                [(ChildOrder::LatestLast, "latest last"), (ChildOrder::EarliestFirst, "earliest first")]
            {
                for (cull, cull_name) in [(Cull::None, "two-sided"), (Cull::Exact, "culled")] {
                    for (heads, heads_name) in
                        [(Heads::Disabled, "no heads"), (Heads::Regular, "regular heads")]
                    {
                        for (frustum_grid, frustum) in [(grid, "frustum"), (0, "no frustum")] {
                            let directions = Directions::Six;
                            let options =
                                ListOptions { directions, order, cull, heads, frustum_grid, ..PLAIN };
                            let name = format!("{order_name}, {cull_name}, {heads_name}, {frustum}");
                            rows.push(setting(&name, options, true));
                        }
                    }
                }
            }
            rows
        }
        Table::AsPrinted => [("6 as printed", Directions::Six), ("8 as printed", Directions::Eight)]
            .map(|(name, directions)| {
                setting(name, ListOptions { cull: Cull::AsPrinted, ..plain(directions) }, false)
            })
            .to_vec(),
        Table::Best => {
            let best = ListOptions { frustum_grid: grid, ..ListOptions::BEST };
            let two_sided = ListOptions { cull: Cull::None, heads: Heads::Disabled, frustum_grid: 0, ..best };
            let tree = BuildOptions { builder: Builder::Sbvh, max_leaf: 1, ..BuildOptions::default() };
            let skip = ListOptions { directions: Directions::One, ..two_sided };
            vec![
                setting("best", best, true),
                setting("8 lists of boxes, two-sided", two_sided, true),
                setting("skip pointers", skip, true),
                Setting {
                    table,
                    name: "ordered stack".into(),
                    structure: StructureSpec::Bvh(tree),
                    is_timed: true,
                },
            ]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_has_its_settings() {
        let names = |table| -> Vec<String> { settings(table, 16).into_iter().map(|it| it.name).collect() };
        let columns = ["1", "1 heads", "2", "6", "6 all", "8", "8 all"];
        assert_eq!(names(Table::Columns), [columns, columns].concat());
        assert_eq!(names(Table::Table1).len(), 16);
        assert_eq!(names(Table::AsPrinted).len(), 2);
        assert_eq!(names(Table::Best)[3], "ordered stack");
        for table in Table::EVERY {
            let settings = settings(table, 16);
            for (index, setting) in settings.iter().enumerate() {
                assert!(settings[..index].iter().all(|other| other.structure != setting.structure));
                let name = |setting: &Setting| (setting.name.clone(), setting.spheres());
                assert!(settings[..index].iter().all(|other| name(other) != name(setting)));
                let is_known = table == Table::AsPrinted || setting.spheres() == Some(VERTICES);
                assert_eq!(setting.loses_hits(), is_known, "{setting:?}");
                assert!(!(setting.is_timed && setting.loses_hits()), "{setting:?}");
            }
        }
    }

    #[test]
    fn the_screen_is_no_part_of_what_is_built() {
        let settings = settings(Table::Table1, 16);
        assert_ne!(settings[0].structure, settings[1].structure);
        assert_eq!(settings[0].built(), settings[1].built());
    }

    /// The same tree below the best lists and below the stack.
    #[test]
    fn the_trees_of_the_best_are_one() {
        let settings = settings(Table::Best, 16);
        let lists = settings[0].lists().and_then(ListOptions::build_options);
        assert_eq!(lists.as_ref(), settings[3].structure.build_options());
    }
}
