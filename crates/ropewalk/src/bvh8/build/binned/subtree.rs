//! Subtrees that were built apart, and how they become one tree.

use crate::bvh8::build::draft::{Collapse, Costs, Draft};
use crate::bvh8::build::extent::Extent;
use crate::bvh8::tree::{Child, TreeNode};
use crate::memory::with_capacity;

/// A subtree on its way.
pub(super) enum Subtree {
    /// What one thread made.
    Finished(Finished),
    /// Two subtrees.
    Split { bounds: Extent, children: Box<[Subtree; 2]> },
}

/// Nodes that one thread made, and what is still open above them.
pub(super) struct Finished {
    /// The links of inner nodes count from the first of these.
    pub(super) nodes: Vec<TreeNode>,
    /// The splits of which it depends on those above whether they become nodes. What is finished below is one of `nodes`.
    pub(super) crown: Box<[Draft]>,
}

impl Finished {
    /// Of a build that was cancelled, or of nothing.
    pub(super) fn nothing() -> Self {
        Self { nodes: Vec::new(), crown: Box::default() }
    }
}

impl Subtree {
    /// All nodes of the tree.
    pub(super) fn into_nodes(self, costs: Costs) -> Vec<TreeNode> {
        match self {
            Self::Finished(finished) => finished.nodes,
            split @ Self::Split { .. } => {
                let mut top = Top { drafts: Vec::with_capacity(split.len()), ..Top::default() };
                split.draft(&mut top);
                top.into_nodes(costs)
            }
        }
    }

    /// The open splits.
    fn len(&self) -> usize {
        match self {
            Self::Finished(finished) => finished.crown.len(),
            Self::Split { children, .. } => 1 + children.iter().map(Self::len).sum::<usize>(),
        }
    }

    /// Appends the drafts of the splits, and what is below them. As deep as the splits are.
    fn draft(self, top: &mut Top) {
        match self {
            Self::Finished(Finished { nodes, crown }) => {
                let before = top.drafts.len() as u32;
                top.drafts.extend(crown.iter().map(|draft| draft.shifted(before, top.below_len)));
                top.below_len += nodes.len() as u32;
                top.below.push(nodes);
            }
            Self::Split { bounds, children } => {
                let this = top.drafts.len();
                top.drafts.push(Draft::new(&bounds, 0, Draft::MANY));
                let [low, high] = *children;
                low.draft(top);
                let second = top.drafts.len() as u32;
                top.drafts[this].split(second);
                high.draft(top);
            }
        }
    }
}

/// The open splits of the whole tree, and the nodes below them.
#[derive(Default)]
struct Top {
    drafts: Vec<Draft>,
    below: Vec<Vec<TreeNode>>,
    below_len: u32,
}

impl Top {
    fn into_nodes(mut self, costs: Costs) -> Vec<TreeNode> {
        // A node has at least two children.
        let mut nodes = with_capacity(self.below_len as usize + self.drafts.len() / 2);
        let mut collapse = Collapse { drafts: &mut self.drafts, costs };
        collapse.weigh();
        collapse.emit(&mut nodes, |first, count| Child { link: first, count });
        let above = nodes.len() as u32;
        for child in nodes.iter_mut().flat_map(|node| &mut node.children) {
            if child.count == Draft::FINISHED {
                *child = Child::inner(above + child.link);
            }
        }
        for below in self.below {
            let before = nodes.len() as u32;
            nodes.extend(below.into_iter().map(|mut node| {
                for child in &mut node.children {
                    // Nothing below leads to the first node, so that link 0 stays nothing.
                    child.link += if child.count == 0 && child.link > 0 { before } else { 0 };
                }
                node
            }));
        }
        nodes
    }
}
