//! All trees of a run of samples at once, a generation at a time: a batch of rays is traced, the places it found are
//! worked out in parallel, their rays to lights are one batch, and their mirrored and refracted rays the next generation.
//!
//! Every addend is kept with its node, and nodes know their children; at the end each sample adds its own depth first.
//! A run whose nodes would take more than [`MOST_ADDENDS`] is done again in two halves, down to one sample.

use super::node::{Kind, Node};
use super::{Followed, Root, Tally, Tree, TreeRay, batches};
use crate::error::RenderError;
use crate::looks::layout::NOTHING;
use crate::tracing::Tracing;
use glam::Vec3;
use rayon::prelude::*;
use ropewalk::{Hit, Status};

/// Samples in a run: enough to keep a device busy.
const RUN: usize = 1 << 16;
/// Addends of a run, about 100 MB with their nodes and rays.
const MOST_ADDENDS: usize = 1 << 22;

/// A node with its addends: its own light, then that of its rays to lights and into the sky.
#[derive(Clone, Copy)]
struct Kept {
    sample: u32,
    first: u32,
    addends: u32,
    /// The nodes of the mirrored and of the refracted ray.
    children: [u32; 2],
}

/// A ray of the next generation, and the node and the side of it that waits for it.
#[derive(Clone, Copy)]
struct Waiting {
    ray: TreeRay,
    node: u32,
}

/// The trees of a run.
struct Forest<'a> {
    tree: &'a Tree<'a>,
    tracing: &'a Tracing<'a>,
    roots: &'a [Root],
    nodes: Vec<Kept>,
    addends: Vec<Vec3>,
    is_broken: Vec<bool>,
    tally: Tally,
    /// Addends and nodes beyond which the forest is too large.
    most: usize,
}

impl Forest<'_> {
    /// Adds a generation, given its rays and what they have found; returns the next. `None` when it grows too large.
    fn generation(
        &mut self,
        rays: &[Waiting],
        hits: &[Hit],
        status: &[Status],
    ) -> Result<Option<Vec<Waiting>>, RenderError> {
        let samples: Vec<u32> = rays.iter().map(|waiting| self.nodes[waiting.node as usize].sample).collect();
        let grown: Vec<Option<Node>> = (0..rays.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|index| {
                let (root, ray) = (&self.roots[samples[index] as usize], &rays[index].ray);
                let mut node = Node::default();
                if !status[index].is_complete() {
                    return None;
                }
                if !hits[index].is_hit() {
                    node.own = self.tree.missed(&root.sample, ray);
                    return Some(node);
                }
                self.tree.grow(&root.sample, ray, &hits[index], &mut node).then_some(node)
            })
            .collect();
        let mut next = Vec::new();
        let mut asked = Vec::new();
        let mut places = Vec::new();
        for (index, grown) in grown.into_iter().enumerate() {
            let node = rays[index].node as usize;
            let Some(grown) = grown else {
                self.is_broken[samples[index] as usize] = true;
                self.tally.incomplete.count_lost(u64::from(status[index].is_complete()));
                continue;
            };
            self.tally.cut_by_depth += u64::from(grown.cut_by_depth);
            self.tally.cut_by_weight += u64::from(grown.cut_by_weight);
            self.nodes[node].first = self.addends.len() as u32;
            self.addends.push(grown.own);
            for ray in grown.rays {
                if ray.kind.is_occlusion() {
                    asked.push(ray);
                    places.push((self.addends.len(), samples[index]));
                    self.addends.push(Vec3::ZERO);
                    continue;
                }
                let child = self.nodes.len() as u32;
                let side = usize::from(ray.kind == Kind::Refracted);
                self.nodes[node].children[side] = child;
                self.nodes.push(Kept {
                    sample: samples[index],
                    first: 0,
                    addends: 0,
                    children: [NOTHING; 2],
                });
                next.push(Waiting { ray, node: child });
            }
            self.nodes[node].addends = self.addends.len() as u32 - self.nodes[node].first;
            if self.addends.len() + self.nodes.len() > self.most && self.roots.len() > 1 {
                return Ok(None);
            }
        }
        self.ask(&asked, &places)?;
        Ok(Some(next))
    }

    /// Asks lights and the sky whether they arrive.
    fn ask(&mut self, rays: &[TreeRay], places: &[(usize, u32)]) -> Result<(), RenderError> {
        if rays.is_empty() {
            return Ok(());
        }
        let (light, status) = batches::arriving(self.tracing, rays, &mut self.tally)?;
        for (index, ray) in rays.iter().enumerate() {
            let (addend, sample) = places[index];
            self.tally.count(ray.kind);
            self.tally.incomplete.count(status[index]);
            self.is_broken[sample as usize] |= !status[index].is_complete();
            self.addends[addend] = light[index];
        }
        Ok(())
    }

    /// Grows all trees. False when they are too large.
    fn grow(&mut self) -> Result<bool, RenderError> {
        let mut rays: Vec<Waiting> = Vec::with_capacity(self.roots.len());
        for (index, root) in self.roots.iter().enumerate() {
            self.nodes.push(Kept { sample: index as u32, first: 0, addends: 0, children: [NOTHING; 2] });
            rays.push(Waiting { ray: TreeRay::primary(root.ray), node: index as u32 });
        }
        let mut hits: Vec<Hit> = self.roots.iter().map(|root| root.hit).collect();
        let mut status = vec![Status::COMPLETE; rays.len()];
        while let Some(next) = self.generation(&rays, &hits, &status)? {
            if next.is_empty() {
                return Ok(true);
            }
            let asked: Vec<TreeRay> = next.iter().map(|waiting| waiting.ray).collect();
            (hits, status) = batches::closest(self.tracing, &asked)?;
            for (ray, &status) in asked.iter().zip(&status) {
                self.tally.count(ray.kind);
                self.tally.incomplete.count(status);
            }
            rays = next;
        }
        Ok(false)
    }

    /// The sum of a sample's addends, depth first.
    fn sum(&self, sample: usize, waiting: &mut Vec<u32>) -> Vec3 {
        let mut sum = Vec3::ZERO;
        waiting.clear();
        waiting.push(sample as u32);
        while let Some(node) = waiting.pop() {
            let node = &self.nodes[node as usize];
            let first = node.first as usize;
            for addend in &self.addends[first..first + node.addends as usize] {
                sum += *addend;
            }
            let [mirrored, refracted] = node.children;
            waiting.extend([refracted, mirrored].into_iter().filter(|&child| child != NOTHING));
        }
        sum
    }
}

fn follow_run(
    tree: &Tree<'_>,
    tracing: &Tracing<'_>,
    roots: &[Root],
    most: usize,
    all: &mut Vec<Followed>,
    tally: &mut Tally,
) -> Result<(), RenderError> {
    let mut forest = Forest {
        tree,
        tracing,
        roots,
        nodes: Vec::new(),
        addends: Vec::new(),
        is_broken: vec![false; roots.len()],
        tally: Tally::default(),
        most,
    };
    if !forest.grow()? {
        drop(forest);
        let (first, second) = roots.split_at(roots.len() / 2);
        follow_run(tree, tracing, first, most, all, tally)?;
        return follow_run(tree, tracing, second, most, all, tally);
    }
    tally.add(&forest.tally);
    let forest = &forest;
    let sums = (0..roots.len()).into_par_iter().with_min_len(256).map_init(Vec::new, |waiting, sample| {
        Followed { color: forest.sum(sample, waiting), is_broken: forest.is_broken[sample] }
    });
    all.par_extend(sums);
    Ok(())
}

pub(super) fn follow(
    tree: &Tree<'_>,
    tracing: &Tracing<'_>,
    roots: &[Root],
) -> Result<(Vec<Followed>, Tally), RenderError> {
    follow_within(tree, tracing, roots, MOST_ADDENDS)
}

/// Follows trees of which those that are followed together have no more addends and nodes than `most`, if they are many.
pub(super) fn follow_within(
    tree: &Tree<'_>,
    tracing: &Tracing<'_>,
    roots: &[Root],
    most: usize,
) -> Result<(Vec<Followed>, Tally), RenderError> {
    let mut all = Vec::with_capacity(roots.len());
    let mut tally = Tally::default();
    for run in roots.chunks(RUN) {
        follow_run(tree, tracing, run, most, &mut all, &mut tally)?;
    }
    Ok((all, tally))
}
