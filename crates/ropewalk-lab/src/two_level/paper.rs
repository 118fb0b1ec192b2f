//! What Reichl et al. 2010 print: a GeForce GTX 275, pictures of 512 by 512 pixels.
//!
//! The paper's figures are numbered across (ALGORITHMS: C7), and the captions give the robots 110,000 triangles and the kitchen
//! 71,000, while the files of the benchmark have 71,708 and 110,561. Of the kitchen the paper has six objects.

/// A scene of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperScene {
    /// Its name.
    pub scene: &'static str,
    /// Objects.
    pub objects: usize,
    /// Table 1, for primary rays: average, maximum and variance of the deepest stack of the BVH.
    pub bvh_depth: [f64; 3],
    /// The same of the kd-trees.
    pub kd_depth: [f64; 3],
    /// Kd-trees that a shadow ray enters, on the average.
    pub objects_entered: Option<f64>,
    /// Table 2: frames a second with one kd-tree, for shadow rays, reflections, and five bounces with shadows.
    pub single_fps: [f64; 3],
    /// The same with two levels.
    pub two_level_fps: [f64; 3],
}

/// Tables 1 and 2, and what the text says of shadow rays.
pub const PAPER: [PaperScene; 4] = [
    PaperScene {
        scene: "BART robots",
        objects: 162,
        bvh_depth: [1.0, 6.0, 1.33],
        kd_depth: [1.4, 7.0, 1.9],
        objects_entered: Some(1.3),
        single_fps: [15.26, 7.86, 1.56],
        two_level_fps: [11.43, 5.63, 1.01],
    },
    PaperScene {
        scene: "BART kitchen",
        objects: 6,
        bvh_depth: [0.01, 1.0, 0.01],
        kd_depth: [3.63, 10.0, 1.14],
        objects_entered: None,
        single_fps: [15.21, 16.92, 3.36],
        two_level_fps: [16.53, 18.06, 3.63],
    },
    PaperScene {
        scene: "Chevy",
        objects: 79,
        bvh_depth: [0.72, 5.0, 1.1],
        kd_depth: [0.22, 5.0, 0.37],
        objects_entered: Some(3.44),
        single_fps: [72.38, 68.03, 34.55],
        two_level_fps: [30.45, 34.34, 14.72],
    },
    PaperScene {
        scene: "Chess",
        objects: 34,
        bvh_depth: [0.27, 2.0, 0.39],
        kd_depth: [1.53, 6.0, 1.02],
        objects_entered: None,
        single_fps: [59.19, 35.42, 10.53],
        two_level_fps: [51.09, 28.75, 8.63],
    },
];

/// The milliseconds of a rebuild of the top level over 1,000 objects.
pub(super) const REBUILD_1000_MS: f64 = 9.8;

impl PaperScene {
    /// The paper's scene that a scene is or stands for, by its file's name: the robots and the kitchen of BART, chess sets of 34
    /// objects, and cars for the Chevy, which is not to be had.
    #[must_use]
    pub fn like(scene: &str) -> Option<&'static Self> {
        let file = scene.rsplit(['/', '\\']).next().unwrap_or_default().to_ascii_lowercase();
        let stem = file.split('.').next().unwrap_or_default();
        let name = match stem {
            "robot" | "robots" => "BART robots",
            "kitchen" => "BART kitchen",
            _ if stem.starts_with("chess") => "Chess",
            _ if stem == "car" || stem.starts_with("car_") || stem.starts_with("vintage_car") => "Chevy",
            _ => return None,
        };
        PAPER.iter().find(|scene| scene.scene == name)
    }

    /// The speed of two levels over that of one kd-tree: shadow rays, reflections, five bounces with shadows.
    #[must_use]
    pub fn speed_ratios(&self) -> [f64; 3] {
        std::array::from_fn(|place| self.two_level_fps[place] / self.single_fps[place])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ratios that ALGORITHMS 3.2 works out.
    #[test]
    fn the_ratios_are_those_of_table_2() {
        let percent = [[74.9, 71.6, 64.7], [108.7, 106.7, 108.0], [42.1, 50.5, 42.6], [86.3, 81.2, 82.0]];
        for (scene, percent) in PAPER.iter().zip(percent) {
            for (ratio, percent) in scene.speed_ratios().iter().zip(percent) {
                assert!((100.0 * ratio - percent).abs() < 0.06, "{scene:?}");
            }
        }
    }

    #[test]
    fn scenes_are_known_by_their_files() {
        let like = |name: &str| PaperScene::like(name).map(|scene| scene.objects);
        assert_eq!(like("bart_robot/Robot.aff"), Some(162));
        assert_eq!(like("C:\\bart\\kitchen.aff.gz"), Some(6));
        assert_eq!(like("chess34_fantasy.glb"), Some(34));
        assert_eq!(like("car_ldraw_instanced.glb"), Some(79));
        assert_eq!(like("builtin:assembly"), None);
        assert_eq!(like("carpet.obj"), None);
        assert_eq!(like(""), None);
    }
}
