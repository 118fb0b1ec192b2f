//! Rows of traversal lists, whether they stand in the catalogue or not.

use ropewalk::catalogue::Row;
use ropewalk::{DeviceKind, ListOptions, Query, StructureSpec, Walk};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::conformance::{Accuracy, Report, Suite};

/// The rows of a list that the CPU answers.
pub(crate) fn list_rows(options: ListOptions) -> Vec<Row> {
    let structure = StructureSpec::List(options);
    let rows = |walk| move |query| Row { structure, walk, query, device: DeviceKind::Cpu };
    [Walk::BruteForce, Walk::List].into_iter().flat_map(|walk| Query::EVERY.map(rows(walk))).collect()
}

/// What the suite says of the CPU.
pub(crate) fn run_on_cpu(cases: &[&str], rows: &[Row]) -> Report {
    let cases = cases.iter().filter_map(|name| Case::named(name)).collect();
    Suite::of(cases, Accuracy::Exact).run_on_cpu(rows, &|_, _| {})
}
