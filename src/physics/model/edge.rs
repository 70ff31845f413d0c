//! The edges of obstacles: where bodies may meet an obstacle between their particles.

use glam::DVec3;

use crate::math::Aabb;

/// Points on the edges of obstacles are numbered from here on, where points of bodies' meshes have numbers, too. Numbers are those
/// of one body, and hold as long as its cells and the obstacle's form.
pub(in crate::physics) const FIRST_EDGE_POINT: usize = 1 << 30;

/// A stretch of points on an obstacle that meet the cells of bodies, in the obstacle's own axes about its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct Edge {
    /// Where it begins and ends, m.
    pub(in crate::physics) ends: [DVec3; 2],
    /// The way out of the obstacle, of length 1; zero where it is not known.
    pub(in crate::physics) outward: DVec3,
    /// The number of its first point among all of the obstacle.
    pub(in crate::physics) first: usize,
    /// How many points it has, each in the middle of a part of equal length.
    pub(in crate::physics) count: usize,
}

/// All edges of an obstacle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::physics) struct Edges {
    all: Vec<Edge>,
    /// For every group of them the place after its last, the middle of a ball around it, and the ball's radius, m.
    balls: Vec<(usize, DVec3, f64)>,
}

/// Edges that are left out together where they are far away, at most.
const GROUP: usize = 16;

impl Edges {
    /// Some edges, each given by its ends, the way out and the number of points. Edges near each other follow one another.
    pub(in crate::physics) fn new(mut all: Vec<Edge>) -> Self {
        let mut balls = Vec::new();
        group(&mut all, &mut balls);
        let mut next = 0;
        for edge in &mut all {
            edge.first = next;
            next += edge.count;
        }
        Self { all, balls }
    }

    /// Whether there are none.
    pub(in crate::physics) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// How many points are on them.
    pub(in crate::physics) fn point_count(&self) -> usize {
        self.all.last().map_or(0, |last| last.first + last.count)
    }

    /// The edges that may be near: those of groups whose ball `is_near`, given its middle and its radius.
    pub(in crate::physics) fn near(&self, is_near: impl Fn(DVec3, f64) -> bool) -> impl Iterator<Item = &Edge> {
        let begins = std::iter::once(0).chain(self.balls.iter().map(|ball| ball.0));
        let groups = begins.zip(&self.balls).filter(move |(_, (_, middle, radius))| is_near(*middle, *radius));
        groups.flat_map(|(begin, (end, ..))| &self.all[begin..*end])
    }
}

/// Sorts edges into groups: halves them along the longest side of the box around their middles until few are left.
fn group(edges: &mut [Edge], balls: &mut Vec<(usize, DVec3, f64)>) {
    let end_of_last = |balls: &[(usize, DVec3, f64)]| balls.last().map_or(0, |ball| ball.0);
    if edges.len() > GROUP {
        let middle = |edge: &Edge| 0.5 * (edge.ends[0] + edge.ends[1]);
        let size = Aabb::<f64>::around(edges.iter().map(middle)).size();
        let axis = (0..3).fold(0, |longest, axis| if size[axis] > size[longest] { axis } else { longest });
        edges.sort_by(|one, other| middle(one)[axis].total_cmp(&middle(other)[axis]));
        let (low, high) = edges.split_at_mut(edges.len() / 2);
        group(low, balls);
        group(high, balls);
    } else if !edges.is_empty() {
        let around: Aabb<f64> = Aabb::around(edges.iter().flat_map(|edge| edge.ends));
        balls.push((end_of_last(balls) + edges.len(), around.center(), 0.5 * around.size().length()));
    }
}
