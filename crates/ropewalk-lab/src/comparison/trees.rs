//! Which trees are walked.

use ropewalk::{BuildOptions, Builder};

/// The trees of a comparison: each builder with each leaf cap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TreeSettings {
    /// What makes them.
    pub builders: Vec<Builder>,
    /// Their leaf caps.
    pub leaf_caps: Vec<u32>,
    /// Percent of references that the SBVH builder may add.
    pub duplication: u32,
}

impl Default for TreeSettings {
    /// Those of Laine 2010: with object splits alone and with spatial ones too.
    fn default() -> Self {
        Self {
            builders: vec![Builder::SweepSah, Builder::Sbvh],
            leaf_caps: vec![1, 4, 8],
            duplication: BuildOptions::default().duplication,
        }
    }
}

impl TreeSettings {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.builders.len() * self.leaf_caps.len()
    }

    /// How each is built.
    pub fn each(&self) -> impl Iterator<Item = BuildOptions> {
        let plain = BuildOptions { duplication: self.duplication, ..BuildOptions::default() };
        self.builders.iter().flat_map(move |&builder| {
            self.leaf_caps.iter().map(move |&max_leaf| BuildOptions { builder, max_leaf, ..plain })
        })
    }
}

/// A builder's name on the command line and in records.
pub(crate) fn builder_name(builder: Builder) -> &'static str {
    Builder::NAMES.iter().find(|(_, other)| *other == builder).map_or("", |(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_each_builder_with_each_cap() {
        let trees = TreeSettings { duplication: 7, ..TreeSettings::default() };
        let each: Vec<_> =
            trees.each().map(|options| (builder_name(options.builder), options.max_leaf)).collect();
        assert_eq!(each, [("sweep", 1), ("sweep", 4), ("sweep", 8), ("sbvh", 1), ("sbvh", 4), ("sbvh", 8)]);
        assert_eq!(each.len(), trees.count());
        assert!(trees.each().all(|options| options.duplication == 7));
    }
}
