//! What the arena asks of an engine, be it ours or foreign: to build, to trace, to refit, to place instances.
//!
//! Everybody gets the same triangles ([`Shape`]), the same rays ([`RaySet`]) and writes the same answers ([`Hit`] or a
//! `bool` a ray). An engine that numbers its primitives otherwise translates them; who computes no barycentrics leaves them
//! at zero. What an engine does not have it answers with `None`: that is no failure.

use super::{Grade, RaySet, Shape};
use ropewalk::Hit;
use ropewalk::glam::Affine3A;
use std::fmt;
use std::ops::Range;
use thiserror::Error;

/// Why an engine did not do what it was asked.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{engine}: {what}")]
pub struct EngineError {
    /// The engine and its preset.
    pub engine: String,
    /// What went wrong.
    pub what: String,
}

/// How rays are handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// One call a ray.
    Single,
    /// One call for 8 rays, laid out lane by lane beforehand, for coherent rays.
    Packet8,
    /// The same for 16 rays.
    Packet16,
    /// One call for all rays; the engine spreads them over the caller's threads.
    Batch,
}

impl Mode {
    /// The name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Packet8 => "packets of 8",
            Self::Packet16 => "packets of 16",
            Self::Batch => "batch",
        }
    }

    /// What a caller has to give: one ray, or many.
    #[must_use]
    pub const fn api(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Packet8 | Self::Packet16 | Self::Batch => "batch",
        }
    }

    /// Whether the engine wants rays that run side by side.
    #[must_use]
    pub const fn is_packet(self) -> bool {
        matches!(self, Self::Packet8 | Self::Packet16)
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

/// An engine with one preset of its builder.
pub trait Engine: Send + Sync {
    /// The engine's name, with its version where it is foreign.
    fn name(&self) -> &str;

    /// The preset of the builder, and of the walk where there are several.
    fn preset(&self) -> &str;

    /// Whether it is not ours.
    fn is_peer(&self) -> bool;

    /// What kind of build it is.
    fn grade(&self) -> Grade;

    /// Whether its build is worth a row of its own; not so where two engines differ in their walks alone.
    fn has_own_build(&self) -> bool {
        true
    }

    /// Builds a structure with so many threads: those of the caller's pool, or its own.
    ///
    /// # Errors
    /// When it cannot.
    fn build(&self, shape: &Shape, threads: usize) -> Result<Box<dyn Tracer>, EngineError>;

    /// A structure whose triangles may move; `None` where there is no such thing.
    fn refitter(&self, _shape: &Shape, _threads: usize) -> Option<Result<Box<dyn Refitter>, EngineError>> {
        None
    }

    /// A top level over copies of one object, of which the structure is built here; `None` where there is no such thing.
    fn top_level(&self, _object: &Shape, _threads: usize) -> Option<Result<Box<dyn TopLevel>, EngineError>> {
        None
    }

    /// An error of this engine.
    fn error(&self, what: impl fmt::Display) -> EngineError
    where
        Self: Sized,
    {
        EngineError { engine: format!("{} {}", self.name(), self.preset()), what: what.to_string() }
    }
}

/// A structure that was built.
pub trait Tracer: Send + Sync {
    /// The bytes that it takes, triangles included; `None` where the engine does not tell.
    fn bytes(&self) -> Option<usize>;

    /// The most bytes that were taken while it was built; `None` where the engine does not tell.
    fn peak_bytes(&self) -> Option<usize> {
        None
    }

    /// How it takes rays.
    fn modes(&self) -> &[Mode];

    /// The closest hit of each ray of a range into `hits`, which is as long as the range.
    fn closest(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]);

    /// Whether each ray of a range hits anything, into `hits`, which is as long as the range.
    fn any(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [bool]);
}

/// A structure whose triangles move.
pub trait Refitter: Send {
    /// Takes new places of the same vertices and brings the boxes up to date. Copying the places is part of it.
    ///
    /// # Errors
    /// When it cannot.
    fn refit(&mut self, moved: &Shape) -> Result<(), EngineError>;
}

/// Copies of one object under a hierarchy of their own.
pub trait TopLevel: Send + Sync {
    /// Places the copies and builds the hierarchy over them anew.
    ///
    /// # Errors
    /// When it cannot.
    fn place(&mut self, places: &[Affine3A]) -> Result<(), EngineError>;

    /// How it takes rays.
    fn modes(&self) -> &[Mode];

    /// The closest hit of each ray of a range, with `instance_index` counting the places.
    fn closest(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]);
}
