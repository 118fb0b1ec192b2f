//! Closest points: which triangle is nearest to a point, which k are, and on which side of a closed surface it lies.
//!
//! Point queries go through the same binary trees as rays ([`crate::Bvh`]) by the same walks ([`crate::bvh::walk`]),
//! with a stack or with the restart trail, of which "closest-point and kNN searches" are the second piece of future work
//! (Laine 2010). What the entry of a box is to a ray, the squared distance to it is to a point.
//!
//! | file | what |
//! |---|---|
//! | `query` | [`PointQuery`], what is asked, and [`PreparedPoint`], what a walk needs of it |
//! | `answer` | [`ClosestPoint`] and the rule of ties |
//! | `distance` | the distance to a box, and how far a search reaches |
//! | `foot` | the nearest point of a triangle, in f32 for the walks and in f64 for the sign |
//! | `triangle` | a flattened triangle's answer to a query |
//! | `collect`, `visitor` | what is kept of what a walk meets |
//! | `catalogue` | which walk answers which search |
//! | `single`, `batch` | the methods of [`crate::Bvh`] |
//! | `signed` | [`SignedDistance`]: inside and outside of a closed surface |
//!
//! **One answer.** The smaller distance wins, at equal distance the smaller `(instance, geometry, primitive)`, and
//! every tree and walk gives the same bits. That is a theorem in floating point, as for rays: the squared distance to
//! a box is made of operations that rounding keeps monotone, so a box that contains another is never farther; a
//! triangle's squared distance is raised to at least that of its own box; and culling is closed. So no ancestor of the
//! nearest triangle is farther than the triangle, and none is culled before the triangle has been met.
//!
//! **Spatial splits** put a triangle into several leaves, of which each box holds a part of it only. The theorem fails
//! there: rounding may bring the whole triangle nearer than the box of the part in which its nearest point lies. So a
//! search over such a tree reaches a little farther than its limit, by a bound of that rounding (see `visitor`); what
//! lies beyond the limit is still not an answer.

mod answer;
mod batch;
pub mod catalogue;
mod collect;
mod distance;
mod foot;
mod query;
mod signed;
mod single;
mod triangle;
mod visitor;

pub use answer::{ClosestPoint, NearestLists, PointAnswers};
pub use catalogue::PointSearch;
pub use collect::{CollectPoints, KeepClosest, KeepNearest};
pub use distance::{box_distance_squared, reach};
pub use query::{LARGEST_POINT, PointQuery, PreparedPoint};
pub use signed::{Feature, SignedDistance, SurfaceError, SurfacePoint};
pub use visitor::{PointVisitor, SLACK_SHARE};
