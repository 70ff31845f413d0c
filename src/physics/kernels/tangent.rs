//! The matrix of the implicit scheme's equations over the box of a body: a symmetric block for each link, from its present
//! position, and the product of all blocks with a vector.
//!
//! A link's block is `across I + along alongᵀ` between its ends: velocities v give a force `B (vᵢ − vⱼ)` on one end and the
//! opposite on the other. Blocks are in the precision of the state, as a product spends most of its time reading them, and
//! the matrix may be a little off as long as it is the same throughout; vectors and sums are in double precision.

use std::ops::Range;

use glam::DVec3;

use crate::math::Real;
use crate::physics::kernels::block::{Lanes, Mask};
use crate::physics::kernels::boxed::{BoxedLinks, Law};
use crate::physics::kernels::layout::{BLOCK, FAMILY, Layout, MAX_PLACES_PER_LINK, Run, STENCIL, Term};
use crate::physics::kernels::level::SimdLevel;
use crate::physics::kernels::piece::Piece;
use crate::physics::kernels::sweep::{
    InitialForce, Window, add_block, for_each_panel, lanes, lanes_mut, lanes_of, scatter, slices,
};

/// The blocks of a body's links in its box, and the workspace that they are made in.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct Tangents<R> {
    blocks: Vec<TermBlocks<R>>,
    families: [bool; 3],
    /// Positions, m, ...
    position: [Vec<R>; 3],
    /// ... and velocities, m/s.
    velocity: [Vec<R>; 3],
    /// The diagonal of the blocks while they are made.
    diagonal: Vec<f64>,
}

/// The blocks of the links of one direction that start in one block of corners; zero where no link starts.
#[derive(Clone, Debug)]
struct TermBlocks<R> {
    across: [R; BLOCK],
    along: [[R; BLOCK]; 3],
}

/// Returns the most memory that blocks take in single precision, bytes, for a body with this many links and corners of its
/// box.
pub(in crate::physics) fn tangent_bytes(links: usize, corners: usize) -> usize {
    let places = (STENCIL.len() * corners).min(MAX_PLACES_PER_LINK * links);
    places * size_of::<[f32; 4]>() + corners * size_of::<([f32; 6], f64)>()
}

impl<R: Real> Tangents<R> {
    /// Allocates room for the links of a body, if it has a box.
    pub(in crate::physics) fn new(links: Option<&BoxedLinks<R>>) -> Self {
        let [terms, corners] = links.map_or([0; 2], |links| [links.layout.terms.len(), links.layout.corners]);
        let zeros = [R::ZERO; BLOCK];
        Self {
            blocks: vec![TermBlocks { across: zeros, along: [zeros; 3] }; terms],
            families: [false; 3],
            position: [(); 3].map(|()| vec![R::ZERO; corners]),
            velocity: [(); 3].map(|()| vec![R::ZERO; corners]),
            diagonal: vec![0.0; corners],
        }
    }

    /// Makes the blocks of a body whose particles have these positions (m) and velocities (m/s), for a step of `dt` (s):
    ///
    /// ```text
    /// dt² K⁺ + dt C of a link = across I + along d̂ d̂ᵀ
    /// across = dt² max(0, k/l0 − k/l*)     along = dt² k/l0 − across + dt d/l0     l*² = l² − dt² |v⊥|²
    /// ```
    ///
    /// Calls `diagonal` with each particle and a third of the trace of what the blocks add to its block on the diagonal.
    pub(in crate::physics) fn assemble(
        &mut self,
        links: &BoxedLinks<R>,
        (level, families): (SimdLevel, [bool; 3]),
        dt: f64,
        [position, velocity]: [&[R::Vec3]; 2],
        mut diagonal: impl FnMut(usize, f64),
    ) {
        let Self { blocks, families: chosen, position: places, velocity: speeds, diagonal: sum } = self;
        let layout = &*links.layout;
        *chosen = families;
        sum.fill(0.0);
        let secs = [dt * dt, dt].map(R::from_f64);
        level.run(
            #[inline(always)]
            || {
                scatter(&layout.runs, [0; 2], position, places);
                scatter(&layout.runs, [0; 2], velocity, speeds);
                assemble_all(links, families, secs, [slices(places), slices(speeds)], blocks, sum);
            },
        );
        for Run { particles, corner } in &layout.runs {
            for (particle, sum) in particles.clone().zip(&sum[*corner..]) {
                diagonal(particle, *sum);
            }
        }
    }

    /// Writes the product of all blocks with a vector for the particles of a piece of the body. `done` is called with a
    /// stretch of them as soon as its product is complete.
    pub(in crate::physics) fn multiply(
        &self,
        links: &BoxedLinks<f64>,
        level: SimdLevel,
        of: &[DVec3],
        piece: &mut Piece<f64>,
        product: &mut [DVec3],
        done: &mut impl FnMut(Range<usize>, &mut [DVec3]),
    ) {
        for_each_panel(
            level,
            [Some(of), None],
            Some((InitialForce::Alike(DVec3::ZERO), product)),
            piece,
            &|| false,
            #[inline(always)]
            |window| multiply_all(&links.layout, self.families, &self.blocks, window),
            done,
        );
    }
}

#[inline(always)]
fn assemble_all<R: Real>(
    links: &BoxedLinks<R>,
    families: [bool; 3],
    secs: [R; 2],
    [position, velocity]: [[&[R]; 3]; 2],
    blocks: &mut [TermBlocks<R>],
    diagonal: &mut [f64],
) {
    let Layout { offsets, masks, terms, .. } = &*links.layout;
    let ones = [R::ONE; BLOCK];
    for block in &links.layout.blocks {
        let of_corners = lanes(masks, block.first);
        let [near, near_velocity] = [position, velocity].map(|of| lanes_of(of, block.first));
        let mut sum = [0.0; BLOCK];
        for number in block.terms.clone() {
            let Term { slot, .. } = terms[number];
            if !families[FAMILY[slot]] {
                continue;
            }
            let other = block.first + offsets[slot];
            let [far, far_velocity] = [position, velocity].map(|of| lanes_of(of, other));
            let mask = Mask { of_corners, bit: 1 << slot };
            let (law, constants) = links.law(number, slot).by_corner(&ones);
            assemble_term(
                law,
                constants,
                secs,
                mask,
                [near, far],
                [near_velocity, far_velocity],
                &mut blocks[number],
                &mut sum,
                lanes_mut(diagonal, other),
            );
        }
        add_block(&sum, lanes_mut(diagonal, block.first));
    }
}

/// Makes the blocks of the links of one direction that start in one block of corners, and adds their diagonal at the first
/// ends and at the others. All links are of `law`, times the `stiffness` and `damping` of their corner.
#[inline(always)]
#[expect(clippy::too_many_arguments, clippy::assign_op_pattern, reason = "as of the forces of links")]
fn assemble_term<R: Real>(
    law: Law<R>,
    [stiffness, damping]: [&[R; BLOCK]; 2],
    [squared_secs, secs]: [R; 2],
    mask: Mask<'_>,
    [[near_x, near_y, near_z], [far_x, far_y, far_z]]: [Lanes<'_, R>; 2],
    [[near_u, near_v, near_w], [far_u, far_v, far_w]]: [Lanes<'_, R>; 2],
    blocks: &mut TermBlocks<R>,
    on_near: &mut [f64; BLOCK],
    on_far: &mut [f64; BLOCK],
) {
    let TermBlocks { across: all_across, along: [along_x, along_y, along_z] } = blocks;
    for lane in 0..BLOCK {
        let dx = far_x[lane] - near_x[lane];
        let dy = far_y[lane] - near_y[lane];
        let dz = far_z[lane] - near_z[lane];
        let squared = dx * dx + dy * dy + dz * dz;
        let inverse = R::ONE / squared.sqrt();
        // Ends in one place have no direction, and places without a link may hold anything.
        let is_there = squared > R::ZERO && mask.of_corners[lane] & mask.bit != 0;
        let way_x = secs * (far_u[lane] - near_u[lane]);
        let way_y = secs * (far_v[lane] - near_v[lane]);
        let way_z = secs * (far_w[lane] - near_w[lane]);
        let way_along = (way_x * dx + way_y * dy + way_z * dz) * inverse;
        let turned_by = way_x * way_x + way_y * way_y + way_z * way_z - way_along * way_along;
        // No number where turning made all of the length: then nothing acts across.
        let inverse_unturned = R::ONE / (squared - turned_by).sqrt();
        let stiff = squared_secs * (law.slope * stiffness[lane]);
        let tense = stiff - squared_secs * (law.stiffness * stiffness[lane]) * inverse_unturned;
        let across = if tense > R::ZERO { tense } else { R::ZERO };
        let along = stiff - across + secs * (law.damping * damping[lane]);
        let across = if is_there { across } else { R::ZERO };
        let along = if is_there { along } else { R::ZERO };
        let factor = if is_there { along.sqrt() * inverse } else { R::ZERO };
        all_across[lane] = across;
        along_x[lane] = dx * factor;
        along_y[lane] = dy * factor;
        along_z[lane] = dz * factor;
        let third = across.to_f64() + along.to_f64() * (1.0 / 3.0);
        on_near[lane] = on_near[lane] + third;
        on_far[lane] = on_far[lane] + third;
    }
}

#[inline(always)]
fn multiply_all<R: Real>(
    layout: &Layout,
    families: [bool; 3],
    blocks: &[TermBlocks<R>],
    Window { blocks: some, first, own, vectors: [factor, _], sum: [sum_x, sum_y, sum_z] }: Window<'_, f64>,
) {
    let Layout { offsets, terms, .. } = layout;
    let (sum_x, sum_y, sum_z) = (&mut sum_x[..], &mut sum_y[..], &mut sum_z[..]);
    for block in &layout.blocks[some] {
        let at = block.first - first;
        let near = lanes_of(factor, at);
        let mut sum = [[0.0; BLOCK]; 3];
        for number in block.terms.clone() {
            let slot = terms[number].slot;
            // Of the blocks before a piece only the terms that reach into it are needed.
            let reaches = block.first >= own || block.first + offsets[slot] + BLOCK > own;
            if families[FAMILY[slot]] && reaches {
                let other = at + offsets[slot];
                let far = lanes_of(factor, other);
                let (x, y, z) = (lanes_mut(sum_x, other), lanes_mut(sum_y, other), lanes_mut(sum_z, other));
                multiply(&blocks[number], near, far, &mut sum, x, y, z);
            }
        }
        add_block(&sum[0], lanes_mut(sum_x, at));
        add_block(&sum[1], lanes_mut(sum_y, at));
        add_block(&sum[2], lanes_mut(sum_z, at));
    }
}

/// Adds the product of the blocks of one term at the first ends and subtracts it at the others.
#[inline(always)]
#[expect(clippy::assign_op_pattern, reason = "as of the forces of links")]
fn multiply<R: Real>(
    blocks: &TermBlocks<R>,
    [near_x, near_y, near_z]: Lanes<'_, f64>,
    [far_x, far_y, far_z]: Lanes<'_, f64>,
    [on_near_x, on_near_y, on_near_z]: &mut [[f64; BLOCK]; 3],
    on_far_x: &mut [f64; BLOCK],
    on_far_y: &mut [f64; BLOCK],
    on_far_z: &mut [f64; BLOCK],
) {
    let TermBlocks { across, along: [along_x, along_y, along_z] } = blocks;
    for lane in 0..BLOCK {
        let across = across[lane].to_f64();
        let (ax, ay, az) = (along_x[lane].to_f64(), along_y[lane].to_f64(), along_z[lane].to_f64());
        let dx = near_x[lane] - far_x[lane];
        let dy = near_y[lane] - far_y[lane];
        let dz = near_z[lane] - far_z[lane];
        let along = ax * dx + ay * dy + az * dz;
        let x = across * dx + ax * along;
        let y = across * dy + ay * along;
        let z = across * dz + az * along;
        on_near_x[lane] = on_near_x[lane] + x;
        on_near_y[lane] = on_near_y[lane] + y;
        on_near_z[lane] = on_near_z[lane] + z;
        on_far_x[lane] = on_far_x[lane] - x;
        on_far_y[lane] = on_far_y[lane] - y;
        on_far_z[lane] = on_far_z[lane] - z;
    }
}
