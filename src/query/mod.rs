//! Questions about where a mesh lies: rays, closest points, inside or outside, where it meets itself.

mod batch;
mod bvh;
mod cast;
mod closest;
mod contacts;
mod contains;
mod coplanar;
mod exact;
mod facet;
mod grow;
mod index;
mod intersections;
mod lanes;
mod mass;
mod nearest;
mod outward;
mod ray;
mod side;

pub use closest::{ClosestOptions, ClosestPoint, Nearest, QueryError};
pub use contains::{Side, SolidIndex};
pub use facet::Contact;
pub use index::{Feature, MeshIndex};
pub use intersections::{FacePair, SelfIntersectionOptions, SelfIntersections};
pub use mass::MassProperties;
pub use outward::{OutwardError, OutwardOptions, OutwardPart, TurnedOutward, orient_outward};
pub use ray::{Crossing, Ray, RayError, RayHit};

pub(crate) use nearest::segment_foot;
