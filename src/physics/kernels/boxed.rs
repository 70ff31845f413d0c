//! The links of a body in its box, and their constants.

use std::sync::Arc;

use crate::geometry::Lattice;
use crate::math::Real;
use crate::physics::kernels::layout::{BLOCK, FAMILY, Layout, STENCIL};
use crate::physics::model::link::{LinkConstants, LinkFamily};

/// The constants of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Law<R> {
    /// Force at 100 % strain, N.
    pub(super) stiffness: R,
    /// The same over the rest length, N/m.
    pub(super) slope: R,
    /// Force at a relative speed of 1 m/s, N·s/m.
    pub(super) damping: R,
}

/// The constants of links that differ, one for each corner of a block; zero where no link starts.
#[derive(Clone, Debug)]
pub(super) struct PerCornerLaw<R> {
    /// The law of a link with a stiffness of 1 N and a damping of 1 N·s.
    pub(super) unit: Law<R>,
    /// Force at 100 % strain, N.
    pub(super) stiffness: [R; BLOCK],
    /// Force at a relative speed of one rest length a second, N·s.
    pub(super) damping: [R; BLOCK],
}

impl<R: Real> Law<R> {
    fn new([stiffness, damping]: [R; 2], inverse_rest_length: R) -> Self {
        Self { stiffness, slope: stiffness * inverse_rest_length, damping: damping * inverse_rest_length }
    }
}

/// The constants of the links of a term.
#[derive(Clone, Debug)]
pub(super) enum TermLaw<R> {
    /// All links have the same constants.
    Alike(Law<R>),
    /// Every link has its own.
    Each(Box<PerCornerLaw<R>>),
}

impl<R: Real> TermLaw<R> {
    /// A law, and the stiffness and damping of each corner by which it is multiplied: `ones` where all links are alike.
    #[inline(always)]
    pub(super) fn by_corner<'a>(&'a self, ones: &'a [R; BLOCK]) -> (Law<R>, [&'a [R; BLOCK]; 2]) {
        match self {
            Self::Alike(law) => (*law, [ones; 2]),
            Self::Each(each) => {
                let PerCornerLaw { unit, stiffness, damping } = &**each;
                (*unit, [stiffness, damping])
            }
        }
    }

    fn in_double(&self, inverse_rest_length: f64) -> TermLaw<f64> {
        match self {
            Self::Alike(Law { stiffness, damping, .. }) => {
                let [stiffness, damping] = [stiffness, damping].map(|of| of.to_f64());
                TermLaw::Alike(Law { stiffness, slope: stiffness * inverse_rest_length, damping })
            }
            Self::Each(each) => {
                let PerCornerLaw { stiffness, damping, .. } = &**each;
                let [stiffness, damping] = [stiffness, damping].map(|of| of.map(Real::to_f64));
                TermLaw::Each(Box::new(PerCornerLaw {
                    unit: Law::new([1.0; 2], inverse_rest_length),
                    stiffness,
                    damping,
                }))
            }
        }
    }
}

#[derive(Clone, Debug)]
enum Laws<R> {
    /// All links of a direction are alike.
    OfSlot([TermLaw<R>; 16]),
    /// One law for each term.
    OfTerm(Vec<TermLaw<R>>),
}

/// The links of a body in its box.
#[derive(Clone, Debug)]
pub(in crate::physics) struct BoxedLinks<R> {
    /// Where the links are.
    pub(in crate::physics) layout: Arc<Layout>,
    laws: Laws<R>,
    /// One over the rest length of the links of each direction, 1/m.
    pub(super) inverse_rest_length: [f64; 16],
}

impl<R: Real> BoxedLinks<R> {
    /// Puts the links of a lattice into its box.
    pub(in crate::physics) fn new(layout: Arc<Layout>, lattice: &Lattice, families: &[LinkFamily<R>; 3]) -> Self {
        let exact: [f64; 16] = STENCIL.map(|step| {
            let squared: i32 = step.iter().map(|d| d * d).sum();
            1.0 / (lattice.grid.cell_size * f64::from(squared).sqrt())
        });
        let inverse_rest_length = exact.map(R::from_f64);
        let largest = |slot: usize| {
            let LinkFamily { stiffness, damping, .. } = families[FAMILY[slot]];
            Law::new([stiffness, damping], inverse_rest_length[slot])
        };
        if families.iter().all(|family| matches!(family.constants, LinkConstants::Uniform(_))) {
            let laws = Laws::OfSlot(std::array::from_fn(|slot| TermLaw::Alike(largest(slot))));
            return Self { layout, laws, inverse_rest_length: exact };
        }
        let mut laws: Vec<_> = layout.terms.iter().map(|term| TermLaw::Alike(largest(term.slot))).collect();
        for (number, family) in families.iter().enumerate() {
            if let LinkConstants::Classes { of_link, constants } = &family.constants {
                let constants = of_link.iter().map(|class| constants[usize::from(*class)]);
                store_constants(
                    &layout,
                    layout.starts_of(lattice, number).zip(constants),
                    inverse_rest_length,
                    &mut laws,
                );
            }
        }
        for block in &layout.blocks {
            let masks = &layout.masks[block.first..block.first + BLOCK];
            for term in block.terms.clone() {
                if let TermLaw::Each(each) = &laws[term]
                    && let Some(law) = common_law(each, layout.terms[term].slot, masks)
                {
                    laws[term] = TermLaw::Alike(law);
                }
            }
        }
        Self { layout, laws: Laws::OfTerm(laws), inverse_rest_length: exact }
    }

    /// Returns the same links in double precision, with rest lengths that are not rounded.
    pub(in crate::physics) fn in_double(&self) -> BoxedLinks<f64> {
        let Self { layout, laws, inverse_rest_length } = self;
        let law = |slot: usize, of: &TermLaw<R>| of.in_double(inverse_rest_length[slot]);
        let laws = match laws {
            Laws::OfSlot(laws) => Laws::OfSlot(std::array::from_fn(|slot| law(slot, &laws[slot]))),
            Laws::OfTerm(laws) => {
                Laws::OfTerm(layout.terms.iter().zip(laws).map(|(term, of)| law(term.slot, of)).collect())
            }
        };
        BoxedLinks { layout: Arc::clone(layout), laws, inverse_rest_length: *inverse_rest_length }
    }

    /// Returns how many blocks there are.
    pub(in crate::physics) fn block_count(&self) -> usize {
        self.layout.blocks.len()
    }

    /// Returns the constants of the links of a term.
    #[inline(always)]
    pub(super) fn law(&self, term: usize, slot: usize) -> &TermLaw<R> {
        match &self.laws {
            Laws::OfSlot(laws) => &laws[slot],
            Laws::OfTerm(laws) => &laws[term],
        }
    }
}

/// Stores the constants of the links of one family, which are given in ascending order of the corners they start at.
fn store_constants<R: Real>(
    layout: &Layout,
    links: impl Iterator<Item = ((usize, usize), [R; 2])>,
    inverse_rest_length: [R; 16],
    laws: &mut [TermLaw<R>],
) {
    let mut block = 0;
    for ((from, slot), [stiffness, damping]) in links {
        while from >= layout.blocks[block].first + BLOCK {
            block += 1;
        }
        let mut terms = layout.blocks[block].terms.clone();
        let lane = from - layout.blocks[block].first;
        let Some(term) = terms.find(|term| layout.terms[*term].slot == slot) else { continue };
        if let TermLaw::Alike(_) = laws[term] {
            let zeros = [R::ZERO; BLOCK];
            let unit = Law::new([R::ONE; 2], inverse_rest_length[slot]);
            laws[term] = TermLaw::Each(Box::new(PerCornerLaw { unit, stiffness: zeros, damping: zeros }));
        }
        if let TermLaw::Each(each) = &mut laws[term] {
            (each.stiffness[lane], each.damping[lane]) = (stiffness, damping);
        }
    }
}

/// Returns the law of the links of one direction in a block, if they are all alike.
fn common_law<R: Real>(each: &PerCornerLaw<R>, slot: usize, masks: &[u16]) -> Option<Law<R>> {
    let PerCornerLaw { unit, stiffness, damping } = each;
    let lanes = (0..BLOCK).filter(|lane| masks[*lane] >> slot & 1 == 1);
    let mut constants = lanes.map(|lane| [stiffness[lane], damping[lane]]);
    let first = constants.next()?;
    constants.all(|constants| constants == first).then(|| Law::new(first, unit.slope))
}
