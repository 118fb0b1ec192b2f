//! The only unsafe call of the crate: shader modules without the checks that wgpu puts into them.
//!
//! naga adds an index clamp to every access and a guard counter to every loop. In the innermost loop of a walk
//! that is two registers and about four instructions on a graphics card, for checks that never fire.

/// Makes a module of one of this crate's own shaders, with or without wgpu's checks.
pub(crate) fn shader_module(
    device: &wgpu::Device,
    label: &str,
    source: String,
    checked: bool,
) -> wgpu::ShaderModule {
    let descriptor =
        wgpu::ShaderModuleDescriptor { label: Some(label), source: wgpu::ShaderSource::Wgsl(source.into()) };
    if checked {
        return device.create_shader_module(descriptor);
    }
    #[expect(unsafe_code, reason = "wgpu cannot see what the walks and the structures promise each other")]
    // SAFETY: The shader must not index out of bounds, loop forever, or divide integers by zero.
    // - Ray and result indices are compared with the batch's ray count; the buffers hold that many records.
    // - Node and triangle indices come from the uploaded structure alone. Its fields are private, and every
    //   constructor builds or validates it: each link names a node or a range of triangles that is there.
    // - A stack index is compared with the stack's size before each push, and with zero before each pop.
    // - Each loop of a walk counts down the batch's step budget; a leaf's loop ends at its count, a pop loop
    //   at the empty stack.
    // - No shader divides integers, uses ray queries, mesh stages or workgroup memory.
    // The test suite runs every kernel with the checks as well and demands the same words.
    unsafe {
        device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
    }
}
