//! Errors as values: each names the thing, the limit, and the way out.

use crate::Walk;
use thiserror::Error;

/// A transform that cannot place an object.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum TransformError {
    /// A component is NaN or infinite.
    #[error("the transform has a component that is NaN or infinite")]
    NotFinite,
    /// The map has no inverse.
    #[error(
        "the transform is singular: it flattens space and cannot be undone; give every axis a scale that is not 0"
    )]
    Singular,
    /// A ray could not be taken to the object's space.
    #[error(
        "the transform is out of range: of its inverse the largest component must lie between 2^-60 and 2^60, and what it places must stay finite; scale the object's vertices instead"
    )]
    OutOfRange,
}

/// A scene that cannot be made into a structure.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum SceneError {
    /// An instance names an object that is not there.
    #[error("instance {instance} places object {object}, but the scene has {objects} objects")]
    NoSuchObject {
        /// The instance.
        instance: usize,
        /// The object it names.
        object: u32,
        /// How many there are.
        objects: usize,
    },
    /// More instances than the 24 bits of an instance index count.
    #[error("the scene has {instances} instances; at most {limit} can be told apart: merge some objects")]
    TooManyInstances {
        /// How many there are.
        instances: usize,
        /// How many there may be.
        limit: usize,
    },
    /// More triangles than a 32-bit tree holds.
    #[error(
        "the scene has {triangles} triangles with instances counted; one structure holds at most {limit}: split the scene"
    )]
    TooManyTriangles {
        /// How many there are.
        triangles: usize,
        /// How many there may be.
        limit: usize,
    },
    /// An instance cannot be placed.
    #[error("instance {instance}: {why}")]
    Transform {
        /// The instance.
        instance: usize,
        /// What is wrong with its transform.
        why: TransformError,
    },
    /// No top level can be built over the instances.
    #[error(transparent)]
    TopLevel(#[from] crate::two_level::top_level::TopLevelError),
}

/// Why a structure was not built.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum BuildError {
    /// The scene is not buildable.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An option is outside of its range.
    #[error("{option} is {value}; it must lie between {smallest} and {largest}")]
    Option {
        /// The option's name.
        option: &'static str,
        /// What was asked for.
        value: usize,
        /// The least that may be asked for.
        smallest: usize,
        /// The most that may be asked for.
        largest: usize,
    },
    /// More of something than 32-bit words can count.
    #[error(
        "there are {count} {what}, and {limit} at most can be addressed: split the scene, or build fewer lists"
    )]
    TooMany {
        /// What there are too many of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// The caller's monitor said stop.
    #[error("the build was cancelled")]
    Cancelled,
}

/// Why a structure did not follow a scene that moved. It has not changed.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum UpdateError {
    /// The scene is not buildable.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The lists have left out triangles by their normals.
    #[error(
        "the lists leave out what their rays cannot see, which may be seen after a move: build them anew, or with cull=none"
    )]
    Culled,
    /// Triangles have come or gone; one that becomes a line or leaves the range of coordinates is gone, too.
    #[error(
        "the structure was built of {was} triangles, and the scene has {is} that can be hit now: build it anew"
    )]
    OtherCount {
        /// How many there were.
        was: usize,
        /// How many there are.
        is: usize,
    },
    /// A triangle is another one, or has other vertices.
    #[error("triangle {number} of the scene is not the one that the structure was built of: build it anew")]
    OtherTriangle {
        /// Its number, in the order of instances, geometries and primitives.
        number: usize,
    },
    /// The structure cuts space by planes, which triangles that move leave behind.
    #[error("a kd-tree cannot follow triangles that move: build it anew, or take a BVH")]
    FixedPlanes,
    /// Vertices that had the same place are one.
    #[error(
        "a compact tree keeps vertices of the same place as one, which may part when the scene moves: build it anew, or take another preset"
    )]
    SharedVertices,
}

/// A structure, walk or query that does not exist, or not in this combination. The text names the ones that do.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{0}")]
pub struct CatalogueError(pub String);

/// Why a batch was not traced.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum TraceError {
    /// The combination is not in the catalogue.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The tree is deeper than the walk's register.
    #[error(
        "the walk '{walk}' goes through trees of depth {limit} at most, and this one has {depth}: take register=auto, or build with max-depth={limit}"
    )]
    TooDeep {
        /// The walk.
        walk: String,
        /// The depth of the tree.
        depth: u32,
        /// The depth that the register leads to.
        limit: u32,
    },
}

impl TraceError {
    /// The error of a tree that is deeper than a walk's register.
    #[must_use]
    pub fn too_deep(walk: Walk, depth: u32, limit: u32) -> Self {
        Self::TooDeep { walk: walk.to_string(), depth, limit }
    }
}

/// A structure that breaks its own rules: what validation found.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("node {node}: {what}")]
pub struct ValidationError {
    /// The node.
    pub node: usize,
    /// The rule that it breaks.
    pub what: String,
}
