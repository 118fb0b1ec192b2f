//! From the body of a PLY file to a model of one object.

use super::body::{Body, NO_VERTEX};
use crate::load::placement::Placement;
use crate::load::polygon::Cutter;
use crate::{CornerAttribute, LoadReport, Material, Model, Surface};
use glam::DVec3;
use ropewalk::{Mesh, Transform};

/// Makes the model; one without triangles has no object.
pub(super) fn assemble(body: Body) -> Model {
    let mut report = LoadReport { vertices: body.positions.len(), ..LoadReport::default() };
    let mut triangles = Vec::with_capacity(body.polygons.item_count() / 3);
    cut_polygons(&body, &mut triangles, &mut report);
    unroll_strips(&body, &mut triangles, &mut report);
    if !body.passed_over.is_empty() {
        report.notes.push(not_read(&body.passed_over));
    }
    let mut model = Model { report, ..Model::default() };
    if triangles.is_empty() {
        return model;
    }
    let corners = triangles.iter().flatten();
    let placement = Placement::of(corners.filter_map(|&index| body.positions.get(index as usize).copied()));
    let positions = body.positions.into_iter().map(|position| placement.place(position)).collect();
    model.scene.origin = placement.origin;
    let object = model.scene.add_object(Mesh::new(positions, triangles));
    model.scene.add_instance(object, Transform::IDENTITY);
    model.object_names.push(String::new());
    model.materials.push(Material::default());
    model.surfaces.push(vec![Surface {
        normals: per_vertex(body.normals),
        texture_coordinates: per_vertex(body.texture_coordinates),
        ..Surface::default()
    }]);
    model
}

fn per_vertex<T>(values: Vec<T>) -> Option<CornerAttribute<T>> {
    (!values.is_empty()).then_some(CornerAttribute { values, indices: None })
}

fn not_read(names: &[String]) -> String {
    const MOST: usize = 12;
    let more = if names.len() > MOST { ", ..." } else { "" };
    format!("not read: {}{more}", names.get(..MOST).unwrap_or(names).join(", "))
}

fn cut_polygons(body: &Body, triangles: &mut Vec<[u32; 3]>, report: &mut LoadReport) {
    let mut cutter = Cutter::new();
    let mut polygon: Vec<DVec3> = Vec::new();
    let mut guesses = 0;
    let mut first_guess = 0;
    for (face, corners) in body.polygons.iter().enumerate() {
        let place = || format!("face {face}, counted from 0");
        if corners.len() < 3 {
            report.skip("faces with fewer than three vertices", place);
            continue;
        }
        polygon.clear();
        polygon.extend(corners.iter().map_while(|&index| body.positions.get(index as usize).copied()));
        if polygon.len() < corners.len() {
            report.skip("faces that name a vertex that is not there", place);
            continue;
        }
        if let [a, b, c] = *corners {
            triangles.push([a, b, c]);
            continue;
        }
        let pieces = cutter.cut(&polygon);
        if pieces.is_guess {
            guesses += 1;
            if guesses == 1 {
                first_guess = face;
            }
        }
        triangles.extend(pieces.triangles.iter().map(|piece| piece.map(|corner| corners[corner as usize])));
    }
    if guesses > 0 {
        report.notes.push(format!(
            "{guesses} polygons cross themselves or are too long and were cut into fans; the first is face {first_guess}"
        ));
    }
}

/// Every other triangle of a strip is turned. Triangles with a vertex twice only lead from one part of a strip to the
/// next.
fn unroll_strips(body: &Body, triangles: &mut Vec<[u32; 3]>, report: &mut LoadReport) {
    for (index, strip) in body.strips.iter().enumerate() {
        for part in strip.split(|&vertex| vertex == NO_VERTEX) {
            for (step, window) in part.windows(3).enumerate() {
                let &[a, b, c] = window else { continue };
                if a == b || b == c || a == c {
                    continue;
                }
                if window.iter().any(|&vertex| vertex as usize >= body.positions.len()) {
                    let what = "triangles of strips that name a vertex that is not there";
                    report.skip(what, || format!("strip {index}, counted from 0"));
                    continue;
                }
                triangles.push(if step % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
    }
}
