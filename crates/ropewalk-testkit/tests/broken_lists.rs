//! The suite must fail when traversal lists are broken: the rule of culling that the paper prints, the sides of triangles
//! mixed up, escape indices one too long, layers that forget the ray parameter, and heads that are not for the ray.

#[path = "support/caught.rs"]
mod caught;
#[path = "support/lists.rs"]
mod rows;

use caught::demand_caught;
use ropewalk::aabb::slab_test;
use ropewalk::bvh::walk::{AllHits, AnyHit, ClosestHit, Collect, HitCount, Summary};
use ropewalk::traversal_list::{
    Bounds, Cull, Directions, Element, Heads, ListOptions, NO_HEAD, Starts, list_of,
};
use ropewalk::{
    Answer, Counters, FlatTriangle, Hit, HitLists, PreparedRay, Query, Ray, Status, Structure, TraceOptions,
    Traced, TraversalList, Walk, batch,
};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::conformance::{Accuracy, Device, Report, Suite};
use rows::{list_rows, run_on_cpu};

/// What is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    Nothing,
    /// What is missed is left by one element too many.
    EscapesOneTooLong,
    /// Backs of triangles of one side are hit.
    HitsBacks,
    /// The sides of instances that mirror are not turned.
    MirroredNotTurned,
    /// Fronts are lost: the sides are the wrong way round.
    HitsBacksAlone,
    /// The second layer knows nothing of the hit in the first, and its own hit is taken.
    SecondLayerAnew,
    /// The second layer begins with the ray's window, but the better of both hits is taken.
    SecondLayerForgets,
    /// The walk goes on with the second layer where the first had enough.
    SecondLayerAlways,
    /// Heads are passed by with what is below them.
    HeadsASubtreeOn,
    /// Heads of triangles that the ray leaves by the back.
    HeadsForBacks,
    /// Heads of the list of another direction.
    HeadsOfAnotherList,
    /// All rays begin with the first element.
    HeadsUnused,
    /// Where there is no head the ray begins with the first element.
    NoHeadUnknown,
}

/// A device whose walk of lists is broken; brute force is the CPU's.
struct Broken {
    fault: Fault,
    list: Option<TraversalList>,
}

impl Device for Broken {
    fn prepare(&mut self, structure: &Structure) -> Result<(), String> {
        let Structure::List(list) = structure else { return Err("only a list".into()) };
        self.list = Some(list.clone());
        Ok(())
    }

    fn trace(
        &mut self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, String> {
        let list = self.list.as_ref().ok_or("nothing prepared")?;
        if walk != Walk::List {
            return list.trace(walk, query, rays, options).map_err(|error| error.to_string());
        }
        Ok(Walker { list, fault: self.fault }.trace(query, rays, |_| None, options))
    }

    fn trace_from(
        &mut self,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<Option<Traced>, String> {
        let list = self.list.as_ref().ok_or("nothing prepared")?;
        let heads = |index: usize| match self.fault {
            Fault::HeadsUnused => None,
            // The ray before leaves the same triangle, by its front perhaps.
            Fault::HeadsForBacks => (0..=index).rev().find_map(|index| starts.of(index)),
            _ => starts.of(index),
        };
        Ok(Some(Walker { list, fault: self.fault }.trace(query, rays, heads, options)))
    }
}

/// The walk, written anew so that it can be broken.
#[derive(Clone, Copy)]
struct Walker<'a> {
    list: &'a TraversalList,
    fault: Fault,
}

impl Walker<'_> {
    fn trace<'h>(
        self,
        query: Query,
        rays: &[Ray],
        heads: impl Fn(usize) -> Option<&'h [u32]>,
        options: TraceOptions,
    ) -> Traced {
        let (mut closest, mut any, mut counts) = (Vec::new(), Vec::new(), Vec::new());
        let mut lists = HitLists { offsets: vec![0], hits: Vec::new() };
        let (mut counters, mut status) = (Vec::new(), Vec::new());
        for (index, ray) in rays.iter().enumerate() {
            let prepared = PreparedRay::new(ray);
            status.push(if prepared.is_some() { Status::COMPLETE } else { Status::INVALID_RAY });
            let mut counted = Counters::default();
            let ray = prepared.as_ref();
            let heads = heads(index);
            match query {
                Query::Closest => {
                    closest.push(ray.map_or(Hit::MISS, |ray| self.closest(ray, heads, &mut counted)));
                }
                Query::Any => any.push(ray.is_some_and(|ray| {
                    let mut found = AnyHit::new(ray);
                    self.walk(ray, heads, &mut found, &mut counted);
                    found.answer()
                })),
                Query::Count if !self.list.has_repeats() => counts.push(ray.map_or(0, |ray| {
                    let mut found = HitCount::new(ray);
                    self.walk(ray, heads, &mut found, &mut counted);
                    found.answer()
                })),
                Query::Count | Query::All => {
                    let first = lists.hits.len();
                    if let Some(ray) = ray {
                        self.walk(ray, heads, &mut AllHits::new(ray, &mut lists.hits), &mut counted);
                    }
                    batch::settle(&mut lists.hits, first, self.list.has_repeats());
                    lists.offsets.push(lists.hits.len() as u64);
                    counts.push((lists.hits.len() - first) as u32);
                }
            }
            counters.push(counted);
        }
        let answer = match query {
            Query::Closest => Answer::Closest(closest),
            Query::Any => Answer::Any(any),
            Query::All => Answer::All(lists),
            Query::Count => Answer::Count(counts),
        };
        Traced { answer, status, counters: options.counters.then_some(counters) }
    }

    fn closest(self, ray: &PreparedRay, heads: Option<&[u32]>, counted: &mut Counters) -> Hit {
        if !matches!(self.fault, Fault::SecondLayerAnew | Fault::SecondLayerForgets) {
            let mut found = ClosestHit::new(ray);
            self.walk(ray, heads, &mut found, counted);
            return found.answer();
        }
        let mut best = Hit::MISS;
        for layer in 0..self.list.layers() {
            let mut found = ClosestHit::new(ray);
            self.layer(layer, ray, heads, &mut found, counted);
            let hit = found.answer();
            if hit.is_hit() && (self.fault == Fault::SecondLayerAnew || hit.precedes(&best)) {
                best = hit;
            }
        }
        best
    }

    fn walk(
        self,
        ray: &PreparedRay,
        heads: Option<&[u32]>,
        collect: &mut impl Collect,
        counted: &mut Counters,
    ) {
        for layer in 0..self.list.layers() {
            let is_enough = self.layer(layer, ray, heads, collect, counted);
            if is_enough && self.fault != Fault::SecondLayerAlways {
                return;
            }
        }
    }

    /// Whether the collector has enough.
    fn layer(
        self,
        layer: usize,
        ray: &PreparedRay,
        heads: Option<&[u32]>,
        collect: &mut impl Collect,
        counted: &mut Counters,
    ) -> bool {
        let Self { list, fault } = self;
        let directions = list.options().directions;
        let own = list_of(directions, ray);
        let elements = list.list_of_layer(layer, own);
        let of_heads = if fault == Fault::HeadsOfAnotherList { (own + 1) % directions.lists() } else { own };
        let head = heads.map_or(0, |heads| heads[layer * directions.lists() + of_heads]);
        let mut at = match head {
            NO_HEAD if fault == Fault::NoHeadUnknown => 0,
            NO_HEAD => return false,
            head => head as usize,
        };
        if let (Fault::HeadsASubtreeOn, Some(_), Some(element)) = (fault, heads, elements.get(at)) {
            match element.escape {
                0 | Element::NOWHERE => return false,
                escape => at += escape as usize,
            }
        }
        while let Some(element) = elements.get(at) {
            let mut next = element.escape;
            if element.is_triangle() {
                counted.primitive_tests += 1;
                let triangle = list.triangle(element);
                if let Some(hit) = self.hit(&triangle, ray, collect.t_max())
                    && collect.offer(hit).is_break()
                {
                    return true;
                }
            } else {
                counted.inner_visits += 1;
                let interval = match list.options().bounds {
                    Bounds::Sphere => element.sphere().interval(ray, collect.t_max()),
                    Bounds::Aabb => {
                        let grid = list.layer(layer).expect("the layer is there").grid();
                        let [min, max] = element.packed_box().corners(grid);
                        slab_test(ray, min, max, collect.t_max())
                    }
                };
                if interval.is_hit() {
                    next = 1;
                } else if fault == Fault::EscapesOneTooLong && next > 0 {
                    next += 1;
                }
            }
            if next <= 0 {
                break;
            }
            at += next as usize;
        }
        false
    }

    fn hit(self, triangle: &FlatTriangle, ray: &PreparedRay, t_max: f32) -> Option<Hit> {
        if !self.list.is_one_sided() || self.fault == Fault::HitsBacks {
            return triangle.intersect(ray, t_max);
        }
        match self.fault {
            Fault::HitsBacksAlone => triangle.intersect(ray, t_max).filter(|hit| !hit.front_face),
            Fault::MirroredNotTurned => {
                triangle.intersect(ray, t_max).filter(|hit| hit.front_face != triangle.is_mirrored())
            }
            _ => triangle.intersect_front(ray, t_max),
        }
    }
}

fn run(case: &str, fault: Fault, options: ListOptions) -> Report {
    let case = Case::named(case).unwrap();
    let mut device = Broken { fault, list: None };
    Suite::of(vec![case], Accuracy::Exact).run(&list_rows(options), &mut device, &mut |_, _| {})
}

/// Runs the case with the fault: it must be caught, by a check whose words contain `says`, and nobody else blamed.
fn must_be_caught(fault: Fault, case: &str, options: ListOptions, says: &str) {
    let report = run(case, fault, options);
    demand_caught(&report, fault, case, says);
    assert!(report.failures().all(|(row, _)| row.walk == Walk::List), "{fault:?}: {report}");
}

fn one_sided() -> ListOptions {
    ListOptions { cull: Cull::Exact, ..ListOptions::default() }
}

fn layered() -> ListOptions {
    ListOptions { moving: Some(5), ..ListOptions::default() }
}

fn with_heads(heads: Heads) -> ListOptions {
    ListOptions { heads, ..one_sided() }
}

/// The plumbing of this file is not what the suite objects to.
#[test]
fn an_unbroken_walk_passes() {
    let boxes = ListOptions { bounds: Bounds::Aabb, heads: Heads::Regular, ..layered() };
    for options in [one_sided(), layered(), with_heads(Heads::Simple), boxes, ListOptions::BEST] {
        for case in ["soup", "placed", "sphere", "masks", "one-triangle", "empty"] {
            let report = run(case, Fault::Nothing, options);
            assert!(report.is_passed(), "{case}: {report}");
        }
    }
}

/// The rule that the paper prints, one sixth of all normals, loses what rays see almost from the side.
#[test]
fn culling_as_printed_loses_hits() {
    let with = |cull| list_rows(ListOptions { cull, directions: Directions::Six, ..ListOptions::default() });
    let sound = run_on_cpu(&["diagonals"], &with(Cull::Exact));
    assert!(sound.is_passed(), "{sound}");
    let printed = run_on_cpu(&["diagonals"], &with(Cull::AsPrinted));
    demand_caught(&printed, Cull::AsPrinted, "diagonals", "is lost");
    for (row, _) in printed.failures() {
        // Brute force goes through all triangles, whatever the lists leave out.
        assert_eq!(row.walk, Walk::List, "{printed}");
    }
    // Beside lists of two sides, the comparison of sides says so too.
    let both = [with(Cull::None), with(Cull::AsPrinted)].concat();
    let listed: Vec<_> = both.into_iter().filter(|row| row.walk == Walk::List).collect();
    let report = run_on_cpu(&["diagonals"], &listed);
    demand_caught(&report, Cull::AsPrinted, "diagonals", "sees a front first");
    demand_caught(&report, Cull::AsPrinted, "diagonals", "lacks the hit of a front");
    assert!(report.failures().all(|(row, _)| row.structure.is_one_sided()), "{report}");
}

#[test]
fn sides_that_are_mixed_up_are_caught() {
    must_be_caught(Fault::HitsBacks, "soup", one_sided(), "does not meet the triangle");
    must_be_caught(Fault::HitsBacks, "sphere", one_sided(), "against brute-force");
    must_be_caught(Fault::HitsBacksAlone, "soup", one_sided(), "is lost");
    must_be_caught(Fault::HitsBacksAlone, "sphere", one_sided(), "comes into a closed mesh unseen");
    must_be_caught(Fault::MirroredNotTurned, "placed", one_sided(), "is lost");
    // Of two sides there is nothing to mix up.
    assert!(run("soup", Fault::HitsBacksAlone, ListOptions::default()).is_passed());
}

#[test]
fn escape_indices_one_too_long_are_caught() {
    must_be_caught(Fault::EscapesOneTooLong, "soup", ListOptions::default(), "is lost");
    must_be_caught(Fault::EscapesOneTooLong, "soup", one_sided(), "is lost");
    must_be_caught(Fault::EscapesOneTooLong, "placed", layered(), "is lost");
}

#[test]
fn layers_that_forget_the_ray_parameter_are_caught() {
    must_be_caught(Fault::SecondLayerAnew, "placed", layered(), "there is a certain hit nearer");
    // Every hit is right; only the counters show these.
    must_be_caught(Fault::SecondLayerForgets, "placed", layered(), "one after the other they do");
    must_be_caught(Fault::SecondLayerAlways, "placed", layered(), "one after the other they do");
    let one = ListOptions { moving: None, ..layered() };
    assert!(run("placed", Fault::SecondLayerForgets, one).is_passed());
}

#[test]
fn heads_that_are_not_for_the_ray_are_caught() {
    for heads in [Heads::Simple, Heads::Regular] {
        let options = with_heads(heads);
        must_be_caught(
            Fault::HeadsASubtreeOn,
            "soup",
            options,
            "from surfaces: from heads against brute force",
        );
        must_be_caught(
            Fault::HeadsForBacks,
            "soup",
            options,
            "from surfaces: from heads against brute force",
        );
        must_be_caught(Fault::HeadsUnused, "sphere", options, "from its heads there are");
        must_be_caught(Fault::NoHeadUnknown, "sphere", options, "from its heads there are 0");
    }
    let options = with_heads(Heads::Regular);
    must_be_caught(Fault::HeadsOfAnotherList, "soup", options, "from heads against brute force");
    // Cameras alone.
    let cameras = ListOptions { frustum_grid: 4, ..ListOptions::default() };
    must_be_caught(Fault::HeadsASubtreeOn, "soup", cameras, "seen from outside: from heads against");
    must_be_caught(Fault::HeadsASubtreeOn, "soup", cameras, "seen from within: from heads against");
    must_be_caught(Fault::HeadsOfAnotherList, "soup", cameras, "seen from outside: from heads against");
    // Two layers, of which the second begins behind the first's heads.
    let options = ListOptions { moving: Some(5), ..options };
    must_be_caught(Fault::HeadsASubtreeOn, "placed", options, "from heads against brute force");
}

/// What a device does not offer is not asked of it, and is not said to have been.
#[test]
fn a_device_without_heads_is_not_blamed() {
    struct Without(Broken);
    impl Device for Without {
        fn prepare(&mut self, structure: &Structure) -> Result<(), String> {
            self.0.prepare(structure)
        }

        fn trace(
            &mut self,
            walk: Walk,
            query: Query,
            rays: &[Ray],
            options: TraceOptions,
        ) -> Result<Traced, String> {
            self.0.trace(walk, query, rays, options)
        }
    }
    let rows = list_rows(with_heads(Heads::Regular));
    let suite = Suite::of(vec![Case::named("soup").unwrap()], Accuracy::Exact);
    let broken = Broken { fault: Fault::HeadsASubtreeOn, list: None };
    let report = suite.run(&rows, &mut Without(broken), &mut |_, _| {});
    assert!(report.is_passed(), "{report}");
    assert!(report.rows.iter().all(|row| row.from_heads == 0));
}
