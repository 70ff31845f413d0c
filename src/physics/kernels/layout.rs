//! Where the particles and links of a body are in the box of its grid corners: a function of the lattice alone.

use std::ops::Range;

use crate::geometry::Lattice;

/// Corners that are worked on at a time. Half or a quarter as many slow the widest instructions down by a tenth to a third
/// on full bodies; more waste work on empty places in thin ones.
pub(super) const BLOCK: usize = 64;

/// The steps to the higher ends of links: 3 structural, 10 shear, 3 bending.
pub(super) const STENCIL: [[i32; 3]; 16] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [-1, 1, 0],
    [1, 1, 0],
    [0, -1, 1],
    [0, 1, 1],
    [-1, 0, 1],
    [1, 0, 1],
    [-1, -1, 1],
    [1, -1, 1],
    [-1, 1, 1],
    [1, 1, 1],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
];

/// The family of each step. A `static`, not a `const`: a loop that indexes a constant array copies it to the stack first,
/// every time.
pub(super) static FAMILY: [usize; 16] = [0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2];

/// The index of each step in the stencil, at `dx + 2 + 5 (dy + 2 + 5 (dz + 2))`.
const SLOT_OF_STEP: [usize; 125] = {
    let mut place = [usize::MAX; 125];
    let mut slot = 0;
    while slot < 16 {
        let [dx, dy, dz] = STENCIL[slot];
        #[expect(clippy::cast_sign_loss, reason = "steps are at least -2")]
        let at = (dx + 2 + 5 * (dy + 2 + 5 * (dz + 2))) as usize;
        place[at] = slot;
        slot += 1;
    }
    place
};

/// The most places in blocks for each link. Beyond it a walk along the list of links is no slower: one link of a list takes
/// as long as 4 places with the narrowest vector instructions.
pub(super) const MAX_PLACES_PER_LINK: usize = 4;

/// The most corners of the box for each particle. Beyond it the box takes more memory than the list of links.
pub(in crate::physics) const MAX_CORNERS_PER_PARTICLE: usize = 16;

/// If a plane has a multiple of this many corners, the same place of several planes falls into the same few lines of a
/// cache: 2 KiB in single precision.
const CACHE_ALIASING_CORNERS: usize = 512;

/// Memory for a corner of the box in single precision, bytes: position, velocity, force and mask.
pub(in crate::physics) const BYTES_PER_CORNER: usize = size_of::<[f32; 9]>() + size_of::<u16>();

/// Particles that are consecutive both in the body and in the box.
#[derive(Clone, Debug)]
pub(super) struct Run {
    /// Local numbers.
    pub(super) particles: Range<usize>,
    /// The corner of the first.
    pub(super) corner: usize,
}

impl Run {
    /// Returns the run's particles and corners, counted from a particle and a corner.
    #[inline(always)]
    pub(super) fn relative_to(&self, [particle, corner]: [usize; 2]) -> [Range<usize>; 2] {
        let corner = self.corner - corner;
        [self.particles.start - particle..self.particles.end - particle, corner..corner + self.particles.len()]
    }
}

/// Corners of the box that are worked on together.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The first corner.
    pub(super) first: usize,
    /// The terms of this block.
    pub(super) terms: Range<usize>,
}

/// The links of one direction that start in one block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    /// The direction, a place in [`STENCIL`].
    pub(super) slot: usize,
    /// How many links there are: as many as the block has corners, or fewer, and then the masks say where they start.
    pub(super) links: usize,
}

/// The box of a body's grid corners.
#[derive(Debug)]
pub(in crate::physics) struct Layout {
    origin: [u32; 3],
    dims: [usize; 3],
    /// The difference of the corner numbers of a link's ends, by direction.
    pub(super) offsets: [usize; 16],
    /// Corners that vectors over the box need, including those that blocks reach past the last.
    pub(super) corners: usize,
    /// Where the particles are.
    pub(super) runs: Vec<Run>,
    /// The directions of the links that start at each corner, one bit each.
    pub(super) masks: Vec<u16>,
    /// The blocks in which links start, ascending.
    pub(super) blocks: Vec<Block>,
    /// The terms of all blocks, by block and ascending direction.
    pub(super) terms: Vec<Term>,
}

impl Layout {
    /// Returns the box of a lattice; none if it would be mostly empty.
    pub(in crate::physics) fn new(lattice: &Lattice) -> Option<Self> {
        let layout = Self::bounding(lattice)?;
        let [nx, ny, nz] = layout.dims;
        if nx * ny * nz > MAX_CORNERS_PER_PARTICLE * lattice.corners.len() {
            return None;
        }
        let layout = layout.filled(lattice);
        let places = layout.terms.len() * BLOCK;
        let links: usize = lattice.links.iter().map(Vec::len).sum();
        (places <= MAX_PLACES_PER_LINK * links).then_some(layout)
    }

    /// Fills the box with the particles and links of a lattice, however empty it is.
    pub(super) fn filled(mut self, lattice: &Lattice) -> Self {
        for family in 0..3 {
            for (from, slot) in self.starts_of(lattice, family).collect::<Vec<_>>() {
                self.masks[from] |= 1 << slot;
            }
        }
        self.find_runs(lattice);
        self.find_blocks();
        self
    }

    /// Returns an empty box around a lattice.
    pub(super) fn bounding(lattice: &Lattice) -> Option<Self> {
        let first = *lattice.corners.first()?;
        let (low, high) = lattice.corners.iter().fold((first, first), |(low, high), corner| {
            let pick = |of: [u32; 3], choose: fn(u32, u32) -> u32| [0, 1, 2].map(|axis| choose(of[axis], corner[axis]));
            (pick(low, u32::min), pick(high, u32::max))
        });
        let [nx, ny, nz] = [0, 1, 2].map(|axis| (high[axis] - low[axis]) as usize + 1);
        // An empty place at the end of each row keeps planes from falling into the same lines of the caches.
        let nx = if (nx * ny).is_multiple_of(CACHE_ALIASING_CORNERS) { nx + 1 } else { nx };
        let dims = [nx, ny, nz];
        let count = nx * ny * nz;
        let strides = [1, nx, nx * ny];
        // A step that goes down along one axis goes up along a later one, whose stride is larger.
        let offsets = STENCIL.map(|step| {
            let way = |downwards: bool| -> usize {
                let along = step.iter().zip(strides).filter(|(d, _)| (**d < 0) == downwards);
                along.map(|(d, stride)| d.unsigned_abs() as usize * stride).sum()
            };
            way(false) - way(true)
        });
        let reach = offsets.iter().copied().max().unwrap_or(0);
        Some(Self {
            origin: low,
            dims,
            offsets,
            corners: count + reach + BLOCK,
            runs: Vec::new(),
            masks: vec![0; count + BLOCK],
            blocks: Vec::new(),
            terms: Vec::new(),
        })
    }

    /// Returns the number of a grid corner.
    fn number(&self, corner: [u32; 3]) -> usize {
        let [x, y, z] = [0, 1, 2].map(|axis| (corner[axis] - self.origin[axis]) as usize);
        x + self.dims[0] * (y + self.dims[1] * z)
    }

    /// Returns, for every link of a family, the corner at which it starts and its direction.
    pub(super) fn starts_of(&self, lattice: &Lattice, family: usize) -> impl Iterator<Item = (usize, usize)> {
        lattice.links[family].iter().map(|ends| {
            let [from, to] = ends.map(|end| lattice.corners[end as usize]);
            let [dx, dy, dz] = [0, 1, 2].map(|axis| (to[axis] + 2 - from[axis]) as usize);
            (self.number(from), SLOT_OF_STEP[dx + 5 * (dy + 5 * dz)])
        })
    }

    fn find_runs(&mut self, lattice: &Lattice) {
        for (particle, &corner) in lattice.corners.iter().enumerate() {
            let number = self.number(corner);
            match self.runs.last_mut() {
                Some(run) if run.corner + run.particles.len() == number => run.particles.end += 1,
                _ => self.runs.push(Run { particles: particle..particle + 1, corner: number }),
            }
        }
    }

    /// Lays out the blocks: each begins at the first corner with a link past the block before.
    fn find_blocks(&mut self) {
        let mut from = 0;
        while let Some(skipped) = self.masks[from..].iter().position(|mask| *mask != 0) {
            let first = from + skipped;
            let begin = self.terms.len();
            let masks = &self.masks[first..first + BLOCK];
            for slot in 0..STENCIL.len() {
                let links = masks.iter().filter(|mask| *mask >> slot & 1 == 1).count();
                if links > 0 {
                    self.terms.push(Term { slot, links });
                }
            }
            self.blocks.push(Block { first, terms: begin..self.terms.len() });
            from = first + BLOCK;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::voxel::Cells;

    fn lattice(dims: [i32; 3], keep: impl Fn([i32; 3]) -> bool) -> Lattice {
        let all = (0..dims[2]).flat_map(|z| (0..dims[1]).flat_map(move |y| (0..dims[0]).map(move |x| [x, y, z])));
        let cells: Vec<[i32; 3]> = all.filter(|cell| keep(*cell)).collect();
        Lattice::new(&Cells::from_list(&cells, 1.0).expect("some cells"))
    }

    #[test]
    fn every_link_is_in_one_term() {
        for dims in [[1, 1, 1], [3, 1, 2], [9, 4, 1], [5, 6, 7], [31, 15, 2]] {
            let lattice = lattice(dims, |_| true);
            let layout = Layout::bounding(&lattice).expect("not empty").filled(&lattice);
            let links: usize = lattice.links.iter().map(Vec::len).sum();
            assert_eq!(layout.terms.iter().map(|term| term.links).sum::<usize>(), links, "{dims:?}");
            assert_eq!(layout.masks.iter().map(|mask| mask.count_ones() as usize).sum::<usize>(), links, "{dims:?}");
            assert_eq!(layout.runs.iter().map(|run| run.particles.len()).sum::<usize>(), lattice.corners.len());
        }
    }

    #[test]
    fn no_planes_lie_on_each_other_in_the_caches() {
        for dims in [[63, 63, 2], [31, 15, 2], [15, 31, 2], [9, 9, 9]] {
            let layout = Layout::bounding(&lattice(dims, |_| true)).expect("not empty");
            let plane = layout.offsets[2];
            assert!(!plane.is_multiple_of(CACHE_ALIASING_CORNERS), "{dims:?}: {plane} corners to the next plane");
        }
    }

    #[test]
    fn a_direction_leads_to_the_other_end() {
        let lattice = lattice([3, 4, 2], |[x, y, _]| x + y != 3);
        let layout = Layout::new(&lattice).expect("most of it is filled");
        for family in 0..3 {
            for ((from, slot), ends) in layout.starts_of(&lattice, family).zip(&lattice.links[family]) {
                let [low, high] = ends.map(|end| layout.number(lattice.corners[end as usize]));
                assert_eq!((from, from + layout.offsets[slot], FAMILY[slot]), (low, high, family));
            }
        }
    }

    #[test]
    fn a_body_that_is_mostly_empty_has_no_box() {
        let sparse = lattice([40, 40, 40], |[x, y, z]| x == y && y == z);
        assert!(Layout::new(&sparse).is_none(), "one cell in 1600");
        let cell = lattice([1, 1, 1], |_| true);
        assert!(Layout::new(&cell).is_none(), "28 links in a block of each of 13 directions");
        let sheet = lattice([40, 1, 40], |_| true);
        assert!(Layout::new(&sheet).is_some(), "a sheet fills its box");
    }
}
