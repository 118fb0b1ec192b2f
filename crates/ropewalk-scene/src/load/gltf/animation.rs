//! Clips: which node follows which curve.
//!
//! A channel that cannot be read is left out and counted: the rest of the scene moves on. Morph weights are not read.

use super::accessor::Accessor;
use super::buffers::Buffers;
use super::curve::Curve;
use super::document::get;
use super::moving_document::{Animation, Channel, MovingDocument, Sampler};
use super::nodes::Local;
use crate::LoadReport;
use crate::animation::{Clip, Span};
use std::collections::HashMap;

/// What a node follows.
#[derive(Clone, Debug, PartialEq)]
enum Track {
    Translation(Curve<3>),
    Rotation(Curve<4>),
    Scale(Curve<3>),
}

/// The tracks of a clip: at most one of each kind a node.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tracks {
    /// By the index of the node in the document.
    of_node: HashMap<usize, Vec<Track>>,
}

/// How many bytes of keys a file may unfold to: a thousand channels may share one accessor of a million keys.
#[derive(Debug, Default)]
struct Budget {
    used: u64,
}

impl Budget {
    const ALWAYS: u64 = 256 << 20;
    /// Keys of 4 bytes of time and 4 to 16 of value become up to 52; curves may be shared by some channels.
    const RATIO: u64 = 64;

    fn take(&mut self, bytes: u64, loaded: u64) -> bool {
        self.used = self.used.saturating_add(bytes);
        self.used <= loaded.saturating_mul(Self::RATIO).saturating_add(Self::ALWAYS)
    }
}

/// Reads all clips of a file.
pub(super) fn read(
    buffers: &Buffers<'_>,
    document: &MovingDocument,
    report: &mut LoadReport,
) -> Vec<(Clip, Tracks)> {
    let mut budget = Budget::default();
    let mut clips = Vec::with_capacity(document.animations.len());
    for (number, animation) in document.animations.iter().enumerate() {
        let mut tracks = Tracks::default();
        for (index, channel) in animation.channels.iter().enumerate() {
            let place = || format!("animations[{number}].channels[{index}]");
            match track(buffers, animation, channel, &mut budget) {
                Ok(Some((node, track))) => tracks.add(node, track),
                Ok(None) => {}
                Err(Unread::What(what)) => report.skip(&format!("animation channels {what}"), place),
                Err(Unread::Error(error)) => report.skip("animation channels that cannot be read", || error),
            }
        }
        let (start, end) = tracks.ends();
        let name = animation.name.clone().unwrap_or_default();
        clips.push((Clip { name, span: Span::of_seconds(start, end) }, tracks));
    }
    clips
}

/// Why a channel is left out.
enum Unread {
    /// As the end of `animation channels ...`.
    What(&'static str),
    /// A message with its place.
    Error(String),
}

/// The node of a channel and what it follows; `None` for a channel that drives nothing, which the format allows.
fn track(
    buffers: &Buffers<'_>,
    animation: &Animation,
    channel: &Channel,
    budget: &mut Budget,
) -> Result<Option<(usize, Track)>, Unread> {
    let Some(index) = channel.target.node else { return Ok(None) };
    let node = get(&buffers.document.nodes, index).ok_or(Unread::What("of nodes that are not there"))?;
    let sampler =
        get(&animation.samplers, channel.sampler).ok_or(Unread::What("of samplers that are not there"))?;
    let track = match channel.target.path.as_str() {
        "translation" => Track::Translation(curve(buffers, sampler, budget)?),
        "rotation" => Track::Rotation(curve(buffers, sampler, budget)?),
        "scale" => Track::Scale(curve(buffers, sampler, budget)?),
        "weights" => return Err(Unread::What("of morph weights, which are not read")),
        _ => return Err(Unread::What("of properties that are not read")),
    };
    if node.matrix.is_some() {
        return Err(Unread::What("of nodes that are placed by a matrix"));
    }
    // A reference that leads somewhere fits.
    Ok(usize::try_from(index).ok().map(|index| (index, track)))
}

fn curve<const WIDTH: usize>(
    buffers: &Buffers<'_>,
    sampler: &Sampler,
    budget: &mut Budget,
) -> Result<Curve<WIDTH>, Unread> {
    let error = |error: crate::LoadError| Unread::Error(error.to_string());
    let input = Accessor::<1>::open(buffers, sampler.input).map_err(error)?;
    let output = Accessor::<WIDTH>::open(buffers, sampler.output).map_err(error)?;
    let bytes = size_of::<f32>() * input.count() + size_of::<[f32; WIDTH]>() * output.count();
    if !budget.take(bytes as u64, buffers.loaded_bytes()) {
        return Err(Unread::What("with more keys than a file of this size may have"));
    }
    Curve::read(sampler, &input, &output).map_err(Unread::What)
}

impl Tracks {
    /// Of several of one kind for a node the last counts.
    fn add(&mut self, node: usize, track: Track) {
        let tracks = self.of_node.entry(node).or_default();
        tracks.retain(|other| std::mem::discriminant(other) != std::mem::discriminant(&track));
        tracks.push(track);
    }

    /// Whether a node follows some curve.
    pub(super) fn moves(&self, node: usize) -> bool {
        self.of_node.contains_key(&node)
    }

    /// Where a node is in its parent's space, given where it rests.
    pub(super) fn local(&self, node: usize, rest: Local, time: f64) -> Local {
        let mut local = rest;
        for track in self.of_node.get(&node).into_iter().flatten() {
            match track {
                Track::Translation(curve) => local.translation = curve.vector(time),
                Track::Rotation(curve) => local.rotation = curve.rotation(time),
                Track::Scale(curve) => local.scale = curve.vector(time),
            }
        }
        local
    }

    /// From the first key of all to the last.
    fn ends(&self) -> (f64, f64) {
        let ends = self.of_node.values().flatten().map(|track| match track {
            Track::Translation(curve) | Track::Scale(curve) => curve.ends(),
            Track::Rotation(curve) => curve.ends(),
        });
        ends.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1))).unwrap_or_default()
    }
}
