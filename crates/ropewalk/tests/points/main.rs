//! Point queries: every walk and builder against an oracle in f64 and to the bit against each other, the restart trail
//! event by event, the sign of the distance against rays, and a scanned model.

mod conformance;
mod edges;
mod scanned;
mod signed;
mod splits;
mod trail;
