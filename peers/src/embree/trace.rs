//! Rays, one by one and in packets, in both versions' ways.

use super::abi::{
    self, Arguments4, Context3, INVALID, Queries, RtcRay, RtcRayHit, RtcRayHits, RtcRays, Valid,
};
use ropewalk::glam::Vec2;
use ropewalk::{Hit, Ray};
use ropewalk_lab::arena::{Mode, Packet, RaySet};
use std::ops::Range;
use std::ptr::null_mut;

/// The closest hits of a range of rays.
///
/// # Safety
/// The scene is alive and committed, and the queries are its library's.
pub(super) unsafe fn closest(
    queries: &Queries,
    scene: abi::Scene,
    mode: Mode,
    set: &RaySet,
    range: Range<usize>,
    hits: &mut [Hit],
) {
    let mut arguments = Arguments4::coherent();
    let mut context = Context3::new(mode.is_packet());
    // SAFETY: of all calls: the scene is alive by the caller's word, and the memory is laid out as the headers say.
    match (queries, mode) {
        (Queries::Four(q), Mode::Packet8) => packets(&set.packets8, range, hits, |valid, packet| {
            // SAFETY: as above.
            unsafe { (q.intersect8)(valid, scene, packet, &mut arguments) };
        }),
        (Queries::Four(q), Mode::Packet16) => packets(&set.packets16, range, hits, |valid, packet| {
            // SAFETY: as above.
            unsafe { (q.intersect16)(valid, scene, packet, &mut arguments) };
        }),
        (Queries::Four(q), _) => singles(&set.rays, range, hits, |ray| {
            // SAFETY: as above.
            unsafe { (q.intersect1)(scene, ray, null_mut()) };
        }),
        (Queries::Three(q), Mode::Packet8) => packets(&set.packets8, range, hits, |valid, packet| {
            // SAFETY: as above.
            unsafe { (q.intersect8)(valid, scene, &mut context, packet) };
        }),
        (Queries::Three(q), Mode::Packet16) => packets(&set.packets16, range, hits, |valid, packet| {
            // SAFETY: as above.
            unsafe { (q.intersect16)(valid, scene, &mut context, packet) };
        }),
        (Queries::Three(q), _) => singles(&set.rays, range, hits, |ray| {
            // SAFETY: as above.
            unsafe { (q.intersect1)(scene, &mut context, ray) };
        }),
    }
}

/// Whether each ray of a range hits anything.
///
/// # Safety
/// As for [`closest`].
pub(super) unsafe fn any(
    queries: &Queries,
    scene: abi::Scene,
    mode: Mode,
    set: &RaySet,
    range: Range<usize>,
    hits: &mut [bool],
) {
    let mut arguments = Arguments4::coherent();
    let mut context = Context3::new(mode.is_packet());
    // SAFETY: of all calls: as in `closest`.
    match (queries, mode) {
        (Queries::Four(q), Mode::Packet8) => {
            any_packets(&set.packets8, range, hits, |valid, packet| {
                // SAFETY: as above.
                unsafe { (q.occluded8)(valid, scene, packet, &mut arguments) };
            });
        }
        (Queries::Four(q), Mode::Packet16) => {
            any_packets(&set.packets16, range, hits, |valid, packet| {
                // SAFETY: as above.
                unsafe { (q.occluded16)(valid, scene, packet, &mut arguments) };
            });
        }
        (Queries::Four(q), _) => any_singles(&set.rays, range, hits, |ray| {
            // SAFETY: as above.
            unsafe { (q.occluded1)(scene, ray, null_mut()) };
        }),
        (Queries::Three(q), Mode::Packet8) => {
            any_packets(&set.packets8, range, hits, |valid, packet| {
                // SAFETY: as above.
                unsafe { (q.occluded8)(valid, scene, &mut context, packet) };
            });
        }
        (Queries::Three(q), Mode::Packet16) => {
            any_packets(&set.packets16, range, hits, |valid, packet| {
                // SAFETY: as above.
                unsafe { (q.occluded16)(valid, scene, &mut context, packet) };
            });
        }
        (Queries::Three(q), _) => any_singles(&set.rays, range, hits, |ray| {
            // SAFETY: as above.
            unsafe { (q.occluded1)(scene, &mut context, ray) };
        }),
    }
}

#[inline(always)]
fn rtc_ray(ray: &Ray) -> RtcRay {
    RtcRay {
        origin: ray.origin.to_array(),
        t_near: ray.t_min,
        dir: ray.dir.to_array(),
        time: 0.0,
        t_far: ray.t_max,
        mask: u32::MAX,
        id: 0,
        flags: 0,
    }
}

#[inline(always)]
fn hit(t: f32, u: f32, v: f32, primitive: u32, geometry: u32, instance: u32) -> Hit {
    if geometry == INVALID {
        return Hit::MISS;
    }
    Hit {
        t,
        barycentrics: Vec2::new(u, v),
        primitive_index: primitive,
        geometry_index: 0,
        instance_index: if instance == INVALID { 0 } else { instance },
        front_face: false,
    }
}

#[inline(always)]
fn singles(rays: &[Ray], range: Range<usize>, hits: &mut [Hit], mut trace: impl FnMut(&mut RtcRayHit)) {
    let Some(rays) = rays.get(range) else { return };
    for (ray, out) in rays.iter().zip(hits) {
        let mut both = RtcRayHit {
            ray: rtc_ray(ray),
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: INVALID,
            geometry: INVALID,
            instance: INVALID,
            instance_primitive: INVALID,
        };
        trace(&mut both);
        *out = hit(both.ray.t_far, both.u, both.v, both.primitive, both.geometry, both.instance);
    }
}

#[inline(always)]
fn any_singles(rays: &[Ray], range: Range<usize>, hits: &mut [bool], mut trace: impl FnMut(&mut RtcRay)) {
    let Some(rays) = rays.get(range) else { return };
    for (ray, out) in rays.iter().zip(hits) {
        let mut ray = rtc_ray(ray);
        trace(&mut ray);
        // What is occluded ends at minus infinity.
        *out = ray.t_far < 0.0;
    }
}

#[inline(always)]
fn rtc_rays<const N: usize>(packet: &Packet<N>) -> RtcRays<N> {
    RtcRays {
        origin: packet.origin,
        t_near: packet.t_min,
        dir: packet.dir,
        time: [0.0; N],
        t_far: packet.t_max,
        mask: [u32::MAX; N],
        id: [0; N],
        flags: [0; N],
    }
}

#[inline(always)]
fn valid<const N: usize>(packet: &Packet<N>) -> Valid<N> {
    Valid(std::array::from_fn(|lane| if lane < packet.count { -1 } else { 0 }))
}

/// The packets of a range that begins at one.
fn of_range<const N: usize>(packets: &[Packet<N>], range: Range<usize>) -> &[Packet<N>] {
    packets.get(range.start / N..range.end.div_ceil(N)).unwrap_or_default()
}

#[inline(always)]
fn packets<const N: usize>(
    packets: &[Packet<N>],
    range: Range<usize>,
    hits: &mut [Hit],
    mut trace: impl FnMut(&Valid<N>, &mut RtcRayHits<N>),
) {
    for (packet, out) in of_range(packets, range).iter().zip(hits.chunks_mut(N)) {
        let mut both = RtcRayHits {
            rays: rtc_rays(packet),
            normal: [[0.0; N]; 3],
            u: [0.0; N],
            v: [0.0; N],
            primitive: [INVALID; N],
            geometry: [INVALID; N],
            instance: [INVALID; N],
            instance_primitive: [INVALID; N],
        };
        trace(&valid(packet), &mut both);
        for (lane, out) in out.iter_mut().enumerate() {
            let (t, geometry) = (both.rays.t_far[lane], both.geometry[lane]);
            *out = hit(t, both.u[lane], both.v[lane], both.primitive[lane], geometry, both.instance[lane]);
        }
    }
}

#[inline(always)]
fn any_packets<const N: usize>(
    packets: &[Packet<N>],
    range: Range<usize>,
    hits: &mut [bool],
    mut trace: impl FnMut(&Valid<N>, &mut RtcRays<N>),
) {
    for (packet, out) in of_range(packets, range).iter().zip(hits.chunks_mut(N)) {
        let mut rays = rtc_rays(packet);
        trace(&valid(packet), &mut rays);
        out.iter_mut().zip(&rays.t_far).for_each(|(out, &t_far)| *out = t_far < 0.0);
    }
}
