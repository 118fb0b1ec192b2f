//! Drawing by a graphics adapter: its rasteriser names the triangle of every pixel, and the ray is tested against that one.
//!
//! The corners go to the adapter once. For each sample of a pixel the picture is drawn once, so that the sample lies in
//! the middle of a pixel of the target; large pictures are drawn in tiles. Instances come from front to back, so that the early
//! depth test leaves out most of what is hidden. What is read back is two words a pixel; the hit is made of them and the ray
//! on the processor, by the expressions of the walks.

mod piece;
mod pipeline;
mod reconstruct;

use super::drawing::Drawing;
use super::footprint::{Extent, Window};
use super::sight::Sight;
use super::software::window_of;
use super::{Rasterised, Request};
use crate::error::RenderError;
use glam::Vec2;
use piece::{Piece, pieces};
use pipeline::{DrawnInstance, pipeline, texture};
use rayon::prelude::*;
use reconstruct::Found;
use ropewalk::{Answer, FlatTriangle, Hit, Ray, Status, Traced};
use ropewalk_gpu::{Gpu, GpuError, wgpu};
use std::sync::mpsc;

/// The longest side of a target: 128 MiB with its depths.
const LARGEST_SIDE: u32 = 4096;
/// Bytes of a pixel of the target.
const PIXEL_BYTES: u32 = 8;
/// Bytes of a corner, three of which are a triangle.
const CORNER_BYTES: u64 = (size_of::<FlatTriangle>() / 3) as u64;
/// What a pixel holds where nothing was drawn.
const NOTHING: u32 = u32::MAX;
const TARGET_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// What an adapter holds of a drawing.
#[derive(Debug)]
pub(super) struct AdapterDrawing {
    gpu: Gpu,
    corners: wgpu::Buffer,
    /// For instances that do not mirror, and that do.
    pipelines: [wgpu::RenderPipeline; 2],
    /// The longest side of a target.
    pub(super) side: u32,
}

/// What was drawn at a piece's pixels, by the numbers of instance and triangle, and how long its rows are.
struct Names {
    pairs: Vec<[u32; 2]>,
    in_row: usize,
}

impl AdapterDrawing {
    /// Copies the corners to an adapter.
    pub(super) fn new(gpu: &Gpu, drawing: &Drawing<'_>) -> Result<Self, RenderError> {
        let device = gpu.device();
        let bytes = size_of_val(drawing.triangles.as_slice()) as u64;
        let limit = device.limits().max_buffer_size.min(u64::from(u32::MAX) * CORNER_BYTES);
        if bytes > limit {
            return Err(failed(GpuError::TooLarge {
                what: "corners of all triangles",
                needed: bytes,
                limit,
                limit_name: "max_buffer_size",
                way_out: "take primary hits by rays (traced)",
            }));
        }
        let made = gpu.scoped("corners of all triangles", bytes, || {
            let corners = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("ropewalk corners"),
                // A buffer of no bytes cannot be bound.
                size: bytes.max(CORNER_BYTES),
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue().write_buffer(&corners, 0, bytemuck::cast_slice(&drawing.triangles));
            let one_sided = drawing.structure.is_one_sided();
            let pipelines =
                [wgpu::FrontFace::Ccw, wgpu::FrontFace::Cw].map(|front| pipeline(device, front, one_sided));
            (corners, pipelines)
        });
        let (corners, pipelines) = made.map_err(failed)?;
        let side = LARGEST_SIDE.min(device.limits().max_texture_dimension_2d);
        Ok(Self { gpu: gpu.clone(), corners, pipelines, side })
    }

    /// The hits of a run's rays. The run must not be empty.
    pub(super) fn hits(
        &self,
        drawing: &Drawing<'_>,
        request: &Request<'_>,
        trace: &dyn Fn(&[Ray]) -> Result<Traced, RenderError>,
    ) -> Result<Rasterised, RenderError> {
        let window = window_of(request);
        let order = drawing.front_to_back(request.pinhole.plane()[0]);
        let size = [request.width, window.pixels[3] + 1];
        let mut hits = vec![Hit::MISS; request.rays.len()];
        let mut status = vec![Status::COMPLETE; request.rays.len()];
        let mut undecided = Vec::new();
        let at_eye = drawing.at_eye(request.pinhole, size);
        for piece in pieces(&window, self.side) {
            let seen = self.seen(drawing, request, &order, &window.part(piece.pixels()), size);
            let (Some(seen), Some(at_eye)) = (seen, &at_eye) else {
                // Of a camera of which nothing can be said there is nothing to draw.
                for (_, first) in piece.pixels_of(request) {
                    undecided.extend(first..first + request.subpixels.len());
                }
                continue;
            };
            for (sample, &subpixel) in request.subpixels.iter().enumerate() {
                let names = self.draw(drawing, &seen, piece, subpixel).map_err(failed)?;
                let found: Vec<(usize, Found)> = piece
                    .pixels_of(request)
                    .collect::<Vec<_>>()
                    .into_par_iter()
                    .with_min_len(256)
                    .map(|(pixel, first)| {
                        let place = first + sample;
                        let name = names.of(pixel);
                        (place, drawing.reconstruct(name, at_eye, &request.rays[place], request))
                    })
                    .collect();
                for (place, found) in found {
                    match found {
                        Found::Hit(hit) => hits[place] = hit,
                        Found::Invalid => status[place] = Status::INVALID_RAY,
                        Found::Undecided => undecided.push(place),
                    }
                }
            }
        }
        let traced_instead = undecided.len() as u64;
        if !undecided.is_empty() {
            let rays: Vec<Ray> = undecided.iter().map(|&place| request.rays[place]).collect();
            let traced = trace(&rays)?;
            let Answer::Closest(answers) = traced.answer else {
                return Err(RenderError::Raster("rays were answered another question than was asked".into()));
            };
            if answers.len() != rays.len() || traced.status.len() != rays.len() {
                return Err(RenderError::Raster("not every ray was answered".into()));
            }
            for ((place, hit), its_status) in undecided.into_iter().zip(answers).zip(traced.status) {
                (hits[place], status[place]) = (hit, its_status);
            }
        }
        Ok(Rasterised { hits, status, traced_instead })
    }

    /// The instances that may be seen in a window, from front to back. `None` where of one of them it cannot be said.
    fn seen(
        &self,
        drawing: &Drawing<'_>,
        request: &Request<'_>,
        order: &[u32],
        window: &Window,
        size: [u32; 2],
    ) -> Option<Vec<(u32, Sight)>> {
        let mut seen = Vec::new();
        for &index in order {
            let part = &drawing.parts[index as usize];
            if !part.is_seen_by(request.pinhole.mask()) {
                continue;
            }
            let sight = Sight::new(request.pinhole, size, part)?;
            if !matches!(window.of_box(&sight, &part.bounds).0, Extent::Outside) {
                seen.push((index, sight));
            }
        }
        Some(seen)
    }

    /// Draws a piece of the picture, with a sample's place in the middle of each pixel.
    fn draw(
        &self,
        drawing: &Drawing<'_>,
        seen: &[(u32, Sight)],
        piece: Piece,
        subpixel: Vec2,
    ) -> Result<Names, GpuError> {
        let Self { gpu, corners, pipelines, .. } = self;
        let device = gpu.device();
        let instances: Vec<DrawnInstance> =
            seen.iter().map(|(index, sight)| DrawnInstance::new(*index, sight, piece, subpixel)).collect();
        let size = wgpu::Extent3d { width: piece.width, height: piece.height, depth_or_array_layers: 1 };
        let row_bytes = (piece.width * PIXEL_BYTES).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let bytes = u64::from(row_bytes) * u64::from(piece.height);
        let (sender, mapped) = mpsc::channel();
        let readback = gpu.scoped("a picture of triangles", bytes * 3, || {
            let target = texture(device, size, TARGET_FORMAT, wgpu::TextureUsages::COPY_SRC);
            let depth = texture(device, size, DEPTH_FORMAT, wgpu::TextureUsages::empty());
            let placed = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("ropewalk instances"),
                size: (size_of_val(instances.as_slice()) as u64).max(64),
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue().write_buffer(&placed, 0, bytemuck::cast_slice(&instances));
            let readback = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("ropewalk names"),
                size: bytes,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let nothing = f64::from(NOTHING);
                let view = target.create_view(&wgpu::TextureViewDescriptor::default());
                let depth_view = depth.create_view(&wgpu::TextureViewDescriptor::default());
                let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("ropewalk primary hits"),
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view: &view,
                        depth_slice: None,
                        resolve_target: None,
                        ops: wgpu::Operations {
                            load: wgpu::LoadOp::Clear(wgpu::Color { r: nothing, g: nothing, b: 0.0, a: 0.0 }),
                            store: wgpu::StoreOp::Store,
                        },
                    })],
                    depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                        view: &depth_view,
                        depth_ops: Some(wgpu::Operations {
                            load: wgpu::LoadOp::Clear(0.0),
                            store: wgpu::StoreOp::Discard,
                        }),
                        stencil_ops: None,
                    }),
                    ..wgpu::RenderPassDescriptor::default()
                });
                pass.set_vertex_buffer(0, corners.slice(..));
                pass.set_vertex_buffer(1, placed.slice(..));
                let mut mirrored = None;
                for (number, (index, _)) in (0..).zip(seen) {
                    let part = &drawing.parts[*index as usize];
                    if mirrored != Some(part.mirrors) {
                        pass.set_pipeline(&pipelines[usize::from(part.mirrors)]);
                        mirrored = Some(part.mirrors);
                    }
                    let [first, end] = [part.triangles.start, part.triangles.end].map(|it| (it * 3) as u32);
                    pass.draw(first..end, number..number + 1);
                }
            }
            encoder.copy_texture_to_buffer(
                target.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: &readback,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(row_bytes),
                        rows_per_image: None,
                    },
                },
                size,
            );
            gpu.queue().submit([encoder.finish()]);
            readback.slice(..).map_async(wgpu::MapMode::Read, move |result| {
                // Nobody listens any more when something else failed.
                let _ = sender.send(result);
            });
            readback
        })?;
        gpu.wait()?;
        match mapped.try_recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(GpuError::DeviceLost(error.to_string())),
            Err(_) => return Err(GpuError::DeviceLost("what was drawn did not come back".into())),
        }
        let view =
            readback.slice(..).get_mapped_range().map_err(|error| GpuError::DeviceLost(error.to_string()))?;
        // Word by word: what the device gives need not lie as pairs must.
        let pair = |bytes: &[u8]| {
            [bytemuck::pod_read_unaligned(&bytes[..4]), bytemuck::pod_read_unaligned(&bytes[4..])]
        };
        let pairs = view.chunks_exact(PIXEL_BYTES as usize).map(pair).collect();
        drop(view);
        readback.unmap();
        Ok(Names { pairs, in_row: (row_bytes / PIXEL_BYTES) as usize })
    }
}

impl Names {
    fn of(&self, (column, row): (u32, u32)) -> [u32; 2] {
        let place = row as usize * self.in_row + column as usize;
        self.pairs.get(place).copied().unwrap_or([NOTHING; 2])
    }
}

fn failed(error: GpuError) -> RenderError {
    RenderError::Trace(Box::new(error))
}
