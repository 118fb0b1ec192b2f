//! Subtrees that are built apart, perhaps by several threads, and laid out in depth-first order at the end.

use crate::kd_tree::KdNode;

/// A subtree on its way.
pub(super) enum Subtree {
    /// Nodes in depth-first order, links counted from the first of them, and the references of their leaves.
    Whole(Layout),
    /// Two subtrees under one node.
    Split {
        axis: usize,
        split: f32,
        /// The lower one first.
        children: Box<[Subtree; 2]>,
    },
}

/// Nodes and references in depth-first order.
#[derive(Default)]
pub(super) struct Layout {
    pub(super) nodes: Vec<KdNode>,
    pub(super) references: Vec<u32>,
    /// How many of the references are passive.
    pub(super) passive: usize,
}

impl Subtree {
    /// How many nodes and references there are.
    fn lens(&self) -> [usize; 2] {
        match self {
            Self::Whole(layout) => [layout.nodes.len(), layout.references.len()],
            Self::Split { children, .. } => {
                let [low, high] = [children[0].lens(), children[1].lens()];
                [1 + low[0] + high[0], low[1] + high[1]]
            }
        }
    }

    /// All of it in depth-first order. `Err` with what there are too many of, and how many, where 30 bits do not count the
    /// nodes, or 32 the references.
    pub(super) fn into_layout(self) -> Result<Layout, (&'static str, usize)> {
        let [nodes, references] = self.lens();
        if nodes >= KdNode::LIMIT {
            return Err(("nodes of a kd-tree", nodes));
        }
        if references >= u32::MAX as usize {
            return Err(("references of a kd-tree", references));
        }
        let mut layout = match self {
            Self::Whole(layout) => layout,
            split @ Self::Split { .. } => {
                let mut layout = Layout {
                    nodes: Vec::with_capacity(nodes),
                    references: Vec::with_capacity(references),
                    passive: 0,
                };
                split.append_to(&mut layout);
                layout
            }
        };
        layout.nodes.shrink_to_fit();
        layout.references.shrink_to_fit();
        Ok(layout)
    }

    fn append_to(self, layout: &mut Layout) {
        match self {
            Self::Whole(whole) => {
                let (node_base, reference_base) = (layout.nodes.len() as u32, layout.references.len() as u32);
                layout.nodes.extend(whole.nodes.iter().map(|node| {
                    if node.is_leaf() {
                        KdNode::leaf(node.first() + reference_base, node.count())
                    } else {
                        KdNode::inner(node.axis(), node.split(), node.upper() + node_base)
                    }
                }));
                layout.references.extend_from_slice(&whole.references);
                layout.passive += whole.passive;
            }
            Self::Split { axis, split, children } => {
                let [low, high] = *children;
                let node = layout.nodes.len();
                layout.nodes.push(KdNode::inner(axis, split, 0));
                low.append_to(layout);
                layout.nodes[node] = KdNode::inner(axis, split, layout.nodes.len() as u32);
                high.append_to(layout);
            }
        }
    }
}
