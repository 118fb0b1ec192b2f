//! How long a structure takes to build, by number of threads.

use super::lanes::Pool;
use super::{BenchError, BuildRecord};
use crate::Spread;
use ropewalk::{NoMonitor, Scene, Structure, StructureSpec};

/// Builds the structure `rounds` times with each pool, in turn; the first build of all warms up and is the one that
/// is kept and traced.
pub(super) fn measure(
    scene: &Scene,
    spec: &StructureSpec,
    pools: &[Pool],
    rounds: usize,
    step: &dyn Fn(&str, usize, usize) -> Result<(), BenchError>,
) -> Result<(Structure, Vec<BuildRecord>), BenchError> {
    let total = rounds * pools.len() + 1;
    step("building", 0, total)?;
    let kept = spec.build(scene, &NoMonitor)?;
    let mut build_times = vec![Vec::with_capacity(rounds); pools.len()];
    let mut flatten_times = build_times.clone();
    for round in 0..rounds {
        for (index, pool) in pools.iter().enumerate() {
            step("building", 1 + round * pools.len() + index, total)?;
            let built = pool.install(|| spec.build(scene, &NoMonitor))?;
            build_times[index].push(built.report().build_time.as_secs_f64());
            flatten_times[index].push(built.report().flatten_time.as_secs_f64());
        }
    }
    let records =
        pools.iter().zip(&build_times).zip(&flatten_times).filter_map(|((pool, build), flatten)| {
            Some(BuildRecord {
                threads: pool.threads(),
                build_seconds: Spread::of(build)?,
                flatten_seconds: Spread::of(flatten)?,
            })
        });
    Ok((kept, records.collect()))
}
