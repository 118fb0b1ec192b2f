//! Cameras: which one is chosen, and how it is found.
//!
//! [`pinhole`](self) turns a [`Camera`] into rays, `framing` finds the place from which everything is seen,
//! `inside` a good place within a building, `choice` reads what the user wrote.

mod choice;
mod framing;
mod inside;
mod pinhole;

pub use choice::CameraChoice;
pub use framing::Framing;
pub(crate) use framing::frame;
pub(crate) use pinhole::Pinhole;

use crate::error::RenderError;
use crate::stage::Stage;
use crate::trace::Trace;
use ropewalk::Walk;
use ropewalk_scene::Camera;

/// The vertical field of view where none is asked for: long enough that parallel edges stay nearly parallel.
pub(crate) const DEFAULT_FOV_DEGREES: f32 = 30.0;
/// Degrees that the automatic camera stands to the right of the front.
pub(crate) const DEFAULT_AZIMUTH_DEGREES: f32 = 32.0;
/// Degrees that the automatic camera stands above the horizon.
pub(crate) const DEFAULT_ELEVATION_DEGREES: f32 = 22.0;
/// Indoors the view is wider, as in photographs of rooms.
const INSIDE_FOV_DEGREES: f32 = 62.0;

/// Finds the camera that was chosen.
///
/// # Errors
/// When the file has no such camera, or numbers make none.
pub fn resolve(
    choice: &CameraChoice,
    stage: &Stage,
    tracer: &dyn Trace,
    walk: Walk,
    aspect: f32,
) -> Result<Camera, RenderError> {
    match choice {
        CameraChoice::Automatic => match stage.model().cameras.first() {
            Some(camera) => Ok(camera.clone()),
            None => Ok(frame(stage, &Framing::default(), aspect)),
        },
        CameraChoice::Frame(framing) => Ok(frame(stage, framing, aspect)),
        CameraChoice::Inside { vertical_fov } => {
            inside::inside(stage, tracer, walk, vertical_fov.unwrap_or(INSIDE_FOV_DEGREES.to_radians()))
        }
        CameraChoice::Look { eye, target, up, vertical_fov } => Ok(Camera {
            name: "look".into(),
            position: *eye,
            forward: *target - *eye,
            up: up.unwrap_or(stage.up()),
            vertical_fov: vertical_fov.unwrap_or(DEFAULT_FOV_DEGREES.to_radians()),
        }),
        CameraChoice::OfFile(name) => of_file(name, &stage.model().cameras),
    }
}

/// By name; where no camera has the name, by its number from 0.
fn of_file(wanted: &str, cameras: &[Camera]) -> Result<Camera, RenderError> {
    let by_name = cameras.iter().find(|camera| camera.name == wanted);
    let by_index = || cameras.get(wanted.parse::<usize>().ok()?);
    by_name.or_else(by_index).cloned().ok_or_else(|| {
        let listed = cameras.iter().enumerate().take(20).map(|(index, camera)| {
            if camera.name.is_empty() { index.to_string() } else { format!("{index} '{}'", camera.name) }
        });
        let known = match cameras.len() {
            0 => "the scene has no cameras of its own".into(),
            count if count > 20 => format!("the scene has {count}, the first are {}", join(listed)),
            _ => format!("the scene has {}", join(listed)),
        };
        RenderError::Camera(format!("there is no camera '{wanted}': {known}; {}", CameraChoice::FORMS))
    })
}

fn join(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn camera(name: &str) -> Camera {
        Camera { name: name.into(), position: Vec3::ZERO, forward: Vec3::X, up: Vec3::Y, vertical_fov: 1.0 }
    }

    #[test]
    fn cameras_are_found_by_name_then_by_number() {
        let cameras = [camera("front"), camera("0"), camera("")];
        assert_eq!(of_file("front", &cameras).unwrap().name, "front");
        assert_eq!(of_file("0", &cameras).unwrap().name, "0", "a name goes before a number");
        assert_eq!(of_file("2", &cameras).unwrap().name, "");
        let text = of_file("back", &cameras).unwrap_err().to_string();
        assert!(
            text.contains("'back'") && text.contains("0 'front'") && text.contains("look:eye="),
            "{text}"
        );
        assert!(of_file("0", &[]).unwrap_err().to_string().contains("no cameras"));
    }
}
