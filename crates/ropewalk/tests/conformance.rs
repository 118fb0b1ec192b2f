//! Every row of the catalogue that runs on the CPU, over every hard case; and every short stack there is.

use ropewalk::{DeviceKind, StructureKind, catalogue};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::conformance::{Accuracy, ShortStacks, Suite, every_short_stack_on_cpu};

#[test]
fn every_row_on_the_cpu_conforms() {
    let rows: Vec<_> = catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Cpu).collect();
    assert!(rows.len() >= 200);
    let suite = Suite::new(Accuracy::Exact);
    let report = suite.run_on_cpu(&rows, &|_, _| {});
    assert!(report.is_passed(), "{report}");
    for result in &report.rows {
        // A register that is too small for a deep tree may refuse it, so each case counts once at least.
        assert!(result.cases >= suite.case_count() && result.differing == 0);
        // The suite would be worth little if the oracle were to excuse most answers. Hard cases are full of ties
        // and edges, but of the answers to most rays only one is right.
        let (row, clear, rays) = (&result.row, result.clear, result.rays);
        println!("{} {} {}: {clear} of {rays} rays are clear", row.structure, row.walk, row.query);
        // Where rays are taken to objects all are rounded more, and the oracle excuses more; there these are held, to the bit,
        // against each other, and where nothing is moved against the rows of one level.
        let has_levels = matches!(row.structure.kind(), StructureKind::TwoLevel | StructureKind::Instanced);
        let share = if has_levels { 4 } else { 2 };
        assert!(clear * share > rays);
    }
}

/// Every size from 0 to 16, every register, every builder and width: the bits of the ordered stack.
#[test]
fn every_short_stack_is_the_ordered_stack() {
    let tried = ShortStacks::every(DeviceKind::Cpu);
    let compared = every_short_stack_on_cpu(&Case::every(), &tried);
    let failures: Vec<String> = compared.failures.iter().map(ToString::to_string).collect();
    assert!(failures.is_empty(), "{} failures, the first: {}", failures.len(), failures[0]);
    println!("{} batches are equal, {} were refused", compared.batches, compared.refused);
    // 17 sizes; 3 registers of binary trees and 2 of wide ones; 3 builders; 2 queries; every case.
    let batches = 17 * (3 + 2 * 2) * 3 * 2 * Case::names().len();
    assert!(compared.batches + compared.refused >= batches, "{batches}");
    assert!(compared.refused > 0, "no case is deeper than a register");
}
