//! Whole scenes, small: what is the same picture by design is the same to the bit, on either device, in every order, at
//! several times of scenes that move.
//!
//! With `ROPEWALK_PICTURE_SCALE=4` pictures are four times as wide and as high: sixteen times as many rays, for a search that
//! takes minutes.
//!
//! | file | concept |
//! |---|---|
//! | `subject` | scenes at times, the structure, the adapter |
//! | `agreement` | the comparator |
//! | `trees` | trees of rays in all orders on both devices |
//! | `drawn` | drawn first hits against traced ones |
//! | `paths` | paths on both devices |
//! | `frames` | frames against pictures that are made anew |

mod agreement;
mod drawn;
mod frames;
mod paths;
mod subject;
mod trees;

use ropewalk_render::{Integrator, Kept, Picture, RenderSettings, Renderer, Stage, Trace};
use std::ops::ControlFlow;
use subject::{Subject, two_levels};

/// A small picture, or as large as was asked for.
fn settings() -> RenderSettings {
    let scale = std::env::var("ROPEWALK_PICTURE_SCALE").ok().and_then(|text| text.parse().ok()).unwrap_or(1);
    let small = small();
    RenderSettings { width: small.width * scale, height: small.height * scale, ..small }
}

/// A small picture of trees of five bounces, with all that a film can hold.
fn small() -> RenderSettings {
    RenderSettings {
        width: 48,
        height: 36,
        samples: 1,
        integrator: Integrator::RayTree,
        layers: true,
        ..RenderSettings::default()
    }
}

fn render(stage: &Stage, tracer: &dyn Trace, settings: &RenderSettings) -> Picture {
    Renderer::new(stage, tracer)
        .render(settings, &|_, _| ControlFlow::Continue(()))
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The same with what an earlier picture has left: an adapter's kernel is made once a scene.
fn render_keeping(stage: &Stage, tracer: &dyn Trace, settings: &RenderSettings, kept: &Kept) -> Picture {
    Renderer::new(stage, tracer)
        .keeping(kept)
        .render(settings, &|_, _| ControlFlow::Continue(()))
        .unwrap_or_else(|error| panic!("{error}"))
}
