//! A direct solver for few particles: the Cholesky factor of a sparse matrix of 3×3 blocks, within its envelope.
//!
//! A row of the factor is zero before the first entry of that row in the matrix, so nothing else is stored or worked out
//! (George and Liu, "Computer Solution of Large Sparse Positive Definite Systems", 1981, 4). Rows are in reverse
//! Cuthill–McKee order, from a node that is far from others, which keeps entries near the diagonal (the same, 4.3 and 4.4).
//! Sums are of parts in a fixed order, the same at every level of vector instructions.

use std::ops::Range;

use glam::{DMat3, DVec3};

use crate::physics::kernels::SimdLevel;

/// Partial sums of a sum.
const PARTIAL_SUMS: usize = 4;

/// A pivot below this share of its diagonal is rounding error; the diagonal takes its place.
const MIN_PIVOT_SHARE: f64 = 1e-14;

/// The most searches for a node that is further from others.
const MAX_START_SEARCHES: usize = 8;

/// A node that has no place in the order yet.
const UNPLACED: u32 = u32::MAX;

/// The nodes of a matrix, and which of them share an entry.
#[derive(Clone, Debug, Default)]
struct Graph {
    /// Both directions of every pair, in order.
    pairs: Vec<[u32; 2]>,
    /// Where the pairs of each node begin, and where those of the last end.
    starts: Vec<usize>,
}

impl Graph {
    /// Forgets pairs given twice, and finds where those of each of so many nodes are.
    fn finish(&mut self, nodes: usize) {
        self.pairs.sort_unstable();
        self.pairs.dedup();
        self.starts.clear();
        self.starts.resize(nodes + 1, 0);
        for [node, _] in &self.pairs {
            self.starts[*node as usize + 1] += 1;
        }
        for node in 0..nodes {
            self.starts[node + 1] += self.starts[node];
        }
    }

    fn neighbours(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        self.pairs[self.starts[node as usize]..self.starts[node as usize + 1]].iter().map(|pair| pair[1])
    }

    fn degree(&self, node: u32) -> usize {
        self.starts[node as usize + 1] - self.starts[node as usize]
    }
}

/// The order of nodes, and the workspace for it.
#[derive(Clone, Debug, Default)]
struct Order {
    /// The nodes that are placed, first to last, ...
    nodes: Vec<u32>,
    /// ... and by node its place, or its distance from the start of a search.
    place_of: Vec<u32>,
}

impl Order {
    /// Appends all nodes that can be reached from a node, nearest first, and of those equally near those with few neighbours
    /// first. Returns the distance of the last, in steps.
    fn append_from(&mut self, graph: &Graph, start: u32) -> u32 {
        let Self { nodes, place_of } = self;
        let mut next = nodes.len();
        nodes.push(start);
        place_of[start as usize] = 0;
        while let Some(&node) = nodes.get(next) {
            let (first, distance) = (nodes.len(), place_of[node as usize] + 1);
            for neighbour in graph.neighbours(node) {
                if place_of[neighbour as usize] == UNPLACED {
                    place_of[neighbour as usize] = distance;
                    nodes.push(neighbour);
                }
            }
            nodes[first..].sort_unstable_by_key(|node| (graph.degree(*node), *node));
            next += 1;
        }
        nodes.last().map_or(0, |last| place_of[*last as usize])
    }

    /// Orders all nodes of a graph.
    fn find(&mut self, graph: &Graph, count: usize) {
        self.nodes.clear();
        self.place_of.clear();
        self.place_of.resize(count, UNPLACED);
        for node in 0..u32::try_from(count).unwrap_or(UNPLACED) {
            if self.place_of[node as usize] != UNPLACED {
                continue;
            }
            let first = self.nodes.len();
            let (mut start, mut reach) = (node, 0);
            for search in 0..MAX_START_SEARCHES {
                let found = self.append_from(graph, start);
                if search > 0 && found <= reach {
                    break;
                }
                reach = found;
                let furthest = self.nodes[first..].iter().filter(|node| self.place_of[**node as usize] == found);
                start = furthest.copied().min_by_key(|node| graph.degree(*node)).unwrap_or(start);
                self.forget_from(first);
            }
            self.forget_from(first);
            self.append_from(graph, start);
        }
        self.nodes.reverse();
        for (place, node) in (0..).zip(&self.nodes) {
            self.place_of[*node as usize] = place;
        }
    }

    fn forget_from(&mut self, first: usize) {
        for node in self.nodes.drain(first..) {
            self.place_of[node as usize] = UNPLACED;
        }
    }
}

/// A row of three lines, one for each component.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// The first block in it.
    first: u32,
    /// Where its lines begin, one after the other, each up to and with the diagonal block.
    start: usize,
}

impl Row {
    /// Numbers in a line of the row in this place.
    fn line(self, place: usize) -> usize {
        3 * (place + 1 - self.first as usize)
    }

    /// Where in its values a line has blocks, in the row in this place.
    fn blocks(self, place: usize, component: usize, blocks: Range<usize>) -> Range<usize> {
        let line = self.start + component * self.line(place);
        let of = |block: usize| line + 3 * (block - self.first as usize);
        of(blocks.start)..of(blocks.end)
    }
}

/// A symmetric matrix of 3×3 blocks between nodes, and then its factor.
#[derive(Clone, Debug, Default)]
pub(super) struct Envelope {
    graph: Graph,
    order: Order,
    rows: Vec<Row>,
    values: Vec<f64>,
    /// The load by rows, and then the solution.
    solution: Vec<f64>,
}

impl Envelope {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.graph.pairs.clear();
        self.rows.clear();
    }

    /// Lets two nodes share an entry.
    pub(super) fn connect(&mut self, one: u32, other: u32) {
        if one != other {
            self.graph.pairs.extend([[one, other], [other, one]]);
        }
    }

    /// Orders so many nodes. Returns the products that a factor takes.
    pub(super) fn order(&mut self, count: usize) -> u64 {
        self.graph.finish(count);
        self.order.find(&self.graph, count);
        self.rows.clear();
        let mut start = 0;
        let mut products = 0;
        for (place, node) in (0..).zip(&self.order.nodes) {
            let before = self.graph.neighbours(*node).map(|other| self.order.place_of[other as usize]);
            let row = Row { first: before.min().map_or(place, |first| first.min(place)), start };
            let line = row.line(place as usize);
            self.rows.push(row);
            start += 3 * line;
            products += 3 * (line as u64).pow(2) / 2;
        }
        products
    }

    /// Begins a matrix of zeros.
    pub(super) fn begin(&mut self) {
        let numbers = self.rows.last().map_or(0, |row| row.start + 3 * row.line(self.rows.len() - 1));
        self.values.clear();
        self.values.resize(numbers, 0.0);
    }

    /// Adds a block between two nodes, that of `one` by rows; both have been connected. Of a block and its transpose, one is to
    /// be added.
    pub(super) fn add(&mut self, one: u32, other: u32, block: DMat3) {
        let [i, j] = [one, other].map(|node| self.order.place_of[node as usize] as usize);
        let (place, column, block) = if i >= j { (i, j, block) } else { (j, i, block.transpose()) };
        for component in 0..3 {
            let to = self.rows[place].blocks(place, component, column..column + 1);
            for (to, added) in self.values[to].iter_mut().zip(block.row(component).to_array()) {
                *to += added;
            }
        }
    }

    /// Factorises the matrix.
    pub(super) fn factorise(&mut self, level: SimdLevel) {
        let Self { rows, values, .. } = self;
        level.run(
            #[inline(always)]
            || factorise(rows, values),
        );
    }

    /// Writes the solution for a load; both have an entry for every node.
    pub(super) fn solve(&mut self, level: SimdLevel, load: impl Fn(u32) -> DVec3, mut take: impl FnMut(u32, DVec3)) {
        let Self { rows, values, solution, order, .. } = self;
        solution.clear();
        for node in &order.nodes {
            solution.extend(load(*node).to_array());
        }
        level.run(
            #[inline(always)]
            || solve(rows, values, solution),
        );
        for (node, solved) in order.nodes.iter().zip(solution.as_chunks().0) {
            take(*node, DVec3::from_array(*solved));
        }
    }
}

/// Factorises row by row. The diagonal of the factor holds inverses.
#[inline(always)]
fn factorise(rows: &[Row], values: &mut [f64]) {
    for (i, row) in rows.iter().enumerate() {
        let (before, own) = values.split_at_mut(row.start);
        let lines = [0, 1, 2].map(|component| component * row.line(i));
        for j in row.first as usize..i {
            let (other, shared) = (&rows[j], row.first.max(rows[j].first) as usize);
            let count = 3 * (j - shared);
            let mine = lines.map(|line| &own[line + 3 * (shared - row.first as usize)..][..count]);
            let others = [0, 1, 2].map(|component| &before[other.blocks(j, component, shared..j)]);
            let products = products(mine, others);
            let diagonal = [0, 1, 2].map(|component| &before[other.blocks(j, component, j..j + 1)]);
            for (line, products) in lines.into_iter().zip(products) {
                let x = &mut own[line + 3 * (j - row.first as usize)..][..3];
                x[0] = (x[0] - products[0]) * diagonal[0][0];
                x[1] = (x[1] - products[1] - x[0] * diagonal[1][0]) * diagonal[1][1];
                x[2] = (x[2] - products[2] - x[0] * diagonal[2][0] - x[1] * diagonal[2][1]) * diagonal[2][2];
            }
        }
        let end = row.line(i) - 3;
        let mine = lines.map(|line| &own[line..][..end]);
        let products = products(mine, mine);
        for (component, products) in products.into_iter().enumerate() {
            for column in 0..=component {
                let [line, other] = [component, column].map(|of| lines[of] + end);
                let whole = own[line + column];
                let sum = (0..column).fold(products[column], |sum, of| sum + own[line + of] * own[other + of]);
                let left = whole - sum;
                own[line + column] = match () {
                    () if column < component => left * own[other + column],
                    () if left > MIN_PIVOT_SHARE * whole => 1.0 / left.sqrt(),
                    () => 1.0 / whole.sqrt(),
                };
            }
        }
    }
}

/// The inner products of three lines with three others, of one length.
#[inline(always)]
fn products(a: [&[f64]; 3], b: [&[f64]; 3]) -> [[f64; 3]; 3] {
    let mut sums = [[[0.0; PARTIAL_SUMS]; 3]; 3];
    let (a, a_rest) = split(a);
    let (b, b_rest) = split(b);
    let count = a[0].len();
    let (a, b) = (a.map(|line| &line[..count]), b.map(|line| &line[..count]));
    for place in 0..count {
        for c in 0..3 {
            for d in 0..3 {
                for lane in 0..PARTIAL_SUMS {
                    sums[c][d][lane] += a[c][place][lane] * b[d][place][lane];
                }
            }
        }
    }
    let mut products = [[0.0; 3]; 3];
    for c in 0..3 {
        for d in 0..3 {
            let rest = a_rest[c].iter().zip(b_rest[d]).fold(0.0, |sum, (a, b)| sum + a * b);
            let [w, x, y, z] = sums[c][d];
            products[c][d] = ((w + x) + (y + z)) + rest;
        }
    }
    products
}

#[inline(always)]
fn split(lines: [&[f64]; 3]) -> ([&[[f64; PARTIAL_SUMS]]; 3], [&[f64]; 3]) {
    let both = lines.map(|line| line.as_chunks());
    (both.map(|(chunks, _)| chunks), both.map(|(_, rest)| rest))
}

#[inline(always)]
fn solve(rows: &[Row], values: &[f64], solution: &mut [f64]) {
    for (i, row) in rows.iter().enumerate() {
        let (line, first) = (row.line(i), 3 * row.first as usize);
        for c in 0..3 {
            let factors = &values[row.start + c * line..][..=line - 3 + c];
            let (factors, inverse) = (&factors[..factors.len() - 1], factors[factors.len() - 1]);
            let own = first + factors.len();
            let sum = dot(factors, &solution[first..own]);
            solution[own] = (solution[own] - sum) * inverse;
        }
    }
    for (i, row) in rows.iter().enumerate().rev() {
        let (line, first) = (row.line(i), 3 * row.first as usize);
        for c in (0..3).rev() {
            let factors = &values[row.start + c * line..][..=line - 3 + c];
            let (factors, inverse) = (&factors[..factors.len() - 1], factors[factors.len() - 1]);
            let (before, own) = solution.split_at_mut(first + factors.len());
            own[0] *= inverse;
            let own = own[0];
            for (value, factor) in before[first..].iter_mut().zip(factors) {
                *value -= factor * own;
            }
        }
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<PARTIAL_SUMS>();
    let (b, b_rest) = b.as_chunks::<PARTIAL_SUMS>();
    let mut sums = [0.0; PARTIAL_SUMS];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..PARTIAL_SUMS {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest = a_rest.iter().zip(b_rest).fold(0.0, |sum, (a, b)| sum + a * b);
    let [w, x, y, z] = sums;
    ((w + x) + (y + z)) + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    /// A symmetric positive definite matrix between the nodes of a grid, by pairs of them, the larger first.
    struct Matrix {
        nodes: u32,
        blocks: Vec<([u32; 2], DMat3)>,
    }

    fn random_block(rng: &mut Rng) -> DMat3 {
        DMat3::from_cols_array(&[0; 9].map(|_| rng.between(-1.0, 1.0)))
    }

    /// Blocks between neighbours in a box of nodes, which are numbered at random; some are a billion times as stiff.
    fn of_grid(dims: [u32; 3], rng: &mut Rng) -> Matrix {
        let [x, y, z] = dims;
        let nodes = x * y * z;
        let mut numbers: Vec<_> = (0..nodes).collect();
        for place in (1..numbers.len()).rev() {
            let other = usize::try_from(rng.next_u64() % (place as u64 + 1)).expect("small");
            numbers.swap(place, other);
        }
        let number = |at: [u32; 3]| numbers[(at[0] + x * (at[1] + y * at[2])) as usize];
        let mut blocks: Vec<_> = (0..nodes).map(|node| ([node; 2], DMat3::IDENTITY)).collect();
        for at in (0..nodes).map(|place| [place % x, place / x % y, place / x / y]) {
            for axis in (0..3).filter(|axis| at[*axis] + 1 < dims[*axis]) {
                let next = std::array::from_fn(|of| at[of] + u32::from(of == axis));
                let root = random_block(rng) * 10.0_f64.powf(rng.between(0.0, 4.5));
                let block = root * root.transpose();
                let [one, other] = [at, next].map(number);
                blocks.extend([([one; 2], block), ([other; 2], block), ([one, other], -block)]);
            }
        }
        Matrix { nodes, blocks }
    }

    impl Matrix {
        fn envelope(&self) -> (Envelope, u64) {
            let mut envelope = Envelope::default();
            envelope.clear();
            self.blocks.iter().for_each(|([one, other], _)| envelope.connect(*one, *other));
            let products = envelope.order(self.nodes as usize);
            envelope.begin();
            self.blocks.iter().for_each(|([one, other], block)| envelope.add(*one, *other, *block));
            (envelope, products)
        }

        fn times(&self, vector: &[DVec3]) -> Vec<DVec3> {
            let mut product = vec![DVec3::ZERO; vector.len()];
            for ([one, other], block) in &self.blocks {
                let [i, j] = [one, other].map(|node| *node as usize);
                product[i] += *block * vector[j];
                if i != j {
                    product[j] += block.transpose() * vector[i];
                }
            }
            product
        }
    }

    fn solved(envelope: &mut Envelope, level: SimdLevel, load: &[DVec3]) -> Vec<DVec3> {
        let mut solution = vec![DVec3::NAN; load.len()];
        envelope.solve(level, |node| load[node as usize], |node, solved| solution[node as usize] = solved);
        solution
    }

    #[test]
    fn the_factor_solves_the_equations_and_is_the_same_at_every_level() {
        let mut rng = Rng::new(8);
        for dims in [[1, 1, 1], [2, 1, 1], [7, 1, 1], [3, 4, 2], [5, 5, 5], [4, 3, 9]] {
            let matrix = of_grid(dims, &mut rng);
            let wanted: Vec<_> =
                (0..matrix.nodes).map(|_| DVec3::from([0; 3].map(|_| rng.between(-1.0, 1.0)))).collect();
            let load = matrix.times(&wanted);
            let mut bits = Vec::new();
            for level in SimdLevel::ALL {
                let (mut envelope, _) = matrix.envelope();
                envelope.factorise(level);
                let found = solved(&mut envelope, level, &load);
                let left = matrix.times(&found).iter().zip(&load).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
                let size = load.iter().map(|load| load.length()).fold(0.0, f64::max);
                assert!(left < 1e-12 * size, "{dims:?}: {left} of {size}");
                bits.push(found.iter().flat_map(|found| found.to_array().map(f64::to_bits)).collect::<Vec<_>>());
            }
            assert!(bits.iter().all(|of_level| *of_level == bits[0]), "{dims:?}");
        }
    }

    #[test]
    fn a_long_rod_takes_a_narrow_envelope_however_its_nodes_are_numbered() {
        let mut rng = Rng::new(9);
        let [rod, longer] = [[2, 2, 20], [2, 2, 40]].map(|dims| of_grid(dims, &mut rng).envelope().1);
        // A line of a row has at most some ten blocks, of which the products are half the square.
        assert!(rod < 80 * 3 * 30 * 30 / 2, "{rod} products");
        assert!((1.8..2.4).contains(&(longer as f64 / rod as f64)), "{longer} products, not twice {rod}");
    }

    #[test]
    fn what_nothing_resists_keeps_the_factor_positive() {
        // Two nodes on a line resist only along it, and only against each other.
        let along = DMat3::from_diagonal(DVec3::X);
        let blocks = vec![([0; 2], along), ([1; 2], along), ([1, 0], -along), ([0; 2], DMat3::IDENTITY * 1e-20)];
        let blocks = blocks.into_iter().chain([([1; 2], DMat3::IDENTITY * 1e-20)]).collect();
        let (mut envelope, _) = Matrix { nodes: 2, blocks }.envelope();
        envelope.factorise(SimdLevel::Portable);
        for load in [DVec3::X, DVec3::Y, DVec3::new(1.0, -2.0, 3.0)] {
            let loads = [load, load * 0.5];
            let found = solved(&mut envelope, SimdLevel::Portable, &loads);
            let size: f64 = found.iter().zip(&loads).map(|(a, b)| a.dot(*b)).sum();
            assert!(size > 0.0 && size.is_finite(), "{found:?}");
        }
    }

    #[test]
    fn bodies_that_share_nothing_are_solved_for_side_by_side() {
        let mut envelope = Envelope::default();
        envelope.clear();
        assert_eq!(envelope.order(3), 3 * (3 * 9 / 2), "three rows of a block");
        envelope.begin();
        for node in 0..3 {
            envelope.add(node, node, DMat3::from_diagonal(DVec3::splat(f64::from(node + 1))));
        }
        envelope.factorise(SimdLevel::Portable);
        let found = solved(&mut envelope, SimdLevel::Portable, &[DVec3::ONE; 3]);
        let wanted = [1.0, 0.5, 1.0 / 3.0].map(DVec3::splat);
        assert!(found.iter().zip(wanted).all(|(a, b)| a.distance(b) < 1e-15), "{found:?}");
    }
}
