//! Cards that float over the view, and the part of the view that they leave free.

use egui::{Align2, Area, Id, Order, Rect, Ui};

/// Shows a card at the top of the view, below the cards that are there.
pub(super) fn card_over_view(ui: &Ui, name: &str, free: &mut Rect, contents: impl FnOnce(&mut Ui)) {
    let card = over_view(ui, name, *free, Align2::CENTER_TOP, contents);
    free.min.y = card.max.y.clamp(free.min.y, free.max.y);
}

/// The part that a card in the lower left corner leaves free: above it or on its right, whichever is larger.
pub(super) fn beside_corner_card(free: Rect, card: Rect) -> Rect {
    let mut above = free;
    above.max.y = card.min.y.clamp(free.min.y, free.max.y);
    let mut right = free;
    right.min.x = card.max.x.clamp(free.min.x, free.max.x);
    if above.area() >= right.area() { above } else { right }
}

/// Shows something that floats over the view, at one of its corners. Returns its place.
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
    // A card is placed by its size in the last frame: if it has grown since, the frame is laid out again.
    if !view.expand(0.5).contains_rect(card) {
        ui.ctx().request_discard("a card has outgrown the view");
    }
    card
}
