//! The links of a body, by family.

use std::sync::Arc;

use crate::math::Real;

/// The links of one family in one body.
#[derive(Clone, Debug)]
pub struct LinkFamily<R: Real> {
    /// Force at 100 % strain, N; the largest where links differ.
    pub stiffness: R,
    /// Force at a relative speed of one rest length a second, N·s; the largest where links differ.
    pub damping: R,
    /// The links; copies of a model share them.
    pub links: Arc<[Link<R>]>,
    /// Stiffness and damping of each link, in the units above.
    pub(in crate::physics) constants: LinkConstants<R>,
}

/// Stiffness and damping of the links of a family.
#[derive(Clone, Debug)]
pub(in crate::physics) enum LinkConstants<R> {
    /// All the same.
    Uniform([R; 2]),
    /// By class.
    Classes {
        /// The class of each link, a place in `constants`.
        of_link: Vec<u16>,
        /// Stiffness and damping of each class.
        constants: Vec<[R; 2]>,
    },
}

impl<R: Real> LinkFamily<R> {
    /// The links themselves, shared.
    pub(in crate::physics) fn shared_links(&self) -> Arc<[Link<R>]> {
        Arc::clone(&self.links)
    }

    /// The class of every link; none where all are alike.
    pub(in crate::physics) fn classes(&self) -> &[u16] {
        match &self.constants {
            LinkConstants::Uniform(_) => &[],
            LinkConstants::Classes { of_link, .. } => of_link,
        }
    }

    /// Stiffness (N) and damping (N·s) of one link.
    #[inline]
    pub fn constants(&self, link: usize) -> [R; 2] {
        match &self.constants {
            LinkConstants::Uniform(constants) => *constants,
            LinkConstants::Classes { of_link, constants } => constants[usize::from(of_link[link])],
        }
    }
}

/// A spring between two particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link<R> {
    /// The particles, local to the body.
    pub ends: [u32; 2],
    /// Length without force, m.
    pub rest_length: R,
    /// Its inverse, 1/m: a division saved in every step.
    pub inverse_rest_length: R,
}
