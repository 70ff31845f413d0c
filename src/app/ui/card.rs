//! Cards that float over the view, and what they leave free of it.

use egui::{Align2, Area, Id, Order, Rect, Ui};

/// A card at the top of the view, below those that are there.
pub(super) fn card_over_view(ui: &Ui, name: &str, free: &mut Rect, contents: impl FnOnce(&mut Ui)) {
    let card = over_view(ui, name, *free, Align2::CENTER_TOP, contents);
    free.min.y = card.max.y.clamp(free.min.y, free.max.y);
}

/// What a card in the lower left corner leaves free: what lies above it or what lies on its right, whichever is larger.
pub(super) fn beside_corner_card(free: Rect, card: Rect) -> Rect {
    let mut above = free;
    above.max.y = card.min.y.clamp(free.min.y, free.max.y);
    let mut right = free;
    right.min.x = card.max.x.clamp(free.min.x, free.max.x);
    if above.area() >= right.area() { above } else { right }
}

/// Something that floats over the view, at one of its corners. Tells where.
pub(super) fn over_view(ui: &Ui, name: &str, view: Rect, corner: Align2, contents: impl FnOnce(&mut Ui)) -> Rect {
    let inner = view.shrink(14.0);
    let card = Area::new(Id::unique(name))
        .order(Order::Middle)
        .movable(false)
        .pivot(corner)
        .fixed_pos(corner.pos_in_rect(&inner))
        .constrain_to(view)
        .fade_in(false)
        .accessible_name(name)
        .show(ui.ctx(), contents)
        .response
        .rect;
    // A card stands where its size of the last frame had room: one that has grown since is laid out anew.
    if !view.expand(0.5).contains_rect(card) {
        ui.ctx().request_discard("a card has outgrown the view");
    }
    card
}
