//! What a report must say of a fault.

use ropewalk_testkit::conformance::Report;
use std::fmt;

/// Demands that a fault is caught over a case, by a check whose words contain `says`.
pub(crate) fn demand_caught(report: &Report, fault: impl fmt::Debug, case: &str, says: &str) {
    let texts: Vec<String> = report.failures().map(|(_, failure)| failure.what.clone()).collect();
    assert!(report.is_caught_by(case), "{fault:?} slips through the case {case}");
    assert!(texts.iter().any(|text| text.contains(says)), "{fault:?}: no text says '{says}': {texts:#?}");
}
