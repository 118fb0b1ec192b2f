//! Compiles tinybvh, if its header and a C++ compiler are there. Where they are not, the peer is absent: no failure.
//!
//! The header lies in the crate `tinybvh-rs`, a dependency for no target at all: cargo fetches it and never compiles it.
//! `ROPEWALK_TINYBVH` names another folder with a `tiny_bvh.h`.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-env-changed=ROPEWALK_TINYBVH");
    println!("cargo::rerun-if-changed=src/tinybvh/wrapper.cpp");
    let absent = |why: &str| println!("cargo::warning=tinybvh is left out: {why}");
    if env::var("CARGO_CFG_TARGET_ARCH").as_deref() != Ok("x86_64") {
        return absent("it is measured with AVX2, which this target does not have");
    }
    let Some(folder) = named().or_else(fetched) else {
        return absent("there is no tiny_bvh.h; name its folder in ROPEWALK_TINYBVH");
    };
    println!("cargo::rerun-if-changed={}", folder.join("tiny_bvh.h").display());
    // What the rest of the program may use it may use, too.
    let features = env::var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    let is_native = features.split(',').any(|feature| feature == "avx2");
    let mut build = cc::Build::new();
    if is_native {
        build.flag_if_supported("-march=native");
    }
    let compiled = build
        .cpp(true)
        .std("c++20")
        .file("src/tinybvh/wrapper.cpp")
        .include(&folder)
        // As fast as its author builds it, whatever profile this crate has.
        .opt_level(3)
        .flags(["-mavx2", "-mfma", "-mbmi", "-mbmi2", "-mlzcnt", "-mpopcnt", "-DNDEBUG"])
        .warnings(false)
        .cargo_warnings(false)
        .try_compile("ropewalk_tinybvh");
    match compiled {
        Ok(()) => println!("cargo::rustc-cfg=has_tinybvh"),
        Err(error) => absent(error.to_string().lines().next().unwrap_or_default()),
    }
}

fn named() -> Option<PathBuf> {
    let folder = PathBuf::from(env::var_os("ROPEWALK_TINYBVH")?);
    has_header(&folder).then_some(folder)
}

/// Where cargo put it: what `cargo metadata` says of the workspace that is built, or of this crate alone.
fn fetched() -> Option<PathBuf> {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR")?);
    let manifests = [here.join("..").join("Cargo.toml"), here.join("Cargo.toml")];
    manifests.iter().find_map(|manifest| {
        let output = Command::new(env::var_os("CARGO")?)
            .args(["metadata", "--format-version", "1", "--locked", "--all-features", "--manifest-path"])
            .arg(manifest)
            .output()
            .ok()?;
        let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).ok()?;
        let packages = metadata.get("packages")?.as_array()?;
        let package = packages.iter().find(|package| package["name"] == "tinybvh-rs")?;
        let folder = Path::new(package["manifest_path"].as_str()?).parent()?.join("ffi").join("tinybvh");
        has_header(&folder).then_some(folder)
    })
}

fn has_header(folder: &Path) -> bool {
    folder.join("tiny_bvh.h").is_file()
}
