//! Where and when a measurement was made, and with which program.

use serde::Serialize;
use std::time::{SystemTime, UNIX_EPOCH};

/// What every record carries.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// The processor's name, as far as the system tells it.
    pub cpu: String,
    /// Threads that run at once.
    pub threads: usize,
    /// The operating system and the architecture.
    pub system: String,
    /// The version of ropewalk.
    pub ropewalk: &'static str,
    /// The commit that it was built from, or `unknown`.
    pub commit: &'static str,
    /// Whether the compiler optimised it fully: a debug build measures nothing worth keeping.
    pub optimized: bool,
    /// The day, UTC, as year-month-day.
    pub date: String,
}

impl Machine {
    /// This machine, now.
    #[must_use]
    pub fn here() -> Self {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        Self {
            cpu: cpu_name().unwrap_or_else(|| format!("unknown {} processor", std::env::consts::ARCH)),
            threads: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            ropewalk: env!("CARGO_PKG_VERSION"),
            commit: env!("ROPEWALK_COMMIT"),
            optimized: !cfg!(debug_assertions),
            date: date(now / 86_400),
        }
    }
}

/// Linux tells it in a file, Windows in the environment.
fn cpu_name() -> Option<String> {
    let told = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| name_in_cpuinfo(&text));
    told.or_else(|| std::env::var("PROCESSOR_IDENTIFIER").ok())
}

fn name_in_cpuinfo(text: &str) -> Option<String> {
    let value = |key: &str| {
        text.lines()
            .filter_map(|line| line.split_once(':'))
            .find(|(name, _)| name.trim() == key)
            .map(|(_, value)| value.trim().to_owned())
            .filter(|value| !value.is_empty())
    };
    value("model name").or_else(|| value("Model")).or_else(|| value("Hardware"))
}

/// The day that lies so many days after 1 January 1970, in the Gregorian calendar.
fn date(days: u64) -> String {
    let leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    // Whole cycles of 400 years first, so that the loop is short for any clock.
    let (mut year, mut days) = (1970 + days / 146_097 * 400, days % 146_097);
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let february = 28 + u64::from(leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year:04}-{month:02}-{:02}", days + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_become_dates() {
        for (days, expected) in [
            (0, "1970-01-01"),
            (58, "1970-02-28"),
            (59, "1970-03-01"),
            (11_016, "2000-02-29"),
            (11_017, "2000-03-01"),
            (19_722, "2023-12-31"),
            (20_454, "2026-01-01"),
        ] {
            assert_eq!(date(days), expected);
        }
        assert!(date(u64::MAX).ends_with(|last: char| last.is_ascii_digit()));
    }

    #[test]
    fn the_processor_is_named() {
        assert_eq!(
            name_in_cpuinfo("processor\t: 0\nmodel name\t: Fast 9000\n").as_deref(),
            Some("Fast 9000")
        );
        assert_eq!(
            name_in_cpuinfo("processor\t: 0\nmodel name\t: \nHardware : Board\n").as_deref(),
            Some("Board")
        );
        assert_eq!(name_in_cpuinfo(""), None);
        assert!(Machine::here().threads > 0);
    }
}
