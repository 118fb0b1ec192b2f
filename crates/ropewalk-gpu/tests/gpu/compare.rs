//! What it means that a device agrees with the CPU.

use ropewalk::{Answer, Hit, HitLists, Traced};

/// The largest relative difference of `t` on a device that does not round as the CPU does.
const T_TOLERANCE: f32 = 1e-5;

/// Compares what a device answered with what the CPU did, and tells the first difference.
///
/// Exact: every word. Otherwise: the same indices with `t` within [`T_TOLERANCE`], and other indices only at an
/// equal `t`. Status words agree in both cases.
pub(crate) fn compare(cpu: &Traced, gpu: &Traced, exact: bool) -> Result<(), String> {
    if cpu.status != gpu.status {
        return Err(first("status", &cpu.status, &gpu.status, |a, b| a == b));
    }
    match (&cpu.answer, &gpu.answer) {
        (Answer::Closest(a), Answer::Closest(b)) => {
            let same = |a: &Hit, b: &Hit| if exact { a.to_words() == b.to_words() } else { is_near(a, b) };
            if a.len() != b.len() || !a.iter().zip(b).all(|(a, b)| same(a, b)) {
                return Err(first("hit", a, b, same));
            }
        }
        (Answer::Any(a), Answer::Any(b)) if a != b => return Err(first("flag", a, b, |a, b| a == b)),
        (Answer::Any(_), Answer::Any(_)) => {}
        (Answer::Count(a), Answer::Count(b)) if a != b => return Err(first("count", a, b, |a, b| a == b)),
        (Answer::Count(_), Answer::Count(_)) => {}
        (Answer::All(a), Answer::All(b)) => compare_lists(a, b, exact)?,
        (a, b) => return Err(format!("{} was asked, {} is answered", a.query(), b.query())),
    }
    match (&cpu.counters, &gpu.counters) {
        (Some(a), Some(b)) if exact && a != b => Err(first("counters", a, b, |a, b| a == b)),
        (Some(a), Some(b)) if a.len() != b.len() => Err("counters are missing".into()),
        (Some(_), Some(_)) | (None, None) => Ok(()),
        _ => Err("one side has counters".into()),
    }
}

/// The same number of hits for each ray; then hit for hit.
fn compare_lists(a: &HitLists, b: &HitLists, exact: bool) -> Result<(), String> {
    if a.offsets != b.offsets {
        return Err(first("offset", &a.offsets, &b.offsets, |a, b| a == b));
    }
    let same = |a: &Hit, b: &Hit| if exact { a.to_words() == b.to_words() } else { is_near(a, b) };
    if a.hits.len() != b.hits.len() || !a.hits.iter().zip(&b.hits).all(|(a, b)| same(a, b)) {
        return Err(first("hit of all", &a.hits, &b.hits, same));
    }
    Ok(())
}

fn first<T: std::fmt::Debug>(what: &str, a: &[T], b: &[T], same: impl Fn(&T, &T) -> bool) -> String {
    let wrong = a.iter().zip(b).filter(|(a, b)| !same(a, b)).count();
    match a.iter().zip(b).position(|(a, b)| !same(a, b)) {
        Some(ray) => {
            format!(
                "{what} of ray {ray} ({wrong} of {} differ): CPU {:?}, device {:?}",
                a.len(),
                a[ray],
                b[ray]
            )
        }
        None => format!("{what}: {} of the CPU, {} of the device", a.len(), b.len()),
    }
}

fn is_near(a: &Hit, b: &Hit) -> bool {
    let near = a.t == b.t || (a.t - b.t).abs() <= T_TOLERANCE * a.t.abs().max(b.t.abs());
    // With t as near, other indices are a tie that rounding decided; a hit and a miss are never near.
    near && a.is_hit() == b.is_hit()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::glam::Vec2;
    use ropewalk::{Counters, Status};

    fn traced() -> Traced {
        let hit = Hit {
            t: 2.0,
            barycentrics: Vec2::new(0.25, 0.0),
            primitive_index: 3,
            geometry_index: 0,
            instance_index: 1,
            front_face: true,
        };
        Traced {
            answer: Answer::Closest(vec![Hit::MISS, hit]),
            status: vec![Status::COMPLETE; 2],
            counters: Some(vec![Counters::default(); 2]),
        }
    }

    /// The first ray has none, the second has hits at these places.
    fn lists(places: &[f32]) -> HitLists {
        let hits = places.iter().map(|&t| Hit { t, primitive_index: 3, ..Hit::MISS });
        HitLists { offsets: vec![0, 0, places.len() as u64], hits: hits.collect() }
    }

    fn harmed(harm: impl FnOnce(&mut Hit)) -> Traced {
        let mut traced = traced();
        if let Answer::Closest(hits) = &mut traced.answer {
            harm(&mut hits[1]);
        }
        traced
    }

    #[test]
    fn equal_answers_agree() {
        for exact in [true, false] {
            assert_eq!(compare(&traced(), &traced(), exact), Ok(()));
        }
        let rounded = harmed(|hit| hit.t = 2.00001);
        assert_eq!(compare(&traced(), &rounded, false), Ok(()));
        let tie = harmed(|hit| hit.primitive_index = 4);
        assert_eq!(compare(&traced(), &tie, false), Ok(()));
    }

    /// Fed with wrong answers of every kind, it must object.
    #[test]
    fn wrong_answers_are_found() {
        let nearest_float = harmed(|hit| hit.t = hit.t.next_up());
        assert!(compare(&traced(), &nearest_float, true).unwrap_err().contains("hit of ray 1"));
        let harms: [fn(&mut Hit); 7] = [
            |hit| hit.barycentrics.y = -0.0,
            |hit| hit.barycentrics.x = 0.250_000_03,
            |hit| hit.primitive_index = 4,
            |hit| hit.geometry_index = 4,
            |hit| hit.instance_index = 4,
            |hit| hit.front_face = false,
            |hit| *hit = Hit::MISS,
        ];
        for harm in harms {
            assert!(compare(&traced(), &harmed(harm), true).is_err());
        }
        for exact in [true, false] {
            assert!(compare(&traced(), &harmed(|hit| hit.t = 2.0001), exact).is_err());
            assert!(compare(&traced(), &harmed(|hit| hit.t = f32::NAN), exact).is_err());
            assert!(compare(&traced(), &harmed(|hit| *hit = Hit::MISS), exact).is_err());
            assert!(
                compare(&traced(), &Traced { answer: Answer::Any(vec![false, true]), ..traced() }, exact)
                    .is_err()
            );
            let status = vec![Status::COMPLETE, Status::STEP_BUDGET];
            assert!(compare(&traced(), &Traced { status, ..traced() }, exact).is_err());
            assert!(compare(&traced(), &Traced { counters: None, ..traced() }, exact).is_err());
            assert!(compare(&traced(), &Traced { counters: Some(vec![]), ..traced() }, exact).is_err());
            let shorter = Traced { answer: Answer::Closest(vec![Hit::MISS]), ..traced() };
            assert!(compare(&traced(), &shorter, exact).is_err());
            let flags = |flags: &[bool]| Traced { answer: Answer::Any(flags.to_vec()), ..traced() };
            assert!(compare(&flags(&[true, false]), &flags(&[true, true]), exact).is_err());
        }
        let sound = Traced { answer: Answer::All(lists(&[1.0, 2.0])), ..traced() };
        let count = |count| Traced { answer: Answer::Count(vec![count, 2]), ..traced() };
        for exact in [true, false] {
            assert_eq!(compare(&sound, &sound, exact), Ok(()));
            for wrong in [&[1.0, 3.0][..], &[1.0], &[2.0, 1.0]] {
                let wrong = Traced { answer: Answer::All(lists(wrong)), ..traced() };
                assert!(compare(&sound, &wrong, exact).is_err());
            }
            let mut moved = lists(&[1.0, 2.0]);
            moved.offsets[1] = 1;
            assert!(compare(&sound, &Traced { answer: Answer::All(moved), ..traced() }, exact).is_err());
            assert_eq!(compare(&count(3), &count(3), exact), Ok(()));
            assert!(compare(&count(3), &count(4), exact).is_err());
            assert!(compare(&count(3), &sound, exact).is_err());
        }
        let one_visit_more = Counters { inner_visits: 1, ..Counters::default() };
        let counters = Some(vec![Counters::default(), one_visit_more]);
        let error = compare(&traced(), &Traced { counters, ..traced() }, true).unwrap_err();
        assert!(error.contains("counters of ray 1"), "{error}");
    }
}
