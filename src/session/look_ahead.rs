//! What a session finds out of where its steps lead, while someone looks.

use std::sync::Arc;

use super::Session;
use super::stability_map::{StabilityOf, StabilityShown};

impl Session {
    /// Looks at the stability of a body, or no longer.
    pub(super) fn watch_stability(&mut self, of: Option<StabilityOf>) {
        self.stability = of.map(|of| Arc::new(StabilityShown::of_body(of, &self.scene, &self.bodies.lattices())));
    }

    /// Looks anew, where someone looks: something has changed.
    pub(super) fn find_stability(&mut self) {
        let of = self.stability.as_ref().map(|shown| shown.of);
        self.watch_stability(of);
    }
}
