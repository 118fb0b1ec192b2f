//! The render loop: runs of pixels, from the top left, each a batch of primary rays with all that follows.

use crate::brdf::Finish;
use crate::camera::{self, Pinhole};
use crate::error::RenderError;
use crate::expose::{expose, expose_layers};
use crate::film::Film;
use crate::follow::{Follower, Trees};
use crate::gpu::TreeKernel;
use crate::ground;
use crate::integrator::{Integrator, Primary, TreeOrder};
use crate::kept::{Kept, Tables};
use crate::light::Lights;
use crate::lights::Lighting;
use crate::path::PathTracer;
use crate::picture::Picture;
use crate::primary::{Eye, column_and_row};
use crate::raster::Drawing;
use crate::ray_tree::Request;
use crate::settings::RenderSettings;
use crate::shade::Shader;
use crate::stage::Stage;
use crate::statistics::Statistics;
use crate::trace::Trace;
use crate::tracing::Tracing;
use crate::view::{self, View};
use ropewalk::Ray;
use ropewalk_gpu::{GpuStructure, Traceable};
use ropewalk_scene::Camera;
use std::ops::ControlFlow;
use std::sync::OnceLock;
use std::time::Instant;

/// Primary rays in a batch: enough to keep a GPU busy, few enough that progress moves and that the places, about
/// 150 bytes each with their rays, take 20 MB whatever the picture's size.
const BATCH: usize = 1 << 17;

/// Renders pictures of a stage.
pub struct Renderer<'a> {
    stage: &'a Stage,
    tracer: &'a dyn Trace,
    /// The triangles, ready to be drawn, from the first picture on that wants them so.
    drawing: OnceLock<Drawing<'a>>,
    kept: Option<&'a Kept>,
    show: Option<Show<'a>>,
}

/// Is shown the film of a picture after each batch, and how many rows of it are finished.
pub type Show<'a> = &'a (dyn Fn(&Film, u32) + Sync);

impl<'a> Renderer<'a> {
    /// A renderer of `stage` on a device that holds the structure built over [`Stage::scene`].
    #[must_use]
    pub fn new(stage: &'a Stage, tracer: &'a dyn Trace) -> Self {
        Self { stage, tracer, drawing: OnceLock::new(), kept: None, show: None }
    }

    /// The same renderer, which takes over what an earlier one has left for this stage in another pose, and leaves its own.
    #[must_use]
    pub fn keeping(self, kept: &'a Kept) -> Self {
        Self { kept: Some(kept), ..self }
    }

    /// The same renderer, which shows the film while it is being exposed: for previews, and to save what is there now and then.
    /// Of views that are coloured in the end, such as depth, the film has no colours before.
    #[must_use]
    pub fn showing(self, show: Show<'a>) -> Self {
        Self { show: Some(show), ..self }
    }

    /// Renders one picture. `progress` is told, after each batch, how many rows are done and how many there are;
    /// `Break` ends the render and keeps what is finished.
    ///
    /// # Errors
    /// When a setting is out of range, the camera is not there, or the device fails.
    pub fn render(
        &self,
        settings: &RenderSettings,
        progress: &(dyn Fn(usize, usize) -> ControlFlow<()> + Sync),
    ) -> Result<Picture, RenderError> {
        settings.check()?;
        let (width, height) = (settings.width, settings.height);
        let aspect = (f64::from(width) / f64::from(height)) as f32;
        let camera = camera::resolve(&settings.camera, self.stage, self.tracer, settings.walk, aspect)?;
        let pinhole = self.pinhole(settings, &camera)?;
        let lights = Lights::new(self.stage, &camera, &settings.light, settings.samples == 1);
        let request = Request::new(self.stage, settings);
        let mut notes = self.notes(&lights);
        let mut tables = None;
        if self.needs_looks(settings) {
            let before = self.kept.and_then(Kept::take);
            let mut made = Tables::new(self.stage, &lights.words(), &request.words(), before)?;
            notes.extend(self.make_kernel(settings, &request, &lights, &mut made)?);
            tables = Some(made);
        }
        let looks = tables.as_ref().map(|tables| &tables.looks);
        let tracing = Tracing { tracer: self.tracer, walk: settings.walk, looks };
        let drawing = if settings.primary == Primary::Rasterised { Some(self.drawing()?) } else { None };
        let eye = Eye { pinhole, tracing, drawing };
        let follower = match &tables {
            _ if settings.view != View::Shaded => Follower::Data(self.stage),
            Some(tables) if settings.integrator != Integrator::Studio => Follower::Tree(Trees {
                looks: &tables.looks,
                lights: &lights,
                tracing,
                order: settings.tree.order,
                request,
                kernel: self.kernel(settings, tables),
                paths: (settings.integrator == Integrator::Path)
                    .then(|| PathTracer::new(self.stage, &lights, settings)),
            }),
            _ => Follower::Studio(self.shader(settings, &camera, tracing)),
        };
        let mut film = Film::new(width, height, settings.view == View::Visits)?;
        if settings.layers {
            film = film.with_layers()?;
        }
        let mut statistics = Statistics::default();
        let pixels = film.pixels();
        let run = (BATCH / settings.samples as usize).max(1);
        let (samples, ground) = (settings.samples as usize, self.stage.ground_instance());
        let mut done = 0;
        let mut partial = false;
        while done < pixels {
            let range = done..(done + run).min(pixels);
            let seen = eye.look(settings, range.clone(), &mut statistics)?;
            let colors = follower.colors(settings, &range, &seen, &mut statistics)?;
            let clock = Instant::now();
            expose(&mut film, range.clone(), samples, ground, &seen, &colors, &mut statistics);
            if settings.view == View::Shaded && settings.integrator == Integrator::Path && samples > 1 {
                for (pixel, colors) in range.clone().zip(colors.chunks_exact(samples)) {
                    statistics.noise.add(column_and_row(pixel, width as usize), colors);
                }
            }
            if let (Some(layers), Some(looks)) = (&mut film.layers, looks) {
                expose_layers(layers, looks, range.clone(), samples, ground, &seen);
            }
            statistics.shading_time += clock.elapsed();
            done = range.end;
            if let Some(show) = self.show.filter(|_| done < pixels) {
                show(&film, (done / width as usize) as u32);
            }
            if progress(done / width as usize, height as usize).is_break() && done < pixels {
                partial = true;
                break;
            }
        }
        drop(follower);
        if let (Some(kept), Some(tables)) = (self.kept, tables) {
            kept.put(tables);
        }
        let legend = view::colorize(settings.view, &mut film);
        notes.extend(statistics.notes(settings.integrator));
        Ok(Picture {
            film,
            view: settings.view,
            exposure: settings.exposure,
            camera,
            legend,
            statistics,
            finished_rows: (done / width as usize) as u32,
            partial,
            notes,
        })
    }

    fn pinhole(&self, settings: &RenderSettings, camera: &Camera) -> Result<Pinhole, RenderError> {
        let sees_ground = settings.view == View::Shaded
            && self.stage.catcher().is_some_and(|catcher| catcher.is_seen_from(camera.position));
        let mask = if sees_ground { Ray::ALL } else { Ray::ALL & !ground::MASK };
        Ok(Pinhole::new(camera, settings.width, settings.height)?.with_mask(mask))
    }

    /// Whether the tables for shading are wanted: by trees and paths, by layers, and where materials have holes.
    fn needs_looks(&self, settings: &RenderSettings) -> bool {
        let follows = settings.view == View::Shaded && settings.integrator != Integrator::Studio;
        follows
            || settings.layers
            || self.stage.model().materials.iter().any(|material| material.alpha_cutoff > 0.0)
    }

    /// Makes the kernel for trees ready where one is wanted. Returns a note where another order takes its place.
    fn make_kernel(
        &self,
        settings: &RenderSettings,
        request: &Request,
        lights: &Lights,
        tables: &mut Tables,
    ) -> Result<Option<String>, RenderError> {
        let order = settings.tree.order;
        let Some((tracer, _)) = self.tracer.traceable().and_then(Traceable::on_gpu) else { return Ok(None) };
        if settings.view != View::Shaded || settings.integrator != Integrator::RayTree {
            return Ok(None);
        }
        if order == TreeOrder::Recursive {
            return Err(RenderError::Setting {
                setting: "the order of rays",
                value: order.to_string(),
                wanted: "a graphics adapter does not trace rays one by one; take auto, stack or wavefront, or the \
                         device cpu",
            });
        }
        let most_waiting = request.most_waiting(lights.sources.len());
        let is_large_enough = |kernel: &TreeKernel| kernel.most_waiting() >= most_waiting;
        if order == TreeOrder::Wavefront || tables.kernel.as_ref().is_some_and(is_large_enough) {
            return Ok(None);
        }
        match TreeKernel::new(tracer, &tables.looks, most_waiting) {
            Ok(kernel) => tables.kernel = Some(kernel),
            Err(error) if order == TreeOrder::Auto => {
                return Ok(Some(format!(
                    "rays are followed in waves, since there is no kernel for trees: {error}"
                )));
            }
            Err(error) => return Err(error),
        }
        Ok(None)
    }

    /// The kernel for trees, and the structure on its device, where they are wanted.
    fn kernel<'b>(
        &'b self,
        settings: &RenderSettings,
        tables: &'b Tables,
    ) -> Option<(&'b TreeKernel, &'b GpuStructure)> {
        let is_wanted =
            settings.integrator == Integrator::RayTree && settings.tree.order != TreeOrder::Wavefront;
        let kernel = tables.kernel.as_ref().filter(|_| is_wanted)?;
        let (_, structure) = self.tracer.traceable().and_then(Traceable::on_gpu)?;
        Some((kernel, structure))
    }

    /// The triangles, ready to be drawn.
    fn drawing(&self) -> Result<&Drawing<'a>, RenderError> {
        if let Some(drawing) = self.drawing.get() {
            return Ok(drawing);
        }
        let drawing = Drawing::new(self.tracer)?;
        Ok(self.drawing.get_or_init(|| drawing))
    }

    fn shader<'b>(&'b self, settings: &RenderSettings, camera: &Camera, tracing: Tracing<'b>) -> Shader<'b> {
        Shader {
            stage: self.stage,
            tracing,
            lighting: Lighting::new(self.stage, camera, &settings.light, settings.samples == 1),
            finishes: self.stage.model().materials.iter().map(Finish::new).collect(),
            samples: settings.samples,
            ambient_rays_per_sample: settings.ambient_rays_per_sample(),
        }
    }

    fn notes(&self, lights: &Lights) -> Vec<String> {
        let mut notes = Vec::new();
        if self.stage.bounds().is_empty() {
            notes.push("the scene has no triangle that can be seen: the picture shows the background".into());
        }
        if lights.left_out > 0 {
            let count = lights.left_out;
            notes
                .push(format!("{count} lights of the file give no light or are no numbers and are left out"));
        }
        notes
    }
}

impl Statistics {
    /// What a user must not overlook.
    fn notes(&self, integrator: Integrator) -> impl Iterator<Item = String> {
        let incomplete = (!self.incomplete.is_none())
            .then(|| format!("{}; what they were to show is magenta", self.incomplete));
        let count = self.cut_by_depth;
        let too_deep = (count > 0).then(|| match integrator {
            Integrator::Path => {
                format!(
                    "{count} paths ended after the bounces that were asked for; what more would bring is missing"
                )
            }
            Integrator::Studio | Integrator::RayTree => format!(
                "{count} mirrored or refracted rays would have gone deeper than the bounces that were asked for; the \
                 surroundings stand in their place"
            ),
        });
        let clipped = (self.clipped > 0)
            .then(|| format!("{} times light was cut down that would speckle the picture", self.clipped));
        incomplete.into_iter().chain(too_deep).chain(clipped)
    }
}
