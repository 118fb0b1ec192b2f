//! The body of a PLY file: vertices, polygons and strips; the rest is passed over.

use super::header::{Element, Header, Kind, Property};
use super::values::Values;
use crate::LoadError;
use glam::{DVec2, DVec3, Vec2, Vec3};

/// An index that is not there.
pub(super) const NO_VERTEX: u32 = u32::MAX;

/// What the body holds.
#[derive(Debug, Default)]
pub(super) struct Body {
    pub(super) positions: Vec<DVec3>,
    /// One a vertex, or none at all.
    pub(super) normals: Vec<Vec3>,
    /// One a vertex, or none at all.
    pub(super) texture_coordinates: Vec<Vec2>,
    pub(super) polygons: Lists,
    pub(super) strips: Lists,
    /// What was passed over, such as `vertex.red`.
    pub(super) passed_over: Vec<String>,
}

/// Lists of vertices, one after the other.
#[derive(Debug, Default)]
pub(super) struct Lists {
    /// [`NO_VERTEX`] for what cannot be one.
    items: Vec<u32>,
    ends: Vec<usize>,
}

impl Lists {
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let mut start = 0;
        self.ends.iter().map(move |&end| {
            let list = self.items.get(start..end).unwrap_or_default();
            start = end;
            list
        })
    }

    pub(super) fn item_count(&self) -> usize {
        self.items.len()
    }
}

/// Reads all elements.
pub(super) fn read(header: &Header, values: &mut impl Values) -> Result<Body, LoadError> {
    let mut body = Body::default();
    let mut has_vertices = false;
    for element in &header.elements {
        values.check_count(element)?;
        match element.name.as_str() {
            "vertex" if !has_vertices => {
                has_vertices = true;
                read_vertices(element, values, &mut body)?;
            }
            "face" => read_lists(element, values, |body| &mut body.polygons, &mut body)?,
            "tristrips" => read_lists(element, values, |body| &mut body.strips, &mut body)?,
            name => {
                body.passed_over.push(name.into());
                pass_over(element, values)?;
            }
        }
    }
    Ok(body)
}

/// Where the values of a vertex go: position 0 to 2, normal 3 to 5, texture coordinate 6 and 7.
const NAMES: [&[&str]; 8] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["s", "u", "texture_u", "texture_s"],
    &["t", "v", "texture_v", "texture_t"],
];

fn read_vertices(element: &Element, values: &mut impl Values, body: &mut Body) -> Result<(), LoadError> {
    let slot_of = |property: &Property| match property.kind {
        Kind::One(_) => NAMES.iter().position(|names| names.contains(&property.name.as_str())),
        Kind::List { .. } => None,
    };
    let mut found = [false; NAMES.len()];
    let mut columns = Vec::with_capacity(element.properties.len());
    for property in &element.properties {
        // Of two properties with one meaning the first counts.
        let slot = slot_of(property).filter(|&slot| !std::mem::replace(&mut found[slot], true));
        if slot.is_none() {
            body.passed_over.push(format!("vertex.{}", property.name));
        }
        columns.push((property.kind, slot));
    }
    if element.count == 0 {
        return Ok(());
    }
    if let Some(missing) = (0..3).find(|&slot| !found[slot]) {
        return Err(values.wrong(format!("the vertices have no property '{}'", NAMES[missing][0])));
    }
    if element.count > u64::from(NO_VERTEX) {
        return Err(values.wrong(format!("{} vertices are more than 32 bits can number", element.count)));
    }
    let has_normals = found[3..6].iter().all(|&found| found);
    let has_texture_coordinates = found[6..].iter().all(|&found| found);
    let count = element.count as usize;
    body.positions.reserve(count);
    for _ in 0..count {
        let mut row = [0.0; NAMES.len()];
        for &(kind, slot) in &columns {
            match (kind, slot) {
                (Kind::One(scalar), Some(slot)) => row[slot] = values.number(scalar)?,
                (kind, _) => pass_over_property(kind, values)?,
            }
        }
        values.end_element()?;
        let [x, y, z, nx, ny, nz, s, t] = row;
        body.positions.push(DVec3::new(x, y, z));
        if has_normals {
            body.normals.push(DVec3::new(nx, ny, nz).as_vec3());
        }
        if has_texture_coordinates {
            body.texture_coordinates.push(DVec2::new(s, t).as_vec2());
        }
    }
    Ok(())
}

fn read_lists(
    element: &Element,
    values: &mut impl Values,
    lists_of: fn(&mut Body) -> &mut Lists,
    body: &mut Body,
) -> Result<(), LoadError> {
    let is_list = |property: &Property| {
        matches!(property.kind, Kind::List { .. })
            && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
    };
    let Some(list_at) = element.properties.iter().position(is_list) else {
        body.passed_over.push(format!("{} without vertex_indices", element.name));
        return pass_over(element, values);
    };
    for (at, property) in element.properties.iter().enumerate() {
        if at != list_at {
            body.passed_over.push(format!("{}.{}", element.name, property.name));
        }
    }
    let lists = lists_of(body);
    // The count was checked: a list takes at least one byte.
    lists.ends.reserve(usize::try_from(element.count).unwrap_or(0));
    for _ in 0..element.count {
        for (at, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List { length, item } if at == list_at => {
                    for _ in 0..values.list_length(length, item)? {
                        let index = values.integer(item)?;
                        lists.items.push(u32::try_from(index).unwrap_or(NO_VERTEX));
                    }
                }
                kind => pass_over_property(kind, values)?,
            }
        }
        lists.ends.push(lists.items.len());
        values.end_element()?;
    }
    Ok(())
}

fn pass_over(element: &Element, values: &mut impl Values) -> Result<(), LoadError> {
    // Elements of nothing may be promised without end.
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            pass_over_property(property.kind, values)?;
        }
        values.end_element()?;
    }
    Ok(())
}

fn pass_over_property(kind: Kind, values: &mut impl Values) -> Result<(), LoadError> {
    match kind {
        Kind::One(scalar) => values.skip(scalar, 1),
        Kind::List { length, item } => {
            let length = values.list_length(length, item)?;
            values.skip(item, length)
        }
    }
}
