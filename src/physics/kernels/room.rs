//! Room for the vectors at the corners near a panel, component by component.
//!
//! Where the lists lie in memory makes a sweep up to an eighth faster. A vector of 64 bytes that does not begin at a line of
//! the caches takes two loads. And lists that begin at the same place of their pages, as large ones do that are allocated one
//! by one, compete for the same lines of the first cache, and a load waits for a store to another list whose address ends in
//! the same 12 bits (Intel, *64 and IA-32 Architectures Optimization Reference Manual*, on 4-Kbyte aliasing).

use crate::math::Real;

/// A line of the caches.
const LINE_BYTES: usize = 64;

/// Addresses with a multiple of this between them share lines of the first cache.
const PAGE_BYTES: usize = 4096;

/// The number of lists: three vectors of three components.
const LISTS: usize = 9;

/// How far apart the lists begin in their pages at least.
const APART_BYTES: usize = 4 * LINE_BYTES;

/// Positions, velocities and sums, component by component. Workspace: a copy has the same room, with anything in it.
#[derive(Debug)]
pub(super) struct Room<R> {
    /// The lists one after the other, and before them so many numbers that the first begins with a line.
    numbers: Vec<R>,
    before: usize,
    /// The numbers of a list.
    places: usize,
    /// The numbers from the beginning of a list to that of the next.
    stride: usize,
}

impl<R: Real> Room<R> {
    /// Room for so many corners.
    pub(super) fn new(places: usize) -> Self {
        let size = size_of::<R>();
        let stride = stride_bytes(places * size) / size;
        let numbers = vec![R::default(); LISTS * stride + LINE_BYTES / size];
        let begin = numbers.as_ptr().addr();
        let before = (begin.next_multiple_of(LINE_BYTES) - begin) / size;
        Self { numbers, before, places, stride }
    }

    /// How many corners there is room for.
    pub(super) fn places(&self) -> usize {
        self.places
    }

    /// The components of positions, of velocities, and of sums.
    pub(super) fn split(&mut self) -> [[&mut [R]; 3]; 3] {
        let lists = self.numbers[self.before..].chunks_exact_mut(self.stride);
        let mut lists = lists.map(|list| &mut list[..self.places]);
        [(); 3].map(|()| [(); 3].map(|()| lists.next().expect("there are nine lists")))
    }
}

impl<R: Real> Clone for Room<R> {
    fn clone(&self) -> Self {
        Self::new(self.places)
    }
}

/// The least number of bytes from one list of so many bytes to the next with which the lists begin at places of their own in
/// their pages.
fn stride_bytes(list_bytes: usize) -> usize {
    let are_apart = |stride: &usize| {
        (1..LISTS).map(|lists| lists * stride % PAGE_BYTES).all(|at| at.min(PAGE_BYTES - at) >= APART_BYTES)
    };
    let least = list_bytes.next_multiple_of(LINE_BYTES);
    let mut strides = (least..=least + PAGE_BYTES).step_by(LINE_BYTES);
    strides.find(are_apart).expect("a page and a ninth is among them")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn begins<R: Real>(room: &mut Room<R>) -> Vec<usize> {
        let places = room.places();
        let lists = room.split().into_iter().flatten();
        lists
            .map(|list| {
                assert_eq!(list.len(), places, "room for all corners");
                list.as_ptr().addr()
            })
            .collect()
    }

    #[test]
    fn lists_begin_with_a_line_and_at_places_of_their_own_in_a_page() {
        for places in [0, 1, 15, 100, 1000, 1024, 3072, 10_001, 64 * 64 * 6] {
            let mut room = Room::<f32>::new(places);
            for room in [&mut room.clone(), &mut room] {
                let mut begins = begins(room);
                assert!(begins.iter().all(|begin| begin.is_multiple_of(LINE_BYTES)), "{places}");
                for begin in &mut begins {
                    *begin %= PAGE_BYTES;
                }
                begins.sort_unstable();
                let are_apart = begins.windows(2).all(|pair| pair[1] - pair[0] >= APART_BYTES);
                assert!(are_apart, "{places}: {begins:?}");
            }
            assert!(begins(&mut Room::<f64>::new(places)).iter().all(|begin| begin.is_multiple_of(LINE_BYTES)));
        }
    }

    #[test]
    fn little_room_is_wasted() {
        for bytes in (0..100_000).step_by(1000) {
            assert!((bytes..bytes + PAGE_BYTES).contains(&stride_bytes(bytes)), "{bytes}");
        }
    }
}
