//! The pipeline that draws names of triangles, its targets, and instances as it reads them.

use super::piece::Piece;
use super::{CORNER_BYTES, DEPTH_FORMAT, TARGET_FORMAT};
use crate::raster::sight::Sight;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, Vec2};
use ropewalk_gpu::wgpu;

/// An instance as it is drawn: 64 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct DrawnInstance {
    eye: [f32; 3],
    number: u32,
    across: [f32; 3],
    reserved_0: u32,
    upwards: [f32; 3],
    reserved_1: u32,
    depth: [f32; 3],
    reserved_2: u32,
}

impl DrawnInstance {
    pub(super) fn new(number: u32, sight: &Sight, piece: Piece, subpixel: Vec2) -> Self {
        // A place is in the middle of a pixel of the target after this step.
        let step =
            DVec2::splat(0.5) - subpixel.as_dvec2() - DVec2::new(f64::from(piece.left), f64::from(piece.top));
        let [depth, column, row] = sight.rows;
        let across = (column + depth * step.x) * (2.0 / f64::from(piece.width)) - depth;
        let upwards = depth - (row + depth * step.y) * (2.0 / f64::from(piece.height));
        let narrow = |vector: DVec3| vector.as_vec3().to_array();
        Self {
            eye: narrow(sight.eye),
            number,
            across: narrow(across),
            reserved_0: 0,
            upwards: narrow(upwards),
            reserved_1: 0,
            depth: narrow(depth),
            reserved_2: 0,
        }
    }
}

pub(super) fn texture(
    device: &wgpu::Device,
    size: wgpu::Extent3d,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("ropewalk primary hits"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

pub(super) fn pipeline(
    device: &wgpu::Device,
    front_face: wgpu::FrontFace,
    one_sided: bool,
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("shader.wgsl"));
    let of_instance =
        |shader_location: u32, offset: u64, format| wgpu::VertexAttribute { format, offset, shader_location };
    let vector = wgpu::VertexFormat::Float32x3;
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("ropewalk primary hits"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("place"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[
                Some(wgpu::VertexBufferLayout {
                    array_stride: CORNER_BYTES,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &[of_instance(0, 0, vector)],
                }),
                Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<DrawnInstance>() as u64,
                    step_mode: wgpu::VertexStepMode::Instance,
                    attributes: &[
                        of_instance(1, 0, vector),
                        of_instance(2, 12, wgpu::VertexFormat::Uint32),
                        of_instance(3, 16, vector),
                        of_instance(4, 32, vector),
                        of_instance(5, 48, vector),
                    ],
                }),
            ],
        },
        primitive: wgpu::PrimitiveState {
            front_face,
            cull_mode: one_sided.then_some(wgpu::Face::Back),
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("name"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(TARGET_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
