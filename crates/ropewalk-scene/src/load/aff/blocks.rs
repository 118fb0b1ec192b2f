//! The blocks of a file: animated ones become nodes, static ones lead from one to the next.

use super::budget::Budget;
use super::document::Node;
use super::quaternion::rotation;
use super::tokens::Tokens;
use crate::LoadError;
use glam::{DAffine3, DMat3};
use std::collections::HashMap;

/// How deep blocks may stand in each other; the benchmark's do 15 deep.
const DEEPEST: usize = 256;

/// The innermost animated block, and the way to it through the static blocks inside.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Place {
    pub(super) node: Option<usize>,
    pub(super) to_node: DAffine3,
}

/// Blocks that agree in these always stand in the same place: they are one.
type NodeKey = (Option<usize>, String, [u64; 12]);

/// The open blocks, and the nodes so far.
#[derive(Debug, Default)]
pub(super) struct Blocks {
    here: Place,
    /// For each open block what was around it, and its line.
    open: Vec<(Place, usize)>,
    nodes: Vec<Node>,
    node_of: HashMap<NodeKey, usize>,
}

impl Blocks {
    /// Where a statement stands.
    pub(super) const fn here(&self) -> Place {
        self.here
    }

    /// How many blocks are open.
    pub(super) const fn depth(&self) -> usize {
        self.open.len()
    }

    /// Where the innermost open block begins.
    pub(super) fn innermost_line(&self) -> Option<usize> {
        self.open.last().map(|&(_, line)| line)
    }

    pub(super) fn into_nodes(self) -> Vec<Node> {
        self.nodes
    }

    /// `}`: back to what is around the innermost block.
    pub(super) fn end(&mut self) {
        if let Some((around, _)) = self.open.pop() {
            self.here = around;
        }
    }

    /// `x`: a block that moves as the tracks of its name say.
    pub(super) fn begin_animated(
        &mut self,
        tokens: &mut Tokens<'_>,
        budget: &mut Budget,
    ) -> Result<(), LoadError> {
        let line = tokens.line();
        let name = tokens.name("the name of what moves")?;
        let node = self.node(tokens, name, budget)?;
        self.begin(tokens, line, Place { node: Some(node), to_node: DAffine3::IDENTITY })
    }

    /// `xs`: a block that is scaled, turned and moved.
    pub(super) fn begin_static(&mut self, tokens: &mut Tokens<'_>) -> Result<(), LoadError> {
        let line = tokens.line();
        let (scale, axis) = (tokens.vector()?, tokens.vector()?);
        let (degrees, translation) = (tokens.number()?, tokens.vector()?);
        let linear = rotation(axis, degrees.to_radians()) * DMat3::from_diagonal(scale);
        let to_outside = DAffine3::from_mat3_translation(linear, translation);
        let Place { node, to_node } = self.here;
        self.begin(tokens, line, Place { node, to_node: to_node * to_outside })
    }

    fn begin(&mut self, tokens: &mut Tokens<'_>, line: usize, inside: Place) -> Result<(), LoadError> {
        tokens.expect("{")?;
        if self.open.len() >= DEEPEST {
            return Err(tokens.malformed(format!("blocks are nested more than {DEEPEST} deep, the limit")));
        }
        self.open.push((self.here, line));
        self.here = inside;
        Ok(())
    }

    /// The node of an animated block that begins here.
    fn node(&mut self, tokens: &Tokens<'_>, name: String, budget: &mut Budget) -> Result<usize, LoadError> {
        let Place { node: parent, to_node } = self.here;
        let key = (parent, name, to_node.to_cols_array().map(f64::to_bits));
        if let Some(&node) = self.node_of.get(&key) {
            return Ok(node);
        }
        let name = key.1.clone();
        let around = parent.and_then(|parent| self.nodes.get(parent));
        let path = around.map_or_else(|| name.clone(), |around| format!("{}/{name}", around.path));
        let bytes = size_of::<(Node, NodeKey)>() + 2 * name.len() + path.len();
        budget.take(bytes).map_err(|what| tokens.malformed(what))?;
        self.nodes.push(Node { parent, name, path, to_parent: to_node });
        let node = self.nodes.len() - 1;
        self.node_of.insert(key, node);
        Ok(node)
    }
}
