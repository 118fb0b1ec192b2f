//! Why the program did not do what it was asked: one line for a person, and an exit code for a script.

use std::fmt;
use std::process::ExitCode;

/// The two ways to fail. Success is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exit {
    /// The question was right and could not be answered: a bad file, a device that is not there, a failed check.
    Failed = 1,
    /// The question was wrong: an unknown option, a structure or a walk that does not exist.
    Usage = 2,
}

/// A message of one line and the exit code that goes with it.
#[derive(Clone, Debug)]
pub(crate) struct Failure {
    pub(crate) exit: Exit,
    message: String,
}

impl Failure {
    pub(crate) fn failed(message: impl fmt::Display) -> Self {
        Self { exit: Exit::Failed, message: one_line(&message.to_string()) }
    }

    pub(crate) fn usage(message: impl fmt::Display) -> Self {
        Self { exit: Exit::Usage, message: one_line(&message.to_string()) }
    }

    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.exit as u8)
    }
}

/// Makes one line of a text: a file name may hold a line break, and messages of other libraries do. Other control
/// characters, which a terminal might obey, are written as escapes.
pub(crate) fn one_line(text: &str) -> String {
    let joined = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
    let mut clean = String::with_capacity(joined.len());
    for character in joined.chars() {
        match character {
            '\t' => clean.push(' '),
            _ if character.is_control() => clean.extend(character.escape_default()),
            _ => clean.push(character),
        }
    }
    clean
}

impl From<ropewalk::CatalogueError> for Failure {
    fn from(error: ropewalk::CatalogueError) -> Self {
        Self::usage(error)
    }
}

impl From<ropewalk::TraceError> for Failure {
    fn from(error: ropewalk::TraceError) -> Self {
        match error {
            ropewalk::TraceError::Catalogue(error) => error.into(),
            _ => Self::failed(error),
        }
    }
}

impl From<ropewalk::BuildError> for Failure {
    fn from(error: ropewalk::BuildError) -> Self {
        match error {
            ropewalk::BuildError::Option { .. } => Self::usage(error),
            _ => Self::failed(error),
        }
    }
}

impl From<ropewalk_scene::LoadError> for Failure {
    fn from(error: ropewalk_scene::LoadError) -> Self {
        match error {
            ropewalk_scene::LoadError::NoSuchBuiltin { .. }
            | ropewalk_scene::LoadError::NoSuchClip { .. } => Self::usage(error),
            _ => Self::failed(error),
        }
    }
}

impl From<clap::Error> for Failure {
    /// The first paragraphs of clap's message; its usage text is a `--help` away.
    fn from(error: clap::Error) -> Self {
        let text = error.to_string();
        let told: Vec<&str> = text
            .lines()
            .map(str::trim)
            .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"))
            .filter(|line| !line.is_empty())
            .collect();
        let told = told.join(" ");
        let told = told.strip_prefix("error: ").unwrap_or(&told);
        Self::usage(format!("{} (try --help)", told.trim_end_matches('.')))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_one_line_whatever_it_quotes() {
        let failure = Failure::failed("a\nfile:\r\n\n  it is\tbad \u{1b}[2J");
        assert_eq!(failure.message(), "a file: it is bad \\u{1b}[2J");
        assert_eq!(failure.exit as u8, 1);
        assert_eq!(Failure::usage("x").exit as u8, 2);
    }
}
