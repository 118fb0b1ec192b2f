//! Every comparator is fed every kind of wrong answer and must object, and near-ties and must not.

use super::*;
use crate::meshes;
use crate::oracle::{Expectation, Oracle};
use crate::rays::{RayClass, RayMaker};
use glam::{Vec2, Vec3};
use ropewalk::{Answer, BuildOptions, Bvh, Mesh, Query, Scene, TraceOptions, Walk};

struct Fixture {
    oracle: Oracle,
    expectation: Expectation,
    bvh: Bvh,
}

impl Fixture {
    fn new(scene: &Scene, rays: Vec<Ray>) -> Self {
        let oracle = Oracle::of_scene(scene).unwrap();
        let bvh = scene.build(&BuildOptions::default()).unwrap();
        Self { expectation: oracle.expect(rays), oracle, bvh }
    }

    /// A soup, two instances of it at the same place, and rays of which some miss and some are not valid.
    fn soup() -> Self {
        let mut scene = Scene::from_mesh(meshes::soup(150, 0.5, 3));
        scene.add_instance(0, ropewalk::Transform::IDENTITY);
        let flat = scene.flatten().unwrap();
        let maker = RayMaker::new(&flat, 5);
        let none = |rays: &[Ray]| vec![Hit::MISS; rays.len()];
        let rays = [RayClass::Random, RayClass::Invalid, RayClass::Lengths, RayClass::Primary]
            .into_iter()
            .flat_map(|class| maker.make(class, 60, &none))
            .collect();
        Self::new(&scene, rays)
    }

    fn rays(&self) -> &[Ray] {
        &self.expectation.rays
    }

    fn trace(&self, query: Query) -> Traced {
        self.bvh.trace(Walk::default(), query, self.rays(), TraceOptions { counters: true }).unwrap()
    }
}

type Comparator = fn(&Fixture, &Traced, &Traced) -> Result<Summary, Mismatch>;

const COMPARATORS: [(&str, Comparator); 3] = [
    ("same_bits", |fixture, reference, given| same_bits(fixture.rays(), reference, given, true)),
    ("against_oracle", |fixture, _, given| against_oracle(&fixture.expectation, given)),
    ("nearly", |fixture, reference, given| nearly(&fixture.oracle, fixture.rays(), reference, given)),
];

/// A wrong answer in the making.
type Harm = fn(&mut Traced);

fn hits(traced: &mut Traced) -> &mut Vec<Hit> {
    match &mut traced.answer {
        Answer::Closest(hits) => hits,
        Answer::All(lists) => &mut lists.hits,
        _ => panic!("no hits here"),
    }
}

/// A hit in the middle of the batch.
fn a_hit(traced: &mut Traced) -> &mut Hit {
    let hits = hits(traced);
    let place = (hits.len() / 2..hits.len()).find(|&place| hits[place].is_hit()).unwrap();
    &mut hits[place]
}

fn a_miss(traced: &mut Traced) -> &mut Hit {
    hits(traced).iter_mut().find(|hit| !hit.is_hit()).unwrap()
}

fn a_list(traced: &Traced) -> (usize, std::ops::Range<usize>) {
    let Answer::All(lists) = &traced.answer else { panic!("no lists here") };
    let long = |pair: &[u64]| pair[1] - pair[0] >= 4;
    let ray = lists.offsets.windows(2).position(long).unwrap();
    (ray, lists.offsets[ray] as usize..lists.offsets[ray + 1] as usize)
}

fn insert(traced: &mut Traced, ray: usize, place: usize, hit: Hit) {
    let Answer::All(lists) = &mut traced.answer else { panic!("no lists here") };
    lists.hits.insert(place, hit);
    lists.offsets[ray + 1..].iter_mut().for_each(|offset| *offset += 1);
}

fn remove(traced: &mut Traced, ray: usize, place: usize) {
    let Answer::All(lists) = &mut traced.answer else { panic!("no lists here") };
    lists.hits.remove(place);
    lists.offsets[ray + 1..].iter_mut().for_each(|offset| *offset -= 1);
}

const HARM_TO_HITS: [(&str, Harm); 13] = [
    ("wrong primitive", |traced| a_hit(traced).primitive_index ^= 1),
    ("wrong geometry", |traced| a_hit(traced).geometry_index += 1),
    ("wrong instance", |traced| a_hit(traced).instance_index += 7),
    ("too far", |traced| a_hit(traced).t *= 1.0 + 3e-5),
    ("too near", |traced| a_hit(traced).t *= 1.0 - 3e-5),
    ("much too far", |traced| a_hit(traced).t *= 2.0),
    ("t is NaN", |traced| a_hit(traced).t = f32::NAN),
    ("t is infinite", |traced| a_hit(traced).t = f32::INFINITY),
    ("t is negative", |traced| a_hit(traced).t *= -1.0),
    ("barycentrics swapped", |traced| {
        let hit = a_hit(traced);
        hit.barycentrics = Vec2::new(hit.barycentrics.y, hit.barycentrics.x);
    }),
    ("barycentrics of another vertex", |traced| {
        let hit = a_hit(traced);
        hit.barycentrics.x = 1.0 - hit.barycentrics.x - hit.barycentrics.y;
    }),
    ("barycentrics are NaN", |traced| a_hit(traced).barycentrics.y = f32::NAN),
    ("wrong side", |traced| {
        let hit = a_hit(traced);
        hit.front_face = !hit.front_face;
    }),
];

const HARM_TO_CLOSEST: [(&str, Harm); 9] = [
    ("lost", |traced| *a_hit(traced) = Hit::MISS),
    ("invented", |traced| {
        let hit = *a_hit(traced);
        *a_miss(traced) = hit;
    }),
    ("the hit of another ray", |traced| {
        let hits = hits(traced);
        let found: Vec<usize> = (0..hits.len()).filter(|&place| hits[place].is_hit()).collect();
        hits.swap(found[0], found[found.len() - 1]);
    }),
    ("the twin of larger id", |traced| {
        // Instances 0 and 1 are the same triangles.
        a_hit(traced).instance_index = 1;
    }),
    ("stale t on a miss", |traced| a_miss(traced).t = 3.0),
    ("stale instance on a miss", |traced| a_miss(traced).instance_index = 0),
    ("stale geometry on a miss", |traced| a_miss(traced).geometry_index = 0),
    ("stale barycentrics on a miss", |traced| a_miss(traced).barycentrics.x = 0.25),
    ("stale side on a miss", |traced| a_miss(traced).front_face = true),
];

const HARM_TO_ALL: [(&str, Harm); 6] = [
    ("missing", |traced| {
        let (ray, list) = a_list(traced);
        remove(traced, ray, list.start + 2);
    }),
    ("listed twice", |traced| {
        let (ray, list) = a_list(traced);
        let hit = hits(traced)[list.start];
        insert(traced, ray, list.start, hit);
    }),
    ("unsorted", |traced| {
        let (_, list) = a_list(traced);
        hits(traced).swap(list.start, list.end - 1);
    }),
    ("a tie in the wrong order", |traced| {
        let (_, list) = a_list(traced);
        let hits = hits(traced);
        assert_eq!(hits[list.start].t, hits[list.start + 1].t);
        hits.swap(list.start, list.start + 1);
    }),
    ("one too many", |traced| {
        let (ray, list) = a_list(traced);
        let hit = Hit { primitive_index: 100_000, ..hits(traced)[list.start] };
        insert(traced, ray, list.start + 1, hit);
    }),
    ("offsets that do not fit", |traced| {
        let Answer::All(lists) = &mut traced.answer else { panic!("no lists here") };
        *lists.offsets.last_mut().unwrap() += 1;
    }),
];

const HARM_TO_COUNT: [(&str, Harm); 2] = [
    ("counted twice", |traced| {
        let Answer::Count(counts) = &mut traced.answer else { panic!("no counts here") };
        *counts.iter_mut().find(|count| **count > 0).unwrap() += 1;
    }),
    ("not counted", |traced| {
        let Answer::Count(counts) = &mut traced.answer else { panic!("no counts here") };
        *counts.iter_mut().find(|count| **count > 0).unwrap() -= 1;
    }),
];

const HARM_TO_ANY: [(&str, Harm); 2] = [
    ("invented", |traced| {
        let Answer::Any(hits) = &mut traced.answer else { panic!("no flags here") };
        *hits.iter_mut().find(|hit| !**hit).unwrap() = true;
    }),
    ("lost", |traced| {
        let Answer::Any(hits) = &mut traced.answer else { panic!("no flags here") };
        *hits.iter_mut().find(|hit| **hit).unwrap() = false;
    }),
];

const HARM_TO_ALL_QUERIES: [(&str, Harm); 5] = [
    ("status of a stopped walk", |traced| traced.status[3] = Status::STEP_BUDGET),
    ("a good ray called invalid", |traced| {
        let place = traced.status.iter().position(|status| status.is_complete()).unwrap();
        traced.status[place] = Status::INVALID_RAY;
    }),
    ("an invalid ray called good", |traced| {
        let place = traced.status.iter().position(|status| !status.is_complete()).unwrap();
        traced.status[place] = Status::COMPLETE;
    }),
    ("a status too few", |traced| traced.status.truncate(100)),
    ("an answer too few", |traced| match &mut traced.answer {
        Answer::Closest(hits) => drop(hits.pop()),
        Answer::Any(hits) => drop(hits.pop()),
        Answer::Count(counts) => drop(counts.pop()),
        Answer::All(lists) => drop(lists.offsets.pop()),
    }),
];

fn harm(query: Query) -> Vec<(&'static str, Harm)> {
    let mut harm = HARM_TO_ALL_QUERIES.to_vec();
    match query {
        Query::Closest => harm.extend(HARM_TO_HITS.iter().chain(&HARM_TO_CLOSEST)),
        Query::All => harm.extend(HARM_TO_HITS.iter().chain(&HARM_TO_ALL)),
        Query::Any => harm.extend(HARM_TO_ANY),
        Query::Count => harm.extend(HARM_TO_COUNT),
    }
    harm
}

#[test]
fn right_answers_pass() {
    let fixture = Fixture::soup();
    for query in Query::EVERY {
        let traced = fixture.trace(query);
        assert!(traced.answer.rays_that_hit() > 60);
        for (name, compare) in COMPARATORS {
            let summary =
                compare(&fixture, &traced, &traced).unwrap_or_else(|mismatch| panic!("{name}: {mismatch}"));
            assert_eq!((summary.rays, summary.hits), (240, traced.answer.rays_that_hit()), "{name} {query}");
            // All but the odd edge; closest hits are at ties with the twin instance, which ids decide.
            assert!(summary.clear >= 230, "{name} {query}: {summary:?}");
        }
    }
}

#[test]
fn every_comparator_objects_to_every_wrong_answer() {
    let fixture = Fixture::soup();
    for query in Query::EVERY {
        let reference = fixture.trace(query);
        for (what, harm) in harm(query) {
            let mut wrong = reference.clone();
            harm(&mut wrong);
            for (name, compare) in COMPARATORS {
                assert!(compare(&fixture, &reference, &wrong).is_err(), "{name} let pass: {query}, {what}");
            }
        }
    }
}

/// The oracle alone can tell that all tracers are wrong in the same way.
#[test]
fn the_oracle_needs_no_reference() {
    let fixture = Fixture::soup();
    let mut wrong = fixture.trace(Query::Closest);
    a_hit(&mut wrong).t *= 1.0 + 3e-5;
    assert!(same_bits(fixture.rays(), &wrong, &wrong, true).is_ok());
    assert!(against_oracle(&fixture.expectation, &wrong).is_err());
}

#[test]
fn counters_and_the_last_bit_count_for_same_bits() {
    let fixture = Fixture::soup();
    let reference = fixture.trace(Query::Closest);
    let mut wrong = reference.clone();
    wrong.counters.as_mut().unwrap()[9].inner_visits += 1;
    let mismatch = same_bits(fixture.rays(), &reference, &wrong, true).unwrap_err();
    assert!(mismatch.to_string().contains("counters") && mismatch.ray.as_ref().unwrap().0 == 9, "{mismatch}");
    assert!(same_bits(fixture.rays(), &reference, &wrong, false).is_ok());
    wrong.counters = None;
    assert!(same_bits(fixture.rays(), &reference, &wrong, true).is_err());
    let mut wrong = reference.clone();
    wrong.counters.as_mut().unwrap().pop();
    assert!(same_bits(fixture.rays(), &reference, &wrong, false).is_err());

    let mut wrong = reference.clone();
    a_hit(&mut wrong).t = a_hit(&mut wrong).t.next_up();
    assert!(same_bits(fixture.rays(), &reference, &wrong, false).is_err());
    assert!(against_oracle(&fixture.expectation, &wrong).is_ok(), "one float off is right for f32");
    assert!(nearly(&fixture.oracle, fixture.rays(), &reference, &wrong).is_ok());
    let mut zero = reference.clone();
    a_hit(&mut zero).t = 0.0;
    let mut negative = reference.clone();
    a_hit(&mut negative).t = -0.0;
    assert!(same_bits(fixture.rays(), &zero, &negative, false).is_err());
}

#[test]
fn answers_of_different_queries_are_not_compared() {
    let fixture = Fixture::soup();
    let (closest, any) = (fixture.trace(Query::Closest), fixture.trace(Query::Any));
    assert!(same_bits(fixture.rays(), &closest, &any, false).is_err());
    assert!(nearly(&fixture.oracle, fixture.rays(), &closest, &any).is_err());
}

#[test]
fn queries_that_contradict_each_other_are_found() {
    let fixture = Fixture::soup();
    let traced = Query::EVERY.map(|query| fixture.trace(query));
    let compare = |traced: &[Traced; 4]| across_queries(fixture.rays(), &traced.each_ref());
    assert!(compare(&traced).is_ok());
    for query in 0..4 {
        let harm: Vec<(&str, Harm)> = match Query::EVERY[query] {
            Query::Closest => [HARM_TO_HITS.as_slice(), &HARM_TO_CLOSEST].concat(),
            Query::Any => HARM_TO_ANY.to_vec(),
            Query::All => HARM_TO_ALL.to_vec(),
            Query::Count => HARM_TO_COUNT.to_vec(),
        };
        for (what, harm) in harm {
            let mut wrong = traced.clone();
            harm(&mut wrong[query]);
            assert!(compare(&wrong).is_err(), "let pass: {} {what}", Query::EVERY[query]);
        }
    }
    // Two alone.
    let (mut any, mut count) = (fixture.trace(Query::Any), fixture.trace(Query::Count));
    HARM_TO_ANY[0].1(&mut any);
    assert!(across_queries(fixture.rays(), &[&any, &traced[3]]).is_err());
    assert!(across_queries(fixture.rays(), &[&any, &traced[0]]).is_err());
    let Answer::Count(counts) = &mut count.answer else { panic!() };
    *counts.iter_mut().find(|count| **count > 0).unwrap() = 0;
    assert!(across_queries(fixture.rays(), &[&count, &traced[0]]).is_err());
}

fn triangles(corners: &[[Vec3; 3]]) -> Scene {
    let positions = corners.iter().flatten().copied().collect();
    Scene::from_mesh(Mesh::new(
        positions,
        (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    ))
}

/// Two slanted triangles in one plane overlap: their `t` differ by rounding alone, and either may win.
#[test]
fn a_near_tie_passes() {
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.3 * x + 0.7 * y);
    let scene = triangles(&[
        [corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)],
        [corner(-0.1, 0.0), corner(1.1, 0.1), corner(0.1, 1.3)],
    ]);
    let fixture = Fixture::new(&scene, vec![Ray::new(Vec3::new(0.3, 0.2, 5.0), -Vec3::Z)]);
    let reference = fixture.trace(Query::Closest);
    let all = fixture.trace(Query::All);
    let Answer::All(lists) = &all.answer else { panic!() };
    assert_eq!(lists.hits.len(), 2);
    let mut other = reference.clone();
    hits(&mut other)[0] = lists.hits[1];
    let mut first = reference.clone();
    hits(&mut first)[0] = lists.hits[0];
    for answer in [&first, &other] {
        let summary = against_oracle(&fixture.expectation, answer).unwrap();
        assert_eq!(summary.clear, 0, "a tie is not clear-cut");
    }
    assert_eq!(nearly(&fixture.oracle, fixture.rays(), &first, &other).unwrap().differing, 1);
    assert!(same_bits(fixture.rays(), &first, &other, false).is_err());
    // But not the same pair when one of them lies plainly behind.
    let mut behind = other.clone();
    hits(&mut behind)[0].t += 1e-4;
    assert!(against_oracle(&fixture.expectation, &behind).is_err());
}

/// A ray at an edge of a single triangle may hit or miss.
#[test]
fn an_edge_passes_either_way() {
    let scene = triangles(&[[Vec3::ZERO, Vec3::new(1.0, 0.2, 0.1), Vec3::new(0.3, 1.0, -0.2)]]);
    let on_edge = Vec3::new(0.5, 0.1, 0.05);
    let origin = Vec3::new(0.1, 0.2, 3.0);
    let fixture = Fixture::new(&scene, vec![Ray::new(origin, on_edge - origin)]);
    let candidate = fixture.expectation.candidates[0][0];
    let hit = Hit {
        t: candidate.t as f32,
        barycentrics: candidate.barycentrics.as_vec2().max(Vec2::ZERO),
        primitive_index: 0,
        geometry_index: 0,
        instance_index: 0,
        front_face: candidate.front_face,
    };
    let traced = |hit: Hit| Traced {
        answer: Answer::Closest(vec![hit]),
        status: vec![Status::COMPLETE],
        counters: None,
    };
    let (hit, miss) = (traced(hit), traced(Hit::MISS));
    for answer in [&hit, &miss] {
        assert_eq!(against_oracle(&fixture.expectation, answer).unwrap().clear, 0);
    }
    assert_eq!(nearly(&fixture.oracle, fixture.rays(), &hit, &miss).unwrap().differing, 1);
    assert_eq!(nearly(&fixture.oracle, fixture.rays(), &miss, &hit).unwrap().differing, 1);
    for (a, b) in [(true, false), (false, true)] {
        let any = |hit: bool| Traced { answer: Answer::Any(vec![hit]), ..hit_less() };
        assert!(nearly(&fixture.oracle, fixture.rays(), &any(a), &any(b)).is_ok());
        assert!(against_oracle(&fixture.expectation, &any(a)).is_ok());
    }
}

fn hit_less() -> Traced {
    Traced { answer: Answer::Any(vec![]), status: vec![Status::COMPLETE], counters: None }
}

#[test]
fn a_mismatch_says_what_is_needed_to_see_it_again() {
    let fixture = Fixture::soup();
    let reference = fixture.trace(Query::Closest);
    let mut wrong = reference.clone();
    *a_hit(&mut wrong) = Hit::MISS;
    let text = against_oracle(&fixture.expectation, &wrong).unwrap_err().to_string();
    for part in ["ray ", "origin [", "dir [", "t 0.0..inf", "mask 0xff", "is lost", "candidates"] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
}
