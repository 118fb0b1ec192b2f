//! What the paper prints, beside which a scene's rows are put.

use super::Configuration;
use crate::two_level::PaperScene;

/// By how many times, at most, drawing primary hits is faster than tracing them (section 5.1).
pub(super) const DRAWING_GAIN: f64 = 6.0;

/// Frames a second of primary shading alone, which no structure takes part in.
const PRIMARY_SHADING: [(&str, f64); 4] =
    [("BART robots", 160.39), ("BART kitchen", 163.49), ("Chevy", 277.72), ("Chess", 303.30)];

/// The paper's frames a second for a scene that it has, or that stands for one of its: with one kd-tree, and with two levels.
pub(super) fn frames_per_second(scene: &str, configuration: Configuration) -> Option<[f64; 2]> {
    let paper = PaperScene::like(scene)?;
    let column = match configuration {
        Configuration::PrimaryShading => {
            let (_, frames) = PRIMARY_SHADING.into_iter().find(|(name, _)| *name == paper.scene)?;
            return Some([frames; 2]);
        }
        Configuration::ShadowOnly => 0,
        Configuration::ReflectOnly => 1,
        Configuration::FiveBounces => 2,
    };
    Some([paper.single_fps[column], paper.two_level_fps[column]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figures_are_those_of_table_2() {
        let of = |scene: &str| Configuration::EVERY.map(|it| frames_per_second(scene, it));
        assert_eq!(
            of("bart_robot/Robot.aff").map(Option::unwrap),
            [[160.39, 160.39], [15.26, 11.43], [7.86, 5.63], [1.56, 1.01]]
        );
        assert_eq!(
            of("chess34_fantasy.glb").map(Option::unwrap),
            [[303.30, 303.30], [59.19, 51.09], [35.42, 28.75], [10.53, 8.63]]
        );
        assert_eq!(of("builtin:assembly"), [None; 4]);
    }
}
