//! `ropewalk verify`: the conformance suite on this machine's devices.

mod report;

use crate::device_argument::{DEVICE_HELP, DEVICE_LONG_HELP};
use crate::failure::Failure;
use crate::output::{self, note};
use crate::progress::Progress;
use clap::Args;
use report::{DeviceRecord, Document, RowRecord};
use ropewalk::catalogue::{self, Row};
use ropewalk::traversal_list::Starts;
use ropewalk::{Query, Ray, Structure, StructureKind, TraceOptions, Traced, Walk};
use ropewalk_gpu::{Device, DeviceChoice, Gpu, GpuError, Traceable, Tracer};
use ropewalk_testkit::conformance::{self, Accuracy, Suite};
use std::time::Instant;

const EXAMPLES: &str = "\
Every row of `ropewalk list --json` traces every hard case: rays along faces,
through edges and vertices, coplanar and degenerate triangles, huge and tiny
coordinates, windows, masks, rays that are not valid, trees as deep as they may
be. Its answers are judged by brute force in f64, and compared with those of all
other rows and of the CPU. A walk whose register is too small for a deep tree
must refuse it.

Examples:
  ropewalk verify                     the CPU and every adapter
  ropewalk verify --device gpu:0
  ropewalk verify --device cpu --json
  ropewalk verify --structure kd-tree --structure two-level

The exit code is 1 when anything failed.";

/// The arguments of `ropewalk verify`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[arg(long, value_name = "DEVICE", help = DEVICE_HELP, long_help = DEVICE_LONG_HELP)]
    device: Option<DeviceChoice>,
    /// The kinds of structures to check; may be given several times; by default all
    #[arg(long = "structure", value_name = "NAME", value_parser = kind)]
    structures: Vec<StructureKind>,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// A kind of structure by its name, without keys.
fn kind(text: &str) -> Result<StructureKind, String> {
    let names = || StructureKind::EVERY.map(StructureKind::name).join(", ");
    let found = StructureKind::EVERY.into_iter().find(|kind| kind.name() == text);
    found.ok_or_else(|| format!("there is no structure '{text}'; there is {}", names()))
}

/// A device as the suite wants it.
struct Judged {
    device: Device,
    traceable: Option<Traceable>,
}

impl conformance::Device for Judged {
    fn prepare(&mut self, structure: &Structure) -> Result<(), String> {
        let prepared = self.device.prepare(structure.clone()).map_err(|error| error.to_string())?;
        self.traceable = Some(prepared);
        Ok(())
    }

    fn trace(
        &mut self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, String> {
        let traceable = self.traceable.as_ref().ok_or("no structure is prepared")?;
        traceable.trace(walk, query, rays, options).map_err(|error| error.to_string())
    }

    fn trace_from(
        &mut self,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<Option<Traced>, String> {
        let traceable = self.traceable.as_ref().ok_or("no structure is prepared")?;
        traceable.trace_from(query, rays, starts, options).map(Some).map_err(|error| error.to_string())
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let devices = devices(arguments)?;
    let mut suites = Suites::default();
    let records: Vec<DeviceRecord> =
        devices.into_iter().map(|(name, device)| verify(name, device, arguments, &mut suites)).collect();
    let passed = records.iter().all(|record| record.passed);
    let document = Document { passed, devices: records };
    if arguments.json {
        output::print_json(&document)?;
    } else {
        output::print(&document.to_text())?;
    }
    if passed { Ok(()) } else { Err(Failure::failed(document.complaint())) }
}

type Opened = (String, Result<Device, GpuError>);

/// The device that was named; else the CPU and all adapters. That one of those does not open is part of the result.
fn devices(arguments: &Arguments) -> Result<Vec<Opened>, Failure> {
    if let Some(choice) = &arguments.device {
        let opened = Device::open(choice)?;
        if let Some(text) = opened.note {
            note(&text);
        }
        return Ok(vec![(opened.device.to_string(), Ok(opened.device))]);
    }
    let adapters = ropewalk_gpu::adapters();
    if adapters.is_empty() {
        note("no graphics adapter was found: only the CPU is checked");
    }
    let open = |index| Gpu::open(index).map(|gpu| Device::Gpu(Tracer::new(gpu)));
    let opened = adapters.iter().map(|adapter| (adapter.to_string(), open(adapter.index)));
    Ok(std::iter::once((Device::Cpu.to_string(), Ok(Device::Cpu))).chain(opened).collect())
}

/// The oracle's answers, made once for all devices that are judged alike.
#[derive(Default)]
struct Suites {
    exact: Option<Suite>,
    relaxed: Option<Suite>,
}

impl Suites {
    fn get(&mut self, accuracy: Accuracy) -> &Suite {
        let suite = match accuracy {
            Accuracy::Exact => &mut self.exact,
            Accuracy::Relaxed => &mut self.relaxed,
        };
        suite.get_or_insert_with(|| {
            let _progress = Progress::spinner("asking the oracle");
            Suite::new(accuracy)
        })
    }
}

fn verify(
    name: String,
    device: Result<Device, GpuError>,
    arguments: &Arguments,
    suites: &mut Suites,
) -> DeviceRecord {
    let device = match device {
        Ok(device) => device,
        Err(error) => {
            let problem = Some(error.to_string());
            return DeviceRecord { device: name, passed: false, problem, seconds: 0.0, rows: Vec::new() };
        }
    };
    let accuracy = match &device {
        Device::Gpu(tracer) if !tracer.gpu().is_software() => Accuracy::Relaxed,
        _ => Accuracy::Exact,
    };
    let wanted = &arguments.structures;
    let is_wanted = |row: &Row| {
        row.device == device.kind() && (wanted.is_empty() || wanted.contains(&row.structure.kind()))
    };
    let rows: Vec<Row> = catalogue::rows().into_iter().filter(is_wanted).collect();
    let suite = suites.get(accuracy);
    let start = Instant::now();
    let progress = Progress::bar(format!("verifying {name}"));
    let report = match device {
        Device::Cpu => suite.run_on_cpu(&rows, &|done, total| progress.set(done, total)),
        device => {
            let mut judged = Judged { device, traceable: None };
            suite.run(&rows, &mut judged, &mut |done, total| progress.set(done, total))
        }
    };
    DeviceRecord {
        device: name,
        passed: report.is_passed(),
        problem: None,
        seconds: start.elapsed().as_secs_f64(),
        rows: report.rows.iter().map(RowRecord::from).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_that_does_not_open_has_failed() {
        let mut suites = Suites::default();
        let arguments = Arguments { device: None, structures: Vec::new(), json: false };
        let record = verify("gpu:0 broken".into(), Err(GpuError::NoAdapter), &arguments, &mut suites);
        assert!(!record.passed);
        let document = Document { passed: false, devices: vec![record] };
        assert!(document.to_text().contains("cannot be checked"), "{}", document.to_text());
    }
}
