//! The files of a scene: each is loaded once, however often it is included.

use super::budget::Budget;
use super::tokens::Tokens;
use crate::LoadError;
use crate::load::source::Source;
use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

/// How deep files may include each other; the benchmark's do 4 deep. Each takes a little of the program's stack.
const DEEPEST: usize = 32;

/// The files that were loaded, and which of them are being read.
#[derive(Debug, Default)]
pub(super) struct Includes {
    /// By the folder of the file that includes them and the name that it uses.
    loaded: HashMap<(PathBuf, String), Rc<Source>>,
    /// Each included by the one before.
    open: Vec<PathBuf>,
}

impl Includes {
    /// A file is read from here on.
    pub(super) fn enter(&mut self, source: &Source) {
        self.open.push(source.path.clone());
    }

    /// The file that was entered last has come to its end.
    pub(super) fn leave(&mut self) {
        self.open.pop();
    }

    /// The file that an include names. It is an error when the file is not there, is open already, or would be the
    /// one too many in each other.
    pub(super) fn source(
        &mut self,
        tokens: &Tokens<'_>,
        name: String,
        budget: &mut Budget,
    ) -> Result<Rc<Source>, LoadError> {
        let folder = tokens.source().path.parent().map(PathBuf::from).unwrap_or_default();
        let key = (folder, name);
        let source = match self.loaded.get(&key) {
            Some(source) => Rc::clone(source),
            None => {
                let loaded = tokens.source().sibling(&key.1).map_err(|error| {
                    tokens.malformed(format!("the file that is included cannot be read: {error}"))
                })?;
                budget.load(loaded.bytes.len());
                let source = Rc::new(loaded);
                self.loaded.insert(key, Rc::clone(&source));
                source
            }
        };
        if self.open.contains(&source.path) {
            let what = format!("{} is included in itself", source.path.display());
            return Err(tokens.malformed(what));
        }
        if self.open.len() > DEEPEST {
            return Err(tokens.malformed(format!(
                "includes are nested more than {DEEPEST} deep, the limit; include the files side by side"
            )));
        }
        Ok(source)
    }
}
