//! What is kept of the arena: rows of plain data for JSON and for tables.

use super::{Engine, Mode, Verdict};
use crate::Spread;
use serde::Serialize;

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RowKind {
    /// Rays a second.
    Trace,
    /// The time to build, and bytes.
    Build,
    /// The time to follow triangles that moved.
    Refit,
    /// The time to place copies anew.
    TopLevel,
}

/// What kind of build a preset is: builds are compared with their like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// As soon as possible.
    Fast,
    /// A good tree without spatial splits.
    Balanced,
    /// The best tree.
    High,
    /// The smallest.
    Compact,
}

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What.
    pub kind: RowKind,
    /// Over which scene.
    pub scene: String,
    /// By whom.
    pub engine: String,
    /// With which preset.
    pub preset: String,
    /// Whether the engine is not ours.
    pub peer: bool,
    /// Which rays, or which copies; empty for builds and refits.
    pub rays: String,
    /// `single` or `batch`; empty where no rays are traced.
    pub api: &'static str,
    /// How the rays are handed over: packets are a kind of batch.
    pub mode: &'static str,
    /// Threads.
    pub threads: usize,
    /// Million rays a second, the median.
    pub mrays_per_s: Option<f64>,
    /// Milliseconds for all rays, for the build, the refit or the top level; the median.
    pub ms: f64,
    /// The structure's bytes a triangle.
    pub bytes_per_triangle: Option<f64>,
    /// The most bytes a triangle while it was built.
    pub peak_bytes_per_triangle: Option<f64>,
    /// How many times as fast as the best peer: the median of the rounds' ratios. Single calls are compared with the best single
    /// calls, batches with the best of any kind, builds with builds of their grade.
    pub ratio_to_best_peer: Option<f64>,
    /// The peer that was compared with.
    pub best_peer: Option<String>,
    /// How the ratios of the rounds spread.
    pub spread: Option<Spread>,
    /// What the comparison of its answers found, for rows of rays.
    pub agreement: Option<Verdict>,
}

/// One scene.
#[derive(Clone, Debug, Serialize)]
pub struct StageRecord {
    /// Its name.
    pub scene: String,
    /// Its triangles.
    pub triangles: usize,
    /// Rounds.
    pub rounds: usize,
    /// The measurements.
    pub rows: Vec<Row>,
    /// What could not be measured, and why.
    pub failures: Vec<String>,
}

impl StageRecord {
    /// Rows of ours with a wrong answer.
    pub fn wrong_answers_of_ours(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| !row.peer && row.agreement.is_some_and(|verdict| verdict.wrong() > 0))
    }
}

/// Times of one engine at one task, round by round.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sample {
    /// The group whose peers it is compared with: single calls and batches, or the grade of a build.
    pub(super) peers: Peers,
    /// Who.
    pub(super) label: String,
    /// Whether it is a peer that others are compared with.
    pub(super) is_standard: bool,
    /// Seconds a round.
    pub(super) seconds: Vec<f64>,
}

/// With whom a sample is compared, and to whom it is a standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Peers {
    /// By how rays are handed over.
    Rays(Mode),
    /// By what is built.
    Builds(Grade),
    /// With everybody.
    All,
}

impl Peers {
    /// Whether a peer of the group `other` is a standard for this.
    fn includes(self, other: Self) -> bool {
        match (self, other) {
            (Self::Rays(Mode::Single), Self::Rays(other)) => other == Mode::Single,
            (Self::Rays(_), Self::Rays(_)) | (Self::All, Self::All) => true,
            (Self::Builds(grade), Self::Builds(other)) => grade == other,
            _ => false,
        }
    }
}

/// How a sample stands beside the best peer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Standing {
    pub(super) best_peer: String,
    /// The peer's time over the sample's own, round by round.
    pub(super) ratio: Spread,
}

/// Where the sample `index` stands among all; `None` where nobody is to be compared with.
pub(super) fn standing(samples: &[Sample], index: usize) -> Option<Standing> {
    let own = samples.get(index)?;
    let median = |sample: &Sample| Spread::of(&sample.seconds).map(|spread| spread.median);
    let best = samples
        .iter()
        .filter(|other| other.is_standard && own.peers.includes(other.peers))
        .filter_map(|other| Some((median(other)?, other)))
        .min_by(|a, b| a.0.total_cmp(&b.0))?
        .1;
    let ratios: Vec<f64> = best.seconds.iter().zip(&own.seconds).map(|(best, own)| best / own).collect();
    Some(Standing { best_peer: best.label.clone(), ratio: Spread::of(&ratios)? })
}

/// The row of the sample `index`, without what only some kinds of rows have; `None` where it has no times.
pub(super) fn row(
    kind: RowKind,
    scene: &str,
    threads: usize,
    engine: &dyn Engine,
    samples: &[Sample],
    index: usize,
) -> Option<Row> {
    let seconds = Spread::of(&samples.get(index)?.seconds)?.median;
    let standing = standing(samples, index);
    Some(Row {
        kind,
        scene: scene.into(),
        engine: engine.name().into(),
        preset: engine.preset().into(),
        peer: engine.is_peer(),
        rays: String::new(),
        api: "",
        mode: "",
        threads,
        mrays_per_s: None,
        ms: seconds * 1e3,
        bytes_per_triangle: None,
        peak_bytes_per_triangle: None,
        ratio_to_best_peer: standing.as_ref().map(|standing| standing.ratio.median),
        best_peer: standing.as_ref().map(|standing| standing.best_peer.clone()),
        spread: standing.as_ref().map(|standing| standing.ratio),
        agreement: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(peers: Peers, is_standard: bool, seconds: &[f64]) -> Sample {
        Sample { peers, label: format!("{seconds:?}"), is_standard, seconds: seconds.to_vec() }
    }

    #[test]
    fn ratios_are_made_round_by_round() {
        let single = Peers::Rays(Mode::Single);
        let samples = [
            sample(single, false, &[1.0, 2.0, 1.0]),
            sample(single, true, &[2.0, 4.0, 3.0]),
            sample(single, true, &[5.0, 5.0, 5.0]),
        ];
        let standing = standing(&samples, 0).unwrap();
        assert_eq!(standing.ratio, Spread { median: 2.0, min: 2.0, max: 3.0 });
        assert_eq!(standing.best_peer, samples[1].label);
    }

    #[test]
    fn a_batch_meets_everybody_and_a_single_call_its_like() {
        let packets = sample(Peers::Rays(Mode::Packet16), true, &[1.0]);
        let one = sample(Peers::Rays(Mode::Single), true, &[4.0]);
        let batch = sample(Peers::Rays(Mode::Batch), false, &[2.0]);
        let own = sample(Peers::Rays(Mode::Single), false, &[2.0]);
        let samples = [packets, one, batch, own];
        assert_eq!(standing(&samples, 2).unwrap().ratio.median, 0.5);
        assert_eq!(standing(&samples, 3).unwrap().ratio.median, 2.0);
        let fast = sample(Peers::Builds(Grade::Fast), true, &[1.0]);
        assert_eq!(standing(&[sample(Peers::Builds(Grade::High), false, &[9.0]), fast], 0), None);
        assert_eq!(standing(&samples, 7), None);
    }
}
