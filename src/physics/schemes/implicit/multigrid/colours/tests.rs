//! Sweeps by colours compared with sweeps corner by corner.

use super::*;
use crate::math::rng::Rng;
use crate::physics::schemes::implicit::multigrid::parents;

/// Returns half of the corners of a box, and all of them.
fn sets() -> [Vec<[u32; 3]>; 2] {
    let all = || (0..6).flat_map(|z| (0..5).flat_map(move |y| (0..9).map(move |x| [x, y, z])));
    let mut rng = Rng::new(3);
    [all().filter(|_| rng.between(0.0, 1.0) < 0.5).collect(), all().collect()]
}

/// A matrix by pairs of neighbours, with entries that single precision holds exactly, and the inverses of its diagonal
/// blocks.
struct Matrix {
    corners: Vec<[u32; 3]>,
    blocks: Vec<([usize; 2], DMat3)>,
    inverse: Vec<DMat3>,
}

impl Matrix {
    fn random(corners: &[[u32; 3]]) -> Self {
        let mut rng = Rng::new(8);
        let mut random =
            |size: f64| DMat3::from_cols_array(&[0; 9].map(|_| f32::from_f64(rng.between(-size, size)).to_f64()));
        let mut blocks = Vec::new();
        for (row, one) in corners.iter().enumerate() {
            for (column, other) in corners[..row].iter().enumerate() {
                if (0..3).all(|axis| one[axis].abs_diff(other[axis]) <= 1) {
                    blocks.push(([row, column], random(0.1)));
                }
            }
        }
        let inverse = corners.iter().map(|_| DMat3::IDENTITY + random(0.2)).collect();
        Self { corners: corners.to_vec(), blocks, inverse }
    }

    fn colours(&self) -> Colours {
        let mut colours = Colours::new(&self.corners, &parents::coarsened(&self.corners).0);
        for (pair, block) in &self.blocks {
            let [from, to] = pair.map(|number| self.corners[number]);
            let step = (0..3).map(|axis| (1 + to[axis] - from[axis]) as usize * [1, 3, 9][axis]).sum();
            colours.set(*pair, step, block);
        }
        (0..self.corners.len()).for_each(|number| colours.set_inverse(number, &self.inverse[number]));
        colours
    }

    /// Returns what the other corners that `choose` selects do to a corner.
    fn on(&self, number: usize, solution: &[DVec3], choose: impl Fn(usize) -> bool) -> DVec3 {
        self.blocks.iter().fold(DVec3::ZERO, |sum, ([row, column], block)| match () {
            () if *row == number && choose(*column) => sum + *block * solution[*column],
            () if *column == number && choose(*row) => sum + block.transpose() * solution[*row],
            () => sum,
        })
    }

    /// Relaxes the corners one after the other.
    fn relax(&self, load: &[DVec3], solution: &mut [DVec3], is_forth: bool) {
        let colour = |number: usize| colour_of(self.corners[number]);
        let mut order: Vec<usize> = (0..self.corners.len()).collect();
        order.sort_by_key(|number| if is_forth { colour(*number) } else { COLOURS - colour(*number) });
        for number in order {
            solution[number] = self.inverse[number] * (load[number] - self.on(number, solution, |_| true));
        }
    }
}

fn furthest(found: impl Iterator<Item = DVec3>, expected: &[DVec3]) -> f64 {
    found.zip(expected).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
}

/// Returns how far sweeps by colours are from those corner by corner.
fn difference(colours: &mut Colours, matrix: &Matrix) -> f64 {
    let mut rng = Rng::new(5);
    let count = matrix.corners.len();
    let load: Vec<_> = (0..count).map(|_| DVec3::from([0; 3].map(|_| rng.between(-1.0, 1.0)))).collect();
    (0..count).for_each(|number| colours.set_load(number, load[number]));
    colours.sweep_forward();
    let mut solution = vec![DVec3::ZERO; count];
    matrix.relax(&load, &mut solution, true);
    let forth = furthest((0..count).map(|number| colours.solution(number)), &solution);
    let colour = |number: usize| colour_of(matrix.corners[number]);
    let left: Vec<_> =
        (0..count).map(|number| -matrix.on(number, &solution, |other| colour(other) > colour(number))).collect();
    let residual = furthest((0..count).map(|number| colours.at(&colours.residual, number)), &left);
    colours.sweep_backward();
    matrix.relax(&load, &mut solution, false);
    let back = furthest((0..count).map(|number| colours.solution(number)), &solution);
    forth.max(residual).max(back)
}

#[test]
fn sweeps_are_those_corner_by_corner_and_a_wrong_block_is_seen() {
    for corners in sets() {
        let mut matrix = Matrix::random(&corners);
        let mut colours = matrix.colours();
        let off = difference(&mut colours, &matrix);
        assert!(off < 1e-12, "{off} off");
        let middle = matrix.blocks.len() / 2;
        matrix.blocks[middle].1 *= 1.001;
        let off = difference(&mut colours, &matrix);
        assert!(off > 1e-7, "a block that is off by a thousandth: {off}");
    }
}

#[test]
fn what_is_handed_on_and_back_goes_to_the_parents_of_each_corner() {
    for corners in sets() {
        let (coarse, parents) = parents::coarsened(&corners);
        let matrix = Matrix::random(&corners);
        let mut colours = matrix.colours();
        let mut coarser = Colours::new(&coarse, &[]);
        difference(&mut colours, &matrix);
        let left: Vec<_> = (0..corners.len()).map(|number| colours.at(&colours.residual, number)).collect();
        colours.restrict(&mut coarser);
        let mut expected = vec![DVec3::ZERO; coarse.len()];
        for (number, left) in left.iter().enumerate() {
            let (on, weight) = parents.of(number);
            for parent in on {
                expected[*parent as usize] += *left * weight;
            }
        }
        let off = furthest((0..coarse.len()).map(|number| coarser.load(number)), &expected);
        assert!(off < 1e-12, "{off} off");
        let mut solution: Vec<_> = (0..corners.len()).map(|number| colours.solution(number)).collect();
        (0..coarse.len()).for_each(|number| coarser.set_solution(number, expected[number]));
        colours.prolong(&coarser);
        for (number, solution) in solution.iter_mut().enumerate() {
            let (on, weight) = parents.of(number);
            for parent in on {
                *solution += expected[*parent as usize] * weight;
            }
        }
        let off = furthest((0..corners.len()).map(|number| colours.solution(number)), &solution);
        assert!(off < 1e-12, "{off} off");
    }
}
