//! Which walks are judged on which structures, where not all pairs are.

use ropewalk::catalogue::Row;
use ropewalk::{StructureSpec, Walk};

/// The structures and the walks of some rows, in their order.
pub(super) struct Turns {
    structures: Vec<StructureSpec>,
    walks: Vec<Walk>,
    turns: usize,
}

impl Turns {
    /// With 1 turn every walk is judged on every structure.
    pub(super) fn new(rows: &[Row], turns: usize) -> Self {
        let mut all = Self { structures: Vec::new(), walks: Vec::new(), turns };
        for row in rows {
            if !all.structures.contains(&row.structure) {
                all.structures.push(row.structure);
            }
            if !all.walks.contains(&row.walk) {
                all.walks.push(row.walk);
            }
        }
        all
    }

    /// Each structure once.
    pub(super) fn structures(&self) -> impl Iterator<Item = StructureSpec> + '_ {
        self.structures.iter().copied()
    }

    /// Whether a row is to be judged in a case.
    pub(super) fn is_due(&self, row: &Row, case: usize) -> bool {
        let kind = row.structure.kind();
        let alike = || self.structures.iter().filter(|structure| structure.kind() == kind);
        // With more turns than structures a walk would miss cases.
        let turns = self.turns.min(alike().count()).max(1);
        let structure = alike().position(|structure| *structure == row.structure).unwrap_or(0);
        let walk = self.walks.iter().position(|walk| *walk == row.walk).unwrap_or(0);
        row.walk == kind.default_walk() || (case + structure + walk).is_multiple_of(turns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::catalogue;

    #[test]
    fn with_one_turn_all_is_due() {
        let rows = catalogue::rows();
        let turns = Turns::new(&rows, 1);
        assert!(rows.iter().all(|row| (0..5).all(|case| turns.is_due(row, case))));
    }

    #[test]
    fn in_turns_every_row_is_judged_and_every_walk_in_every_case() {
        let rows = catalogue::rows();
        let turns = Turns::new(&rows, 3);
        assert!(rows.iter().all(|row| (0..3).any(|case| turns.is_due(row, case))), "a row is never due");
        for row in &rows {
            let of_the_walk = |other: &&Row| {
                (other.structure.kind(), other.walk, other.query)
                    == (row.structure.kind(), row.walk, row.query)
            };
            for case in 0..7 {
                let due = rows.iter().filter(of_the_walk).any(|other| turns.is_due(other, case));
                assert!(due, "{row:?} in case {case}");
            }
        }
        let all = (0..30).flat_map(|case| rows.iter().map(move |row| (row, case)));
        let due = all.filter(|(row, case)| turns.is_due(row, *case)).count();
        assert!(due < 30 * rows.len() * 2 / 3, "{due} of {}", 30 * rows.len());
    }
}
