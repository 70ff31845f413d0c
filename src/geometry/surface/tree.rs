//! A tree of boxes over triangles.

use std::ops::Range;

use glam::DVec3;

use crate::math::Aabb;

/// Triangles in a leaf.
const LEAF_TRIANGLES: usize = 4;

/// The deepest level: every level halves the number of triangles.
const MAX_DEPTH: usize = 48;

/// A tree over triangles that are in the order of its leaves. The first child of a node comes right after it.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb<f64>,
    /// The triangles below it.
    first: u32,
    count: u32,
    /// The second child; 0 in a leaf.
    second: u32,
}

impl Tree {
    /// Orders triangles, given by their corners, and builds the tree over that order.
    pub(super) fn new(corners: &[[DVec3; 3]]) -> (Self, Vec<u32>) {
        let mut order: Vec<u32> = (0..).take(corners.len()).collect();
        let mut tree = Self::default();
        if !order.is_empty() {
            tree.build(corners, &mut order, 0);
        }
        (tree, order)
    }

    fn build(&mut self, corners: &[[DVec3; 3]], order: &mut [u32], first: u32) {
        let all = || order.iter().map(|triangle| corners[*triangle as usize]);
        let bounds = Aabb::<f64>::around(all().flatten());
        let count = u32::try_from(order.len()).unwrap_or(u32::MAX);
        let place = self.nodes.len();
        self.nodes.push(Node { bounds, first, count, second: 0 });
        if order.len() <= LEAF_TRIANGLES {
            return;
        }
        let middle = |triangle: u32| corners[triangle as usize].into_iter().sum::<DVec3>();
        let spread = Aabb::<f64>::around(order.iter().map(|triangle| middle(*triangle))).size();
        let axis = (0..3).reduce(|best, axis| if spread[axis] > spread[best] { axis } else { best }).unwrap_or(0);
        let half = order.len() / 2;
        order.select_nth_unstable_by(half, |a, b| middle(*a)[axis].total_cmp(&middle(*b)[axis]).then_with(|| a.cmp(b)));
        let (low, high) = order.split_at_mut(half);
        self.build(corners, low, first);
        self.nodes[place].second = u32::try_from(self.nodes.len()).unwrap_or(u32::MAX);
        self.build(corners, high, first + count / 2);
    }

    /// The bytes that it takes.
    pub(super) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }

    /// Calls `visit` with the triangles of leaves, nearer boxes first. `entry` gives the distance of a box; boxes without
    /// one, or beyond the limit, are skipped. The limit becomes what `visit` returns.
    pub(super) fn walk(
        &self,
        mut limit: f64,
        entry: impl Fn(&Aabb<f64>) -> Option<f64>,
        mut visit: impl FnMut(Range<usize>, f64) -> f64,
    ) {
        let mut waiting = [(0_u32, 0.0_f64); MAX_DEPTH];
        let mut depth = 0;
        let Some(root) = self.nodes.first() else { return };
        let Some(near) = entry(&root.bounds) else { return };
        let mut next = Some((0_u32, near));
        loop {
            let Some((place, near)) = next.take() else {
                if depth == 0 {
                    return;
                }
                depth -= 1;
                next = Some(waiting[depth]);
                continue;
            };
            if near > limit {
                continue;
            }
            let node = &self.nodes[place as usize];
            if node.second == 0 {
                let first = node.first as usize;
                limit = visit(first..first + node.count as usize, limit);
                continue;
            }
            let children = [place + 1, node.second].map(|child| (child, entry(&self.nodes[child as usize].bounds)));
            let wanted =
                |(child, near): (u32, Option<f64>)| near.filter(|near| *near <= limit).map(|near| (child, near));
            next = match children.map(wanted) {
                [Some(a), Some(b)] => {
                    let (nearer, farther) = if b.1 < a.1 { (b, a) } else { (a, b) };
                    waiting[depth] = farther;
                    depth += 1;
                    Some(nearer)
                }
                [a, b] => a.or(b),
            };
        }
    }
}
