//! What the tests on whole scenes share.

use ropewalk_scene::Model;
use ropewalk_scene::load::load;
use std::path::Path;

/// A scene file beside the project; `None`, with a word, where it is not there.
pub(crate) fn model(name: &str) -> Option<Model> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes")).join(name);
    if !path.exists() {
        println!("skipped: {name} is not there");
        return None;
    }
    Some(load(&path).expect("the scene is read"))
}
