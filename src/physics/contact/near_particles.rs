//! The particles of a body that may meet an obstacle: a list of a few at a time, with a mask of those among them.

/// Number of particles that are listed together.
pub(super) const BATCH_SIZE: usize = 16;

/// Some particles of a body, by their numbers in it, ascending.
#[derive(Clone, Debug)]
pub(super) struct NearParticles {
    /// The number of the first of a few, and a bit for each of them that is in the list.
    batches: Vec<(u32, u16)>,
}

impl NearParticles {
    /// Makes room for a body of this many particles.
    pub(super) fn new(particles: usize) -> Self {
        Self { batches: Vec::with_capacity(particles.div_ceil(BATCH_SIZE)) }
    }

    pub(super) fn clear(&mut self) {
        self.batches.clear();
    }

    /// Adds those with a bit in `mask` of the few that begin with `first`.
    pub(super) fn push(&mut self, first: usize, mask: u16) {
        if mask != 0 {
            #[expect(clippy::cast_possible_truncation, reason = "particles are counted in 32 bits")]
            self.batches.push((first as u32, mask));
        }
    }

    /// The numbers of all in the list.
    pub(super) fn iter(&self) -> impl Iterator<Item = usize> {
        self.batches.iter().flat_map(|(first, mask)| {
            let first_of_rest = |rest: &u16| Some(rest & (rest - 1)).filter(|rest| *rest != 0);
            std::iter::successors(Some(*mask), first_of_rest)
                .map(move |rest| *first as usize + rest.trailing_zeros() as usize)
        })
    }
}

/// The mask of a few in which `is_in` decides which are in it.
#[inline]
pub(super) fn mask(count: usize, mut is_in: impl FnMut(usize) -> bool) -> u16 {
    (0..count).fold(0, |mask, particle| mask | u16::from(is_in(particle)) << particle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_in_comes_out_in_order() {
        let mut near = NearParticles::new(48);
        near.push(0, mask(16, |particle| particle % 5 == 0));
        near.push(16, mask(16, |_| false));
        near.push(32, mask(7, |_| true));
        assert_eq!(near.iter().collect::<Vec<_>>(), [0, 5, 10, 15, 32, 33, 34, 35, 36, 37, 38]);
        near.push(48, mask(16, |particle| particle == 15));
        assert_eq!(near.iter().last(), Some(63));
        near.clear();
        assert_eq!(near.iter().count(), 0);
    }
}
