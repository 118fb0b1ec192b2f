//! Pipelines, each made when it is first needed, and the bind group layouts that all of them share.

use crate::scope::scoped;
use crate::shader::{AnyKernel, ShaderLibrary};
use crate::trusted::shader_module;
use crate::{Gpu, GpuError};
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// The pipelines of one device, by kernel. Stack sizes come in steps, so there are few.
#[derive(Debug)]
pub(super) struct Pipelines {
    structure_layout: wgpu::BindGroupLayout,
    batch_layout: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    library: ShaderLibrary,
    checked: bool,
    made: Mutex<HashMap<AnyKernel, wgpu::ComputePipeline>>,
}

impl Pipelines {
    pub(super) fn new(gpu: &Gpu, library: ShaderLibrary, checked: bool) -> Self {
        // Written out: a layout that wgpu derives leaves out what one entry point does not use.
        let buffer = |binding: u32, ty: wgpu::BufferBindingType| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let read = wgpu::BufferBindingType::Storage { read_only: true };
        let write = wgpu::BufferBindingType::Storage { read_only: false };
        let device = gpu.device();
        let structure_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("ropewalk structure"),
            entries: &[buffer(0, read), buffer(1, read)],
        });
        let batch_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("ropewalk batch"),
            entries: &[buffer(0, read), buffer(1, write), buffer(2, wgpu::BufferBindingType::Uniform)],
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("ropewalk batch kernel"),
            bind_group_layouts: &[Some(&structure_layout), Some(&batch_layout)],
            immediate_size: 0,
        });
        Self { structure_layout, batch_layout, layout, library, checked, made: Mutex::default() }
    }

    pub(super) const fn structure_layout(&self) -> &wgpu::BindGroupLayout {
        &self.structure_layout
    }

    pub(super) const fn batch_layout(&self) -> &wgpu::BindGroupLayout {
        &self.batch_layout
    }

    /// The pipeline of a kernel.
    pub(super) fn get(&self, gpu: &Gpu, kernel: AnyKernel) -> Result<wgpu::ComputePipeline, GpuError> {
        // Held while a pipeline is made: a second thread that wants it waits instead of making it again.
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = made.get(&kernel) {
            return Ok(pipeline.clone());
        }
        let source = kernel.source(&self.library)?;
        let label = kernel.label();
        let pipeline = scoped(gpu.device(), "a kernel", 0, || {
            let module = shader_module(gpu.device(), &label, source, self.checked);
            gpu.device().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(&label),
                layout: Some(&self.layout),
                module: &module,
                entry_point: Some("trace"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    // A short stack reads nothing that it has not written.
                    zero_initialize_workgroup_memory: self.checked,
                    ..wgpu::PipelineCompilationOptions::default()
                },
                cache: None,
            })
        })?;
        made.insert(kernel, pipeline.clone());
        Ok(pipeline)
    }
}
