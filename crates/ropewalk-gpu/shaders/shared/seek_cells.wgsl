// A ray as what goes through the cells of a kd-tree.
// Source: as shared/cells.
// Invariants: the same.

#import shared/cells
#import shared/kd_tree

alias Seeker = PreparedRay;
