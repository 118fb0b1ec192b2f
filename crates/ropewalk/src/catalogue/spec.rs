//! How structures and walks are written: `NAME[:key=value,...]`. A wrong word is answered with the right ones.

use crate::error::CatalogueError;

/// A name and its keys, taken apart.
pub(super) struct Spec<'a> {
    pub(super) name: &'a str,
    pub(super) options: Vec<(&'a str, &'a str)>,
}

impl<'a> Spec<'a> {
    pub(super) fn parse(text: &'a str) -> Result<Self, CatalogueError> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let options = rest
            .split(',')
            .filter(|part| !part.is_empty())
            .map(|part| {
                part.split_once('=').ok_or_else(|| {
                    CatalogueError(format!("'{part}' in '{text}' is not of the form key=value"))
                })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { name, options })
    }

    pub(super) fn none(&self, kind: &str) -> Result<(), CatalogueError> {
        match self.options.first() {
            None => Ok(()),
            Some((key, _)) => {
                Err(CatalogueError(format!("the {kind} '{}' has no keys, but '{key}' was given", self.name)))
            }
        }
    }
}

/// What is written where something differs from its default.
#[derive(Default)]
pub(super) struct Written(Vec<String>);

impl Written {
    /// Writes `key=value`.
    pub(super) fn key(mut self, key: &str, value: impl std::fmt::Display) -> Self {
        self.0.push(format!("{key}={value}"));
        self
    }

    /// Writes keys that are written already.
    pub(super) fn keys(mut self, written: String) -> Self {
        self.0.push(written);
        self
    }

    /// Writes `key=value` where the value differs from the default.
    pub(super) fn changed<T: PartialEq + std::fmt::Display>(self, key: &str, value: T, plain: T) -> Self {
        if value == plain { self } else { self.key(key, value) }
    }

    /// Writes `key=value` where there is a value.
    pub(super) fn given(self, key: &str, value: Option<impl std::fmt::Display>) -> Self {
        match value {
            Some(value) => self.key(key, value),
            None => self,
        }
    }

    /// Writes the name of a choice where it differs from the default.
    pub(super) fn chosen<T: PartialEq>(self, key: &str, value: &T, plain: &T, names: &[(&str, T)]) -> Self {
        match names.iter().find(|(_, it)| it == value) {
            Some((name, _)) if value != plain => self.key(key, name),
            _ => self,
        }
    }

    /// The whole.
    pub(super) fn under(self, name: &str) -> String {
        if self.0.is_empty() { name.into() } else { format!("{name}:{}", self.0.join(",")) }
    }
}

pub(super) fn unknown(what: &str, given: &str, right: &[&str]) -> CatalogueError {
    CatalogueError(format!("there is no {what} '{given}'; there is {}", right.join(", ")))
}

pub(super) fn number(key: &str, value: &str) -> Result<u32, CatalogueError> {
    value.parse().map_err(|_| CatalogueError(format!("{key}={value}: a whole number is wanted")))
}

pub(super) fn pick<T: Copy>(key: &str, value: &str, names: &[(&str, T)]) -> Result<T, CatalogueError> {
    names.iter().find(|(name, _)| *name == value).map(|(_, it)| *it).ok_or_else(|| {
        let right: Vec<&str> = names.iter().map(|(name, _)| *name).collect();
        CatalogueError(format!("{key}={value}: it can be {}", right.join(", ")))
    })
}
