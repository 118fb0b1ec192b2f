//! The catalogue in short: structures by kind with their keys (`keys`), and walks by family with the ranges of theirs.
//!
//! The catalogue has hundreds of rows, most of which differ in one number. Here all walks of one name that answer the
//! same queries on the same devices stand in one line, such as `restart-trail[:short-stack=0..16,register=auto|u64]`.
//! A range with a step is written `24..256/4`. Every setting that can be written is asked for, not only those that the conformance suite tries, so a line says
//! neither more nor less than what is offered.

mod keys;

pub(crate) use keys::{KeyRecord, KindRecord, kinds};

use ropewalk::bvh::StackOrder;
use ropewalk::catalogue::{StackMemory, StructureKind, TrailOptions, TrailRegister, is_offered};
use ropewalk::two_level::SmartStack;
use ropewalk::{DeviceKind, Query, Walk};
use serde::Serialize;

/// Walks of one name that answer the same queries.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Family {
    /// The name of the kind of structure.
    pub(crate) structure: &'static str,
    /// How its walks are written: values of a key with `|` between, what may be left out in brackets.
    pub(crate) walk: String,
    /// What they answer on the CPU.
    pub(crate) cpu: Vec<&'static str>,
    /// What they answer on a graphics adapter.
    pub(crate) gpu: Vec<&'static str>,
    /// What they are.
    pub(crate) about: &'static str,
    /// The walks one by one.
    #[serde(skip)]
    pub(crate) walks: Vec<Walk>,
}

/// Every family of every kind of structure, in the catalogue's order.
pub(crate) fn families() -> Vec<Family> {
    StructureKind::EVERY.into_iter().flat_map(of_kind).collect()
}

fn of_kind(kind: StructureKind) -> Vec<Family> {
    grouped(kind, |walk, device| {
        let offered = |query: &Query| is_offered(kind, walk, *query, device);
        Query::EVERY.into_iter().filter(offered).map(Query::name).collect()
    })
}

/// The walks of a kind of structure in families, by what they answer on a device.
pub(crate) fn grouped(
    kind: StructureKind,
    answers: impl Fn(Walk, DeviceKind) -> Vec<&'static str>,
) -> Vec<Family> {
    let mut families: Vec<Family> = Vec::new();
    for walk in every_walk() {
        let (cpu, gpu) = (answers(walk, DeviceKind::Cpu), answers(walk, DeviceKind::Gpu));
        if cpu.is_empty() && gpu.is_empty() {
            continue;
        }
        let same = |family: &&mut Family| {
            family.walks.first().is_some_and(|first| first.name() == walk.name())
                && (&family.cpu, &family.gpu) == (&cpu, &gpu)
        };
        match families.iter_mut().find(same) {
            Some(family) => family.walks.push(walk),
            None => families.push(Family {
                structure: kind.name(),
                walk: String::new(),
                cpu,
                gpu,
                about: "",
                walks: vec![walk],
            }),
        }
    }
    for family in &mut families {
        family.walk = written(&family.walks);
        family.about = about(&family.walks);
    }
    families
}

/// Every walk that can be written.
fn every_walk() -> Vec<Walk> {
    let mut walks =
        vec![Walk::BruteForce, Walk::Recursive, Walk::List, Walk::KdRestart, Walk::KdBacktrack, Walk::Ropes];
    walks.extend((1..=Walk::MAX_SHORT_STACK).map(|entries| Walk::ShortStack { entries }));
    let bytes = (SmartStack::LEAST_BYTES..=SmartStack::MOST_BYTES).step_by(4);
    walks.extend(bytes.map(|bytes| Walk::SmartStack { bytes }));
    walks.extend(StackOrder::NAMES.iter().map(|(_, order)| Walk::Stack(*order)));
    for &(_, memory) in StackMemory::NAMES {
        for &(_, register) in TrailRegister::NAMES {
            for short_stack in 0..=TrailOptions::MAX_SHORT_STACK {
                walks.push(Walk::RestartTrail(TrailOptions { short_stack, register, memory }));
            }
        }
    }
    walks
}

/// What a family is: of one walk its own words, of several what is common to them.
fn about(walks: &[Walk]) -> &'static str {
    match walks {
        [Walk::Stack(_), _, ..] => {
            "a stack, in the stages of the blog of 2022: nothing culled, culled, nearer child first"
        }
        [Walk::RestartTrail(_), ..] => "short stack or none; a trail of bits leads back (Laine 2010)",
        [first, ..] => first.about(),
        [] => "",
    }
}

/// A key, its values in one family, and whether the value that it has when it is left out is among them.
struct Key {
    name: &'static str,
    values: String,
    may_be_left_out: bool,
}

/// How the walks of a family are written in one line; one by one where no line says exactly that.
fn written(walks: &[Walk]) -> String {
    let Some(first) = walks.first() else { return String::new() };
    let one_by_one = || walks.iter().map(Walk::to_string).collect::<Vec<_>>().join(" ");
    let keys = match first {
        Walk::BruteForce
        | Walk::Recursive
        | Walk::List
        | Walk::KdRestart
        | Walk::KdBacktrack
        | Walk::Ropes => Vec::new(),
        Walk::ShortStack { .. } => vec![Key {
            name: "entries",
            values: format!("1..{}", Walk::MAX_SHORT_STACK),
            may_be_left_out: true,
        }],
        Walk::SmartStack { .. } => vec![Key {
            name: "bytes",
            values: format!("{}..{}/4", SmartStack::LEAST_BYTES, SmartStack::MOST_BYTES),
            may_be_left_out: true,
        }],
        Walk::Stack(_) => {
            let orders = walks.iter().filter_map(|walk| match walk {
                Walk::Stack(order) => Some(*order),
                _ => None,
            });
            vec![names("order", StackOrder::NAMES, &orders.collect::<Vec<_>>())]
        }
        Walk::RestartTrail(_) => {
            let trails: Vec<TrailOptions> = walks
                .iter()
                .filter_map(|walk| match walk {
                    Walk::RestartTrail(options) => Some(*options),
                    _ => None,
                })
                .collect();
            match trail_keys(&trails) {
                Some(keys) => keys,
                None => return one_by_one(),
            }
        }
    };
    let (optional, needed): (Vec<Key>, Vec<Key>) = keys.into_iter().partition(|key| key.may_be_left_out);
    let join = |keys: &[Key]| {
        keys.iter().map(|key| format!("{}={}", key.name, key.values)).collect::<Vec<_>>().join(",")
    };
    let (needed, optional) = (join(&needed), join(&optional));
    match (needed.is_empty(), optional.is_empty()) {
        (true, true) => first.name().into(),
        (false, true) => format!("{}:{needed}", first.name()),
        (true, false) => format!("{}[:{optional}]", first.name()),
        (false, false) => format!("{}:{needed}[,{optional}]", first.name()),
    }
}

/// The keys of trails; `None` where the trails are not all combinations of their values.
fn trail_keys(trails: &[TrailOptions]) -> Option<Vec<Key>> {
    let mut sizes: Vec<u32> = trails.iter().map(|trail| trail.short_stack).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let (smallest, largest) = (*sizes.first()?, *sizes.last()?);
    let is_range = sizes.len() == (largest - smallest + 1) as usize;
    let registers: Vec<TrailRegister> = trails.iter().map(|trail| trail.register).collect();
    let memories: Vec<StackMemory> = trails.iter().map(|trail| trail.memory).collect();
    let register = names("register", TrailRegister::NAMES, &registers);
    let memory = names("memory", StackMemory::NAMES, &memories);
    let count = |key: &Key| key.values.split('|').count();
    if !is_range || sizes.len() * count(&register) * count(&memory) != trails.len() {
        return None;
    }
    let plain = TrailOptions::default();
    let short_stack = Key {
        name: "short-stack",
        values: format!("{smallest}..{largest}"),
        may_be_left_out: sizes.contains(&plain.short_stack),
    };
    Some(vec![short_stack, register, memory])
}

fn names<T: PartialEq + Default>(name: &'static str, names: &[(&str, T)], there: &[T]) -> Key {
    let values: Vec<&str> =
        names.iter().filter(|(_, value)| there.contains(value)).map(|(name, _)| *name).collect();
    Key { name, values: values.join("|"), may_be_left_out: there.contains(&T::default()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::catalogue::rows;

    /// Nothing that is offered may be missing, and nothing may stand there that is not offered.
    #[test]
    fn every_row_is_in_exactly_one_family() {
        let families = families();
        for row in rows() {
            let kind = row.structure.kind().name();
            let of: Vec<&Family> = families
                .iter()
                .filter(|family| family.structure == kind && family.walks.contains(&row.walk))
                .collect();
            let [family] = of[..] else { panic!("{row:?} is in {} families", of.len()) };
            let queries = if row.device == DeviceKind::Cpu { &family.cpu } else { &family.gpu };
            assert!(queries.contains(&row.query.name()), "{row:?}");
        }
        for family in &families {
            for &walk in &family.walks {
                for (device, queries) in [(DeviceKind::Cpu, &family.cpu), (DeviceKind::Gpu, &family.gpu)] {
                    for query in Query::EVERY {
                        let kind =
                            StructureKind::EVERY.into_iter().find(|kind| kind.name() == family.structure);
                        let offered = is_offered(kind.unwrap(), walk, query, device);
                        assert_eq!(offered, queries.contains(&query.name()), "{walk} {query} {device}");
                    }
                }
            }
        }
    }

    /// Taken apart again, a line stands for its walks and for no other.
    #[test]
    fn a_line_says_which_walks_it_stands_for() {
        for family in families() {
            let (needed, optional) = match family.walk.split_once('[') {
                Some((needed, optional)) => {
                    (needed, optional.trim_end_matches(']').trim_start_matches([':', ',']))
                }
                None => (family.walk.as_str(), ""),
            };
            let (name, needed) = needed.split_once(':').unwrap_or((needed, ""));
            let mut texts = vec![String::new()];
            for key in needed.split(',').chain(optional.split(',')).filter(|key| !key.is_empty()) {
                let (key, values) = key.split_once('=').unwrap();
                let values: Vec<String> = match values.split_once("..") {
                    Some((from, to)) => {
                        let (to, step) = to.split_once('/').unwrap_or((to, "1"));
                        let numbers = from.parse().unwrap()..=to.parse::<u32>().unwrap();
                        numbers.step_by(step.parse().unwrap()).map(|n| n.to_string()).collect()
                    }
                    None => values.split('|').map(str::to_owned).collect(),
                };
                texts = texts
                    .iter()
                    .flat_map(|text| values.iter().map(move |value| format!("{text},{key}={value}")))
                    .collect();
            }
            let mut walks: Vec<Walk> = texts
                .iter()
                .map(|text| format!("{name}:{}", text.trim_start_matches(',')).parse().unwrap())
                .collect();
            let mut expected = family.walks.clone();
            let sort = |walks: &mut Vec<Walk>| walks.sort_by_key(Walk::to_string);
            sort(&mut walks);
            sort(&mut expected);
            assert_eq!(walks, expected, "{}", family.walk);
            let plain = name.parse::<Walk>().unwrap();
            assert_eq!(needed.is_empty(), expected.contains(&plain), "{}", family.walk);
        }
    }

    #[test]
    fn walks_that_are_no_product_are_named_one_by_one() {
        let trail = |short_stack| Walk::RestartTrail(TrailOptions { short_stack, ..TrailOptions::default() });
        assert_eq!(
            written(&[trail(3), trail(4), trail(5)]),
            "restart-trail[:short-stack=3..5,register=auto,memory=private]"
        );
        let text = "restart-trail:short-stack=3 restart-trail:short-stack=5";
        assert_eq!(written(&[trail(3), trail(5)]), text);
    }
}
