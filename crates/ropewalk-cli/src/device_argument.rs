//! `--device` on the command line, and the devices behind it.

use crate::failure::Failure;
use crate::output::note;
use ropewalk::{CatalogueError, DeviceKind, Query, Structure, StructureKind, Walk, catalogue};
use ropewalk_gpu::{Device, DeviceChoice, GpuError, Traceable};
use std::sync::Arc;

/// What `--device` says in the help of all commands.
pub(crate) const DEVICE_HELP: &str = "Where to trace: auto, cpu, gpu, gpu:NUMBER or gpu:PART-OF-A-NAME";

/// The same, at length.
pub(crate) const DEVICE_LONG_HELP: &str = "\
Where to trace.

  auto           a graphics card where there is one that can, else the CPU
  cpu            the processor, all threads
  gpu            the best graphics adapter; a software one (lavapipe) where there is nothing better
  gpu:NUMBER     the adapter of this number in `ropewalk list`
  gpu:NAME       the best adapter whose name contains NAME, such as gpu:geforce
";

/// Opens the device that is meant and checks that it can answer the queries.
///
/// `auto` takes the CPU for what no graphics card answers.
pub(crate) fn open(
    choice: &DeviceChoice,
    structure: StructureKind,
    walk: Walk,
    queries: &[Query],
) -> Result<Device, Failure> {
    open_checked(choice, |device| {
        queries.iter().try_for_each(|&query| catalogue::check(structure, walk, query, device))
    })
}

/// The same for whatever a check allows on a kind of device.
pub(crate) fn open_checked(
    choice: &DeviceChoice,
    check: impl Fn(DeviceKind) -> Result<(), CatalogueError>,
) -> Result<Device, Failure> {
    // Before a driver is started for nothing.
    match choice {
        DeviceChoice::Auto => {
            if check(DeviceKind::Gpu).is_err() {
                check(DeviceKind::Cpu)?;
                return Ok(Device::Cpu);
            }
        }
        DeviceChoice::Cpu => check(DeviceKind::Cpu)?,
        _ => check(DeviceKind::Gpu)?,
    }
    let opened = Device::open(choice)?;
    check(opened.device.kind())?;
    if let Some(text) = opened.note {
        note(&text);
    }
    Ok(opened.device)
}

/// Opens each device once, for measurements.
pub(crate) fn open_each(choices: &[DeviceChoice]) -> Result<Vec<Device>, Failure> {
    let mut devices: Vec<Device> = Vec::new();
    for choice in choices {
        let opened = Device::open(choice)?;
        // `auto` is the CPU where there is no graphics card, and it is measured once.
        if devices.iter().any(|device| device.to_string() == opened.device.to_string()) {
            continue;
        }
        if let Some(text) = opened.note {
            note(&text);
        }
        devices.push(opened.device);
    }
    Ok(devices)
}

/// Puts a structure on the device that was opened. What does not fit the card that `auto` took is traced on the CPU.
pub(crate) fn prepare(
    choice: &DeviceChoice,
    device: &Device,
    structure: Structure,
) -> Result<Traceable, Failure> {
    let structure = Arc::new(structure);
    match device.prepare(Arc::clone(&structure)) {
        Err(error) if *choice == DeviceChoice::Auto => {
            note(&format!("{error}; tracing on the CPU"));
            Ok(Device::Cpu.prepare(structure)?)
        }
        prepared => Ok(prepared?),
    }
}

impl From<GpuError> for Failure {
    fn from(error: GpuError) -> Self {
        match error {
            GpuError::Catalogue(error) => error.into(),
            GpuError::NoSuchDevice(_) => Self::usage(error),
            _ => Self::failed(error),
        }
    }
}
