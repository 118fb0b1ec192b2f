//! The arena with all engines that this machine has.

use super::readme::Readme;
use super::stages::StageArgument;
use crate::commands::bench::Arguments;
use crate::failure::Failure;
use crate::output::{self, OutputFile};
use crate::progress::Progress;
use crate::table::thousands;
use crate::{interrupt, output::note};
use ropewalk_lab::Machine;
use ropewalk_lab::arena::{self, ArenaClass, ArenaSettings, Engine, Row, RowKind, StageRecord};
use ropewalk_peers::{Places, SystemInstruments};
use serde::Serialize;
use std::fmt::Write as _;
use std::io::Write as _;

/// Rays a class: the pixels of a picture of 1024 by 1024.
const RAYS: u32 = 1 << 20;
/// Whose rates are shown in short.
const ENGINE: &str = "ropewalk bvh8";
const PRESET: &str = "high";
/// Builds take long and differ little.
const MOST_BUILD_ROUNDS: usize = 5;

#[derive(Debug, Serialize)]
struct Document<'a> {
    machine: Machine,
    /// Whether the compiler was allowed everything that this processor has: the peers from crates.io gain by it.
    native: bool,
    rays: u32,
    rounds: u16,
    seed: u64,
    absent: Vec<String>,
    failures: Vec<String>,
    rows: Vec<&'a Row>,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let stages: Vec<StageArgument> =
        arguments.scenes.iter().map(StageArgument::new).collect::<Result<_, _>>()?;
    let file = arguments.peers.markdown.as_deref().map(OutputFile::new).transpose()?;
    let readme = arguments.peers.readme.as_deref().map(Readme::new).transpose()?;
    let machine = Machine::here();
    if !machine.optimized {
        note("this is a debug build: its times mean little; build with --release");
    }
    let rays = arguments.rays.unwrap_or(RAYS);
    let settings = settings(arguments, rays, machine.threads);
    let places =
        Places { embree3: arguments.peers.embree3.clone(), embree4: arguments.peers.embree4.clone() };
    let peers = ropewalk_peers::engines(&places);
    let absent: Vec<String> =
        peers.absent.iter().map(|peer| format!("{}: {}", peer.name, peer.why)).collect();
    absent.iter().for_each(|absent| note(absent));
    let engines: Vec<Box<dyn Engine>> = arena::ours::engines()
        .into_iter()
        .chain(peers.engines)
        .filter(|engine| is_wanted(&arguments.peers.engine, &**engine))
        .collect();
    if engines.is_empty() {
        return Err(Failure::usage("no engine's name and preset contain the words of --engine"));
    }
    interrupt::listen()?;
    let heading = heading(&machine, arguments, rays);
    if !arguments.json {
        output::print(&heading)?;
    }
    let mut records: Vec<StageRecord> = Vec::new();
    for stage in &stages {
        if interrupt::requested() {
            break;
        }
        let loaded = stage.load(arguments.camera)?;
        let progress = Progress::spinner(stage.name());
        let watch = |what: &str| {
            progress.label(format!("{}: {what}", stage.name()));
            interrupt::check()
        };
        let measured = arena::run(&loaded, &engines, &settings, &SystemInstruments, &watch);
        drop(progress);
        let record = measured.map_err(|error| Failure::failed(format!("{}: {error}", stage.name())))?;
        if !arguments.json {
            output::print(&arena::markdown(std::slice::from_ref(&record)))?;
        }
        records.push(record);
    }
    if let Some(file) = &file {
        let text = format!("{heading}{}", arena::markdown(&records));
        file.write(|out| out.write_all(text.as_bytes()))?;
    }
    if let Some(readme) = &readme {
        readme.write(&heading, &arena::summary(&records, ENGINE, PRESET))?;
    }
    if arguments.json {
        let (rounds, seed) = (arguments.rounds, arguments.seed);
        let failures = records.iter().flat_map(|record| {
            record.failures.iter().map(move |failure| format!("{}: {failure}", record.scene))
        });
        output::print_json(&Document {
            machine,
            native: is_native(),
            rays,
            rounds,
            seed,
            absent,
            failures: failures.collect(),
            rows: records.iter().flat_map(|record| &record.rows).collect(),
        })?;
    }
    verdict(&records)
}

fn settings(arguments: &Arguments, rays: u32, all_threads: usize) -> ArenaSettings {
    let every = [
        ("trace", RowKind::Trace),
        ("build", RowKind::Build),
        ("refit", RowKind::Refit),
        ("top-level", RowKind::TopLevel),
    ];
    let wanted = |name: &str| {
        let kinds = &arguments.peers.kind;
        kinds.is_empty() || kinds.iter().any(|kind| kind == name)
    };
    let classes = match &arguments.peers.class[..] {
        [] => ArenaClass::EVERY.to_vec(),
        given => ArenaClass::EVERY.into_iter().filter(|class| given.contains(class)).collect(),
    };
    ArenaSettings {
        kinds: every.into_iter().filter(|(name, _)| wanted(name)).map(|(_, kind)| kind).collect(),
        classes,
        threads: arguments.thread_counts(all_threads),
        rounds: arguments.rounds.into(),
        build_rounds: usize::from(arguments.rounds).min(MOST_BUILD_ROUNDS),
        rays: rays as usize,
        seed: arguments.seed,
    }
}

/// Whether one of the wishes names it, or there are none.
fn is_wanted(wishes: &[String], engine: &dyn Engine) -> bool {
    let name = format!("{} {}", engine.name(), engine.preset());
    wishes.is_empty() || wishes.iter().any(|wish| wish.split_whitespace().all(|word| name.contains(word)))
}

fn heading(machine: &Machine, arguments: &Arguments, rays: u32) -> String {
    let mut text = format!(
        "{}, {} threads, {}; ropewalk {} ({}), {}; {} rays a class, {} rounds",
        machine.cpu,
        machine.threads,
        machine.system,
        machine.ropewalk,
        machine.commit,
        machine.date,
        thousands(rays),
        arguments.rounds
    );
    let how = if is_native() { "built for this processor" } else { "a plain build" };
    let _ = writeln!(text, "; {how}\n");
    text
}

const fn is_native() -> bool {
    cfg!(any(target_feature = "avx2", target_arch = "aarch64"))
}

fn verdict(records: &[StageRecord]) -> Result<(), Failure> {
    let wrong: Vec<String> = records
        .iter()
        .flat_map(StageRecord::wrong_answers_of_ours)
        .map(|row| {
            let count = row.agreement.map_or(0, |verdict| verdict.wrong());
            format!("{}: {} {}, {} {}: {count} rays", row.scene, row.engine, row.preset, row.rays, row.mode)
        })
        .collect();
    if let Some(first) = wrong.first() {
        return Err(Failure::failed(format!("{} batches of ours have wrong answers: {first}", wrong.len())));
    }
    if interrupt::requested() {
        return Err(Failure::failed("stopped by ctrl-C; what was measured until then is kept"));
    }
    Ok(())
}
