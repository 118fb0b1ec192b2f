//! The comparator: two pictures are the same when every bit of their films is, and every count of what was done.

use ropewalk_render::{Film, Layers, Picture, Statistics};

/// Says in what two pictures differ; nothing where they are the same.
pub(crate) fn difference(one: &Picture, other: &Picture) -> Result<(), String> {
    films(&one.film, &other.film)?;
    if one.camera != other.camera {
        return Err(format!("cameras: {:?} and {:?}", one.camera, other.camera));
    }
    for ((name, a), (_, b)) in counts(&one.statistics).into_iter().zip(counts(&other.statistics)) {
        if a != b {
            return Err(format!("{name}: {a} and {b}"));
        }
    }
    Ok(())
}

/// Says in what two films differ.
pub(crate) fn films(one: &Film, other: &Film) -> Result<(), String> {
    if (one.width, one.height) != (other.width, other.height) {
        return Err(format!("{}x{} and {}x{}", one.width, one.height, other.width, other.height));
    }
    plane("colours", one, &words(&one.color), &words(&other.color))?;
    plane("depths", one, &one.depth, &other.depth)?;
    plane("coverage", one, &one.coverage, &other.coverage)?;
    match (&one.layers, &other.layers) {
        (None, None) => Ok(()),
        (Some(a), Some(b)) => layers(one, a, b),
        _ => Err("one has layers and one has none".into()),
    }
}

fn layers(film: &Film, one: &Layers, other: &Layers) -> Result<(), String> {
    plane("albedo", film, &words(&one.albedo), &words(&other.albedo))?;
    plane("normals", film, &words(&one.normal), &words(&other.normal))?;
    match one.ids.iter().zip(&other.ids).position(|(a, b)| a != b) {
        Some(pixel) => Err(format!("ids at {:?}", place(film, pixel))),
        None if one.ids.len() == other.ids.len() => Ok(()),
        None => Err("as many ids as the other".into()),
    }
}

fn words(colors: &[[f32; 3]]) -> Vec<f32> {
    colors.iter().flatten().copied().collect()
}

fn place(film: &Film, pixel: usize) -> (usize, usize) {
    (pixel % film.width as usize, pixel / film.width as usize)
}

fn plane(name: &str, film: &Film, one: &[f32], other: &[f32]) -> Result<(), String> {
    let pixels = film.pixels().max(1);
    if one.len() != other.len() {
        return Err(format!("{name}: {} and {} numbers", one.len(), other.len()));
    }
    let differs = |index: &usize| one[*index].to_bits() != other[*index].to_bits();
    let different: Vec<usize> = (0..one.len()).filter(differs).collect();
    let Some(&first) = different.first() else { return Ok(()) };
    let each = one.len() / pixels;
    let largest = different.iter().map(|&index| (one[index] - other[index]).abs()).fold(0.0_f32, f32::max);
    Err(format!(
        "{name}: {} numbers differ, by {largest:e} at most, the first at {:?}: {:e} and {:e}",
        different.len(),
        place(film, first / each.max(1)),
        one[first],
        other[first]
    ))
}

/// Everything that is counted and does not depend on how fast it went.
fn counts(statistics: &Statistics) -> [(&'static str, u64); 13] {
    let Statistics { incomplete, .. } = statistics;
    [
        ("primary rays", statistics.primary_rays),
        ("shadow rays", statistics.shadow_rays),
        ("ambient rays", statistics.ambient_rays),
        ("reflected rays", statistics.reflected_rays),
        ("refracted rays", statistics.refracted_rays),
        ("scattered rays", statistics.scattered_rays),
        ("rays cut by depth", statistics.cut_by_depth),
        ("rays cut by weight", statistics.cut_by_weight),
        ("paths ended by chance", statistics.ended_by_chance),
        ("addends cut down", statistics.clipped),
        ("samples that are no numbers", statistics.not_finite),
        ("incomplete rays", incomplete.rays),
        ("hits that lead nowhere", incomplete.no_such_triangle),
    ]
}

/// A picture that is wrong in one bit, or in one count, is noticed, and what is wrong is named.
#[test]
fn a_wrong_picture_is_noticed() {
    let (stage, structure) = crate::Subject::cubes().at(None, crate::two_levels());
    let right = crate::render(&stage, structure.as_ref(), &crate::small());
    assert_eq!(difference(&right, &right.clone()), Ok(()));
    let flip = |value: &mut f32| *value = f32::from_bits(value.to_bits() ^ 1);
    let layers = |picture: &mut Picture, change: fn(&mut Layers)| {
        picture.film.layers.as_mut().map(change).expect("they were asked for");
    };
    type Damage<'a> = (&'static str, &'a dyn Fn(&mut Picture));
    let damages: [Damage<'_>; 13] = [
        ("colours", &|picture| flip(&mut picture.film.color[700][1])),
        ("colours", &|picture| picture.film.color[0][2] = f32::NAN),
        ("depths", &|picture| flip(&mut picture.film.depth[901])),
        ("coverage", &|picture| flip(&mut picture.film.coverage[3])),
        ("albedo", &|picture| layers(picture, |layers| layers.albedo[800][0] += 1e-3)),
        ("normals", &|picture| layers(picture, |layers| layers.normal[800][0] += 1e-3)),
        ("ids", &|picture| layers(picture, |layers| layers.ids[800][2] ^= 1)),
        ("layers", &|picture| picture.film.layers = None),
        ("shadow rays", &|picture| picture.statistics.shadow_rays += 1),
        ("rays cut by depth", &|picture| picture.statistics.cut_by_depth += 1),
        ("rays cut by weight", &|picture| picture.statistics.cut_by_weight += 1),
        ("incomplete rays", &|picture| picture.statistics.incomplete.rays += 1),
        ("36x48 and 48x36", &|picture| (picture.film.width, picture.film.height) = (36, 48)),
    ];
    for (what, damage) in damages {
        let mut wrong = right.clone();
        damage(&mut wrong);
        let told = difference(&wrong, &right).expect_err(what);
        assert!(told.contains(what), "{what}: {told}");
    }
}
