//! What the machine is made of. The colours are linear, and light enough to read well without reflections.

use super::super::stage::material;
use crate::Material;

macro_rules! palette {
    ($($constant:ident $index:literal $name:literal $color:expr, $roughness:literal, $metallic:literal;)*) => {
        $(pub(crate) const $constant: u32 = $index;)*

        /// The materials, in the order of their constants.
        pub(crate) fn materials() -> Vec<Material> {
            vec![$(material($name, $color, $roughness, $metallic)),*]
        }

        #[test]
        fn every_constant_is_the_index_of_its_material() {
            let materials = materials();
            $(assert_eq!(materials[$constant as usize].name, $name);)*
        }
    };
}

palette! {
    GROUND      0 "ground"          [0.52, 0.51, 0.49], 1.0,  0.0;
    PAINT       1 "painted casting" [0.055, 0.20, 0.245], 0.55, 0.0;
    CUT         2 "cut face"        [0.72, 0.14, 0.035], 0.7,  0.0;
    STEEL       3 "brushed steel"   [0.39, 0.41, 0.43], 0.35, 1.0;
    BRIGHT      4 "ground steel"    [0.58, 0.59, 0.60], 0.15, 1.0;
    DARK        5 "dark steel"      [0.17, 0.18, 0.20], 0.45, 1.0;
    BRONZE      6 "bronze"          [0.62, 0.35, 0.12], 0.35, 1.0;
    BRASS       7 "brass"           [0.76, 0.54, 0.18], 0.3,  1.0;
    BLUED       8 "blued steel"     [0.075, 0.095, 0.15], 0.35, 1.0;
    ZINC        9 "zinc"            [0.66, 0.65, 0.58], 0.4,  1.0;
    RUBBER      10 "rubber"         [0.035, 0.035, 0.037], 0.9, 0.0;
    RED         11 "red lacquer"    [0.62, 0.035, 0.025], 0.4, 0.0;
    GLASS       12 "oil behind glass" [0.36, 0.22, 0.03], 0.05, 0.0;
}
