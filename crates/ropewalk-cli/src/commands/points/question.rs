//! What `ropewalk points` can be asked: the point queries of the catalogue, and the side of a closed surface.
//!
//! The side is found by the stack walk over a binary tree on the CPU, in f64, and knows no largest distance: see
//! [`ropewalk::SignedDistance`]. Both kinds stand in one list here, for the command line and for `ropewalk list`.

use ropewalk::catalogue::StructureKind;
use ropewalk::point::catalogue;
use ropewalk::{CatalogueError, DeviceKind, PointSearch, Walk};
use ropewalk_gpu::Tracer;
use std::fmt;
use std::str::FromStr;

/// What is asked of each point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Question {
    /// A search of the catalogue of points.
    Search(PointSearch),
    /// The distance to a closed surface, negative inside.
    SignedDistance,
    /// Whether it is inside of a closed surface.
    Inside,
}

impl Question {
    /// Every question.
    pub(crate) const EVERY: [Self; 4] = [
        Self::Search(PointSearch::Closest),
        Self::Search(PointSearch::Nearest),
        Self::SignedDistance,
        Self::Inside,
    ];

    /// The name on the command line.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Search(search) => search.name(),
            Self::SignedDistance => "signed-distance",
            Self::Inside => "inside",
        }
    }

    /// Whether it needs a closed surface.
    pub(crate) const fn needs_inside(self) -> bool {
        matches!(self, Self::SignedDistance | Self::Inside)
    }

    /// Refuses what does not answer the question for at most `k` triangles a point, and says what does.
    pub(crate) fn check(
        self,
        structure: StructureKind,
        walk: Walk,
        device: DeviceKind,
        k: usize,
    ) -> Result<(), CatalogueError> {
        if let Self::Search(search) = self {
            catalogue::check(structure, walk, search, device)?;
            let most = Tracer::MOST_NEAREST;
            return if device == DeviceKind::Gpu && k > most {
                Err(CatalogueError(format!(
                    "--k is {k}; on the {device} '{self}' finds at most {most}: try --device cpu"
                )))
            } else {
                Ok(())
            };
        }
        let (bvh, cpu, stack) = (StructureKind::Bvh, DeviceKind::Cpu, Walk::default());
        if (structure, walk, device) == (bvh, stack, cpu) {
            return Ok(());
        }
        Err(CatalogueError(format!(
            "the walk '{walk}' of the structure '{structure}' does not answer '{self}' on the {device}; the walk \
             '{stack}' of the structure '{bvh}' does on the {cpu}"
        )))
    }
}

impl Default for Question {
    fn default() -> Self {
        Self::Search(PointSearch::Closest)
    }
}

impl fmt::Display for Question {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for Question {
    type Err = CatalogueError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::EVERY.into_iter().find(|question| question.name() == text).ok_or_else(|| {
            let names = Self::EVERY.map(Self::name).join(", ");
            CatalogueError(format!("there is no point query '{text}'; there is {names}"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_search_is_a_question_and_every_name_is_read_back() {
        for search in PointSearch::EVERY {
            assert!(Question::EVERY.contains(&Question::Search(search)), "{search}");
        }
        for question in Question::EVERY {
            assert_eq!(question.to_string().parse(), Ok(question));
            assert!(question.check(StructureKind::Bvh, Walk::default(), DeviceKind::Cpu, 1).is_ok());
        }
        let told = "closest".parse::<Question>().unwrap_err().to_string();
        assert!(told.contains("closest-point, k-nearest, signed-distance, inside"), "{told}");
    }

    #[test]
    fn a_wrong_combination_is_answered_with_the_right_one() {
        let (bvh, wide, stack) = (StructureKind::Bvh, StructureKind::WideBvh, Walk::default());
        for (structure, walk, device) in [
            (wide, stack, DeviceKind::Cpu),
            (bvh, Walk::BruteForce, DeviceKind::Cpu),
            (bvh, stack, DeviceKind::Gpu),
        ] {
            for question in [Question::SignedDistance, Question::Inside] {
                let told = question.check(structure, walk, device, 1).unwrap_err().to_string();
                assert!(told.contains(question.name()), "{told}");
                assert!(
                    told.ends_with("'stack:order=ordered' of the structure 'bvh' does on the cpu"),
                    "{told}"
                );
            }
        }
        for search in PointSearch::EVERY {
            let told = Question::Search(search).check(wide, stack, DeviceKind::Cpu, 1).unwrap_err();
            let told = told.to_string();
            assert!(told.contains(search.name()) && told.contains("'bvh'"), "{told}");
        }
    }
    #[test]
    fn longer_lists_than_a_graphics_card_keeps_are_refused_there_alone() {
        let nearest = Question::Search(PointSearch::Nearest);
        let check = |device, k| nearest.check(StructureKind::Bvh, Walk::default(), device, k);
        assert!(check(DeviceKind::Cpu, usize::MAX).is_ok());
        assert!(check(DeviceKind::Gpu, Tracer::MOST_NEAREST).is_ok());
        let told = check(DeviceKind::Gpu, Tracer::MOST_NEAREST + 1).unwrap_err().to_string();
        assert!(told.contains("at most 32: try --device cpu"), "{told}");
    }
}
