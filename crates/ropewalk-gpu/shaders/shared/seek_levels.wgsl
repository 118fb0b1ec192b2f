// A ray as what goes through both levels: as it was asked, and prepared.
// Source: as shared/levels.
// Invariants: the one was made of the other.

#import shared/ray

struct Seeker {
    question: Ray,
    ray: PreparedRay,
}
