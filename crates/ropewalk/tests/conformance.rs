//! Every row of the catalogue that runs on the CPU, over every hard case.

use ropewalk::{DeviceKind, catalogue};
use ropewalk_testkit::conformance::{Accuracy, Cpu, Suite};

#[test]
fn every_row_on_the_cpu_conforms() {
    let rows: Vec<_> = catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Cpu).collect();
    assert!(rows.len() >= 32);
    let suite = Suite::new(Accuracy::Exact);
    let report = suite.run(&rows, &mut Cpu::default(), &mut |_, _| {});
    assert!(report.is_passed(), "{report}");
    for result in &report.rows {
        assert!(result.cases >= suite.case_count() && result.differing == 0);
        // The suite would be worth little if the oracle were to excuse most answers. Hard cases are full of ties
        // and edges, but of the answers to most rays only one is right.
        println!(
            "{} {}: {} of {} rays are clear",
            result.row.walk, result.row.query, result.clear, result.rays
        );
        assert!(result.clear * 2 > result.rays);
    }
}
