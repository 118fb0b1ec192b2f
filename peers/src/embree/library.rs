//! Where Embree lies, and how it is opened.

use super::abi::{Functions, Queries};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// An Embree that was opened. It is never closed: it keeps threads and tables of its own.
pub(super) struct Library {
    pub(super) functions: Functions,
    pub(super) queries: Queries,
    /// 3 or 4.
    pub(super) version: u32,
    _library: libloading::Library,
}

impl Library {
    /// Opens the named file, or the first that is found where it usually lies.
    pub(super) fn open(version: u32, named: Option<&Path>) -> Result<Self, String> {
        if let Some(path) = named {
            return Self::load(path, version).map_err(|why| format!("{}: {why}", path.display()));
        }
        let variable = format!("ROPEWALK_EMBREE{version}");
        if let Some(path) = std::env::var_os(&variable).filter(|path| !path.is_empty()) {
            let path = PathBuf::from(path);
            return Self::load(&path, version).map_err(|why| format!("{}: {why}", path.display()));
        }
        usual_places(version).iter().find_map(|path| Self::load(path, version).ok()).ok_or_else(|| {
            let from = if version == 3 { "Debian's libembree3-3" } else { "PyPI's embreex" };
            format!("no library was found; {from} has one, or name it in {variable} or --embree{version}")
        })
    }

    fn load(path: &Path, version: u32) -> Result<Self, libloading::Error> {
        // SAFETY: opening a library runs its initialisers. The file was named by the user or lies where Embree is installed;
        // Embree's own set up tables and no more.
        let library = unsafe { libloading::Library::new(path)? };
        // Version 4 alone has this: a file of the other version is refused before its queries are called.
        // SAFETY: the symbol is looked up, not called.
        let is_four =
            unsafe { library.get::<*const ()>(b"rtcSetGeometryEnableFilterFunctionFromArguments\0") }.is_ok();
        if is_four != (version == 4) {
            return Err(libloading::Error::IncompatibleSize);
        }
        // SAFETY: it has the marks of this version, and is kept open in the same structure.
        unsafe {
            Ok(Self {
                functions: Functions::load(&library)?,
                queries: Queries::load(&library, version)?,
                version,
                _library: library,
            })
        }
    }
}

/// Names for the system's loader, and the folders in which Python's packages keep their libraries.
fn usual_places(version: u32) -> Vec<PathBuf> {
    let mut places = vec![
        PathBuf::from(format!("libembree{version}.so.{version}")),
        PathBuf::from(format!("libembree{version}.so")),
        PathBuf::from(format!("libembree{version}.dylib")),
        PathBuf::from(format!("embree{version}.dll")),
    ];
    let variable = |name: &str| std::env::var_os(name).map(PathBuf::from);
    let mut prefixes: Vec<PathBuf> =
        [variable("VIRTUAL_ENV"), variable("CONDA_PREFIX")].into_iter().flatten().collect();
    if let Some(home) = variable("HOME") {
        prefixes.push(home.join(".local"));
        prefixes.extend(entries(&home.join(".pyenv").join("versions"), |_| true));
    }
    prefixes.extend(["/usr/local", "/usr"].map(PathBuf::from));
    for prefix in prefixes {
        for python in entries(&prefix.join("lib"), |name| name.starts_with("python3")) {
            let packages = ["site-packages", "dist-packages"].map(|folder| python.join(folder));
            for folder in packages.map(|packages| packages.join("embreex.libs")) {
                let wanted = format!("libembree{version}");
                places.extend(entries(&folder, |name| name.starts_with(&wanted)));
            }
        }
    }
    places
}

/// What lies in a folder, in the order of the names; nothing where there is no such folder.
fn entries(folder: &Path, wanted: impl Fn(&str) -> bool) -> Vec<PathBuf> {
    let Ok(found) = fs::read_dir(folder) else { return Vec::new() };
    let mut names: Vec<OsString> = found.filter_map(|entry| Some(entry.ok()?.file_name())).collect();
    names.sort();
    names.iter().filter(|name| name.to_str().is_some_and(&wanted)).map(|name| folder.join(name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_told() {
        let why = Library::open(4, Some(Path::new("no/such/library.so"))).err().unwrap();
        assert!(why.contains("no/such/library.so"), "{why}");
        assert!(Library::open(3, Some(Path::new("."))).is_err());
        assert!(entries(Path::new("no/such/folder"), |_| true).is_empty());
    }

    #[test]
    fn names_come_before_folders() {
        let places = usual_places(4);
        assert_eq!(places[0], Path::new("libembree4.so.4"));
    }
}
