//! What a picture file says of how it was made.
//!
//! By itself only what decides the picture: equal pictures are equal files, whatever device, structure or share of the work they
//! came from. All the rest where it is asked for.

use super::Arguments;
use ropewalk_render::{Metadata, RenderSettings};
use std::time::{SystemTime, UNIX_EPOCH};

/// How much a picture file says of how it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Provenance {
    /// Nothing.
    None,
    /// The program and what decides the picture.
    #[default]
    Plain,
    /// That, the command, the device and the time: equal pictures are unequal files then.
    Full,
}

/// The metadata of a picture; of one out of an animation with its time.
pub(super) fn metadata(
    arguments: &Arguments,
    settings: &RenderSettings,
    device: &str,
    time: Option<f64>,
) -> Metadata {
    let mut metadata = Metadata::default();
    if arguments.metadata == Provenance::None {
        return metadata;
    }
    let RenderSettings { width, height, samples, view, integrator, tree, exposure, .. } = settings;
    metadata = metadata
        .with("Software", concat!("ropewalk ", env!("CARGO_PKG_VERSION")))
        .with("Scene", &arguments.scene.to_string())
        .with("Size", &format!("{width}x{height}, {samples} samples a pixel"))
        .with("View", &view.to_string())
        .with("Integrator", &format!("{integrator}, {} bounces", tree.bounces))
        .with("Exposure", &exposure.to_string());
    if let Some(time) = time {
        metadata = metadata.with("Scene Time", &time.to_string());
    }
    if arguments.metadata == Provenance::Full {
        let words: Vec<String> =
            std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
        metadata = metadata.with("Command", &words.join(" ")).with("Device", device);
        if let Ok(since) = SystemTime::now().duration_since(UNIX_EPOCH) {
            metadata = metadata.with("Creation Time", &date(since.as_secs()));
        }
    }
    metadata
}

/// A moment as RFC 3339 writes it, in UTC, from seconds since 1970 without leap seconds (Hinnant, "chrono-compatible
/// low-level date algorithms").
fn date(seconds: u64) -> String {
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Counted from the first of March of the year 0, so that a leap day is the last of its year.
    let days = days + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (hour, minute) = (second / 3600, second / 60 % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{:02}Z", second % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_735_689_599, "2024-12-31T23:59:59Z"),
            (4_102_444_800, "2100-01-01T00:00:00Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(date(seconds), text);
        }
    }
}
