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
    // - Ray and result indices are compared with the batch's ray count; the buffers hold that many records. A hit of
    //   an all-hits batch is compared with the room of its ray; the host gives out no more room than there is.
    // - Node and triangle indices come from the uploaded structure alone. Its fields are private, and every
    //   constructor builds or validates it: each link names a node or a range of triangles that is there.
    // - A stack index is compared with the stack's size before each push, and with zero before each pop. A short
    //   stack's place wraps at its size. A trail's level is at most the depth of the structure, which is compared with
    //   the register's before a batch is sent. A list of the nearest has no more entries than places. Its results have
    //   as many places a query as the host counts. Sorted children are as many as a node has places.
    // - The places of elements, vertices and identities come from uploaded lists, whose fields are private too: an escape
    //   index leads to an element of the same list. A head is compared with the length of its list on the host; which list
    //   that is depends on signs and on which magnitude is the largest, which no device rounds. The half-spaces of a head's
    //   row and list are as many as there are places for.
    // - A kd-tree's references, places and ropes are as validated as its nodes: each names a triangle or a node that is there,
    //   and the host refuses the walks that read places where these were left out.
    // - Of two levels the host writes the places of each object's nodes and triangles, of instances and of what leaves lead to;
    //   an instance names an object that has a structure. A smart stack compares its words with the room for swapped ones
    //   before it swaps, and its ring's places wrap at its size.
    // - Each loop of a walk counts down the batch's step budget; a leaf's loop ends at its count, a pop loop
    //   at the empty stack, a trail's loops at level 0; the loops of the trail that a ray is given over to count down what is left.
    // - Workgroup memory: each invocation reads what it wrote itself, and nothing else.
    // - The number of heads a row, by which one kernel divides, is never zero: it is that of lists. Nothing else divides
    //   integers by anything but constants; no shader uses ray queries or mesh stages.
    // The test suite runs every kernel with the checks as well and demands the same words.
    unsafe {
        device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
    }
}
