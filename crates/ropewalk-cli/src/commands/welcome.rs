//! `ropewalk` with no argument: what to try first.

use crate::failure::Failure;
use crate::output::print;

const TEXT: &str = "\
ropewalk answers ray queries, and renders with them, on the CPU and on any GPU.

Try first:
  ropewalk render -o demo.png             render the built-in demo scene
  ropewalk render model.glb -o model.png  render a file: OBJ, PLY, STL, glTF, GLB, AFF
  ropewalk info model.glb                 what a file holds and what is wrong with it
  ropewalk verify                         check every walk on this machine's devices
  ropewalk bench                          measure them

ropewalk --help lists all commands, ropewalk COMMAND --help explains one.
";

/// Prints it.
pub(crate) fn run() -> Result<(), Failure> {
    print(TEXT)
}
