//! The last resort: a mistake in the program itself ends with one line and exit code 1, not with a stack trace.

use crate::failure::Failure;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Mutex;

/// Where the first panic of any thread happened, and what it said.
static FIRST: Mutex<Option<String>> = Mutex::new(None);

/// Keeps the text of the first panic instead of printing it.
pub(crate) fn silence() {
    panic::set_hook(Box::new(|info| {
        let text = info
            .payload()
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned())
            .or_else(|| info.payload().downcast_ref::<String>().cloned())
            .unwrap_or_default();
        let place = info.location().map(|place| format!(" at {}:{}", place.file(), place.line()));
        if let Ok(mut first) = FIRST.lock() {
            first.get_or_insert_with(|| format!("{text}{}", place.unwrap_or_default()));
        }
    }));
}

/// Runs the program and makes a failure of a panic.
pub(crate) fn catch(run: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    panic::catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| {
        let told = FIRST.lock().ok().and_then(|first| first.clone()).unwrap_or_default();
        Err(Failure::failed(format!("internal error, please report it: {told}")))
    })
}
