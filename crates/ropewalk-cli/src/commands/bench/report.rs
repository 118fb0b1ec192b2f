//! A benchmark in words and tables.

use super::Arguments;
use crate::table::{Align, Table, bytes, seconds, thousands};
use ropewalk_gpu::Device;
use ropewalk_lab::bench::{RateRecord, SceneRecord};
use ropewalk_lab::{Machine, Spread};
use std::fmt::Write;

/// What stands above all tables.
pub(super) fn heading(machine: &Machine, arguments: &Arguments, devices: &[Device]) -> String {
    let mut text = format!(
        "{}, {} threads, {}; ropewalk {} ({}), {}; {} rays a class, {} rounds\n",
        machine.cpu,
        machine.threads,
        machine.system,
        machine.ropewalk,
        machine.commit,
        machine.date,
        thousands(arguments.rays()),
        arguments.rounds
    );
    for device in devices.iter().filter(|device| matches!(device, Device::Gpu(_))) {
        let _ = writeln!(text, "{device}");
    }
    text
}

/// A scene: its structure, its builds, and a table of rates.
pub(super) fn scene(record: &SceneRecord) -> String {
    let mut text = format!(
        "\n{}: {} triangles{}\n{}: {} nodes, {} leaves, depth {}, SAH cost {:.2}, {} ({:.1} bytes a triangle)\n",
        record.scene,
        thousands(record.triangles),
        references(record.references, record.triangles),
        record.structure,
        thousands(record.nodes),
        thousands(record.leaves),
        record.depth,
        record.sah_cost,
        bytes(record.bytes as u64),
        record.bytes_per_triangle
    );
    for build in &record.builds {
        let time = build.build_seconds;
        let _ = writeln!(
            text,
            "built in {} by {} (from {} to {}), and {} to place the triangles",
            seconds(time.median),
            threads(build.threads),
            seconds(time.min),
            seconds(time.max),
            seconds(build.flatten_seconds.median)
        );
    }
    let mut columns = vec![("Mrays/s", Align::Left), ("threads", Align::Right), ("walk", Align::Left)];
    columns.extend(record.classes.iter().map(|class| (class.class.as_str(), Align::Right)));
    columns.push(("spread", Align::Right));
    let mut table = Table::new(&columns);
    for lane in &record.lanes {
        let rate = |class: &str| lane.rates.iter().find(|rate| rate.class == class);
        let mut row = |name: String, pick: &dyn Fn(&RateRecord) -> Option<Spread>| {
            let spreads: Vec<Option<Spread>> =
                record.classes.iter().map(|class| rate(&class.class).and_then(pick)).collect();
            let threads = lane.threads.map_or("-".into(), |threads| threads.to_string());
            let rates = spreads.iter().map(|spread| spread.map_or("-".into(), |spread| mrays(spread.median)));
            let widest = spreads.iter().flatten().map(|spread| (spread.max - spread.min) / spread.median);
            let widest = widest.fold(0.0, f64::max);
            let cells = [name, threads, lane.walk.clone()].into_iter().chain(rates);
            table.row(cells.chain([format!("{:.0}%", 100.0 * widest)]));
        };
        row(short(&lane.device), &|rate| Some(rate.mrays_per_second));
        if lane.rates.iter().any(|rate| rate.device_mrays_per_second.is_some()) {
            row("  the device alone".into(), &|rate| rate.device_mrays_per_second);
        }
    }
    let _ = write!(text, "{table}");
    text
}

/// How many references there are, where they are more than the triangles.
fn references(references: usize, triangles: usize) -> String {
    if references <= triangles {
        return String::new();
    }
    let growth = 100.0 * (references - triangles) as f64 / triangles.max(1) as f64;
    format!(", {} references (+{growth:.1}%)", thousands(references))
}

/// The name of an adapter without its interface and driver, which stand above the table.
fn short(device: &str) -> String {
    device.split_once(" (").map_or(device, |(name, _)| name).into()
}

/// Three figures are all that such a measurement is good for.
fn mrays(rate: f64) -> String {
    match rate {
        rate if rate < 10.0 => format!("{rate:.2}"),
        rate if rate < 100.0 => format!("{rate:.1}"),
        rate => format!("{rate:.0}"),
    }
}

fn threads(count: usize) -> String {
    if count == 1 { "1 thread".into() } else { format!("{count} threads") }
}
