//! The rigid motions of a body's pieces that nothing holds: they stretch no link and have no frequency.

use faer::{Mat, Side};
use glam::DVec3;

use super::ModalError;
use super::stiffness::System;

/// The most pieces that a body may fall into.
const MAX_PIECES: usize = 16;

/// A motion leaves held particles still if it moves them by less than this share of the others.
const STILLNESS_TOLERANCE: f64 = 1e-6;

/// An orthonormal basis of the motions without frequency, weighted by the roots of the masses; one column each.
pub(super) fn rigid_motions(system: &System) -> Result<Mat<f64>, ModalError> {
    let pieces = pieces(system);
    if pieces.len() > MAX_PIECES {
        return Err(ModalError::Pieces { pieces: pieces.len(), most: MAX_PIECES });
    }
    let mut found: Vec<Vec<f64>> = Vec::new();
    for piece in pieces {
        for motion in free_motions(&piece)? {
            let mut column = vec![0.0; system.size()];
            for &place in &piece.free {
                let at = system.rest[system.free[place] as usize] - piece.middle;
                let way = motion.displacement_at(at) / system.inverse_root_mass[place];
                column[3 * place..3 * place + 3].copy_from_slice(&way.to_array());
            }
            let before = norm(&column);
            for _ in 0..2 {
                for other in &found {
                    let along: f64 = other.iter().zip(&column).map(|(a, b)| a * b).sum();
                    column.iter_mut().zip(other).for_each(|(to, other)| *to -= along * other);
                }
            }
            let left = norm(&column);
            // A straight row of particles does not turn about itself.
            if left > STILLNESS_TOLERANCE * before {
                for x in &mut column {
                    *x /= left;
                }
                found.push(column);
            }
        }
    }
    Ok(Mat::from_fn(system.size(), found.len(), |row, column| found[column][row]))
}

/// Particles that links hold together.
struct Piece {
    /// The particles that are not held, by their places among the free ones.
    free: Vec<usize>,
    /// Where the held ones are, m.
    held: Vec<DVec3>,
    middle: DVec3,
    /// The largest distance of a particle from the middle, m; never zero.
    size: f64,
}

/// A small rigid motion about the middle of a piece.
#[derive(Clone, Copy)]
struct Motion {
    translation: DVec3,
    rotation: DVec3,
}

impl Motion {
    fn displacement_at(&self, place: DVec3) -> DVec3 {
        self.translation + self.rotation.cross(place)
    }
}

/// Returns the pieces that have a free particle.
fn pieces(system: &System) -> Vec<Piece> {
    let count = system.rest.len();
    let mut root: Vec<usize> = (0..count).collect();
    for link in system.links.iter().filter(|link| link.stiffness > 0.0) {
        let [a, b] = link.particles.map(|particle| root_of(&mut root, particle as usize));
        root[a.max(b)] = a.min(b);
    }
    let mut place = vec![None; count];
    for (at, &particle) in system.free.iter().enumerate() {
        place[particle as usize] = Some(at);
    }
    let mut number = vec![usize::MAX; count];
    let mut pieces: Vec<Piece> = Vec::new();
    for particle in 0..count {
        let root = root_of(&mut root, particle);
        if number[root] == usize::MAX {
            number[root] = pieces.len();
            pieces.push(Piece { free: Vec::new(), held: Vec::new(), middle: DVec3::ZERO, size: 1.0 });
        }
        let piece = &mut pieces[number[root]];
        match place[particle] {
            Some(place) => piece.free.push(place),
            None => piece.held.push(system.rest[particle]),
        }
        piece.middle += system.rest[particle];
    }
    pieces.retain(|piece| !piece.free.is_empty());
    for piece in &mut pieces {
        piece.middle /= (piece.free.len() + piece.held.len()) as f64;
        let free = piece.free.iter().map(|&place| system.rest[system.free[place] as usize]);
        let farthest = free.chain(piece.held.iter().copied()).map(|at| at.distance(piece.middle)).fold(0.0, f64::max);
        if farthest > 0.0 {
            piece.size = farthest;
        }
    }
    pieces
}

/// Returns the root of a particle: the first one known to be in its piece.
fn root_of(root: &mut [usize], mut at: usize) -> usize {
    while root[at] != at {
        root[at] = root[root[at]];
        at = root[at];
    }
    at
}

/// Returns the rigid motions of a piece that leave its held particles where they are: the null space of `Σ Cᵀ C`, the
/// squares of the displacements of these particles.
fn free_motions(piece: &Piece) -> Result<Vec<Motion>, ModalError> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let basis: Vec<Motion> = axes
        .iter()
        .map(|&translation| Motion { translation, rotation: DVec3::ZERO })
        .chain(axes.iter().map(|&rotation| Motion { translation: DVec3::ZERO, rotation: rotation / piece.size }))
        .collect();
    if piece.held.is_empty() {
        return Ok(basis);
    }
    let mut squares = Mat::<f64>::zeros(6, 6);
    for held in &piece.held {
        let moved: Vec<DVec3> = basis.iter().map(|motion| motion.displacement_at(*held - piece.middle)).collect();
        for row in 0..6 {
            for column in 0..6 {
                squares[(row, column)] += moved[row].dot(moved[column]) / piece.held.len() as f64;
            }
        }
    }
    let found = squares.self_adjoint_eigen(Side::Lower).map_err(|_error| ModalError::Singular)?;
    let unmoved = (0..6).filter(|&column| found.S()[column] < STILLNESS_TOLERANCE * STILLNESS_TOLERANCE);
    let motion = |column: usize| {
        let weight = |row: usize| found.U()[(row, column)];
        let sum =
            |from: usize, of: fn(&Motion) -> DVec3| (from..from + 3).map(|row| of(&basis[row]) * weight(row)).sum();
        Motion { translation: sum(0, |motion| motion.translation), rotation: sum(3, |motion| motion.rotation) }
    };
    Ok(unmoved.map(motion).collect())
}

fn norm(of: &[f64]) -> f64 {
    of.iter().map(|x| x * x).sum::<f64>().sqrt()
}
