//! Dialogs and menus in the real window: things behind them receive no key and no click.

use super::window::{IN_VIEW, JELLY, VALUES, Window, alone};

/// The button that opens the assistant for models.
const ADD_MODEL: [i32; 2] = [137, 655];
/// The button of the first menu.
const FILE: [i32; 2] = [30, 20];
/// A place in the margin of every dialog.
const DIALOG_EDGE: [i32; 2] = [345, 400];

#[test]
fn what_is_chosen_survives_all_keys_in_a_dialog_and_the_escape_that_closes_a_menu() {
    alone(|| {
        let mut window = Window::open("cube-on-plane", None);
        window.key("space");
        window.wait_until_still();
        let nothing = window.shot();
        window.click("1", JELLY);
        window.point_at(IN_VIEW);
        window.wait_until("its values are shown", |shot| shot.differs(&nothing, VALUES));
        window.wait_until_still();
        let chosen = window.shot();
        window.click("1", ADD_MODEL);
        window.wait_until("the dialog is open", |shot| shot.differs(&chosen, shot.view()));
        // A click into the dialog's empty margin takes the keyboard focus from the field.
        window.click("1", DIALOG_EDGE);
        for key in ["x", "Delete", "4", "space", "h", "r", "period", "shift+d", "ctrl+z", "t", "F1"] {
            window.key(key);
        }
        window.key("Escape");
        window.point_at(IN_VIEW);
        window.wait_until("all is as it was", |shot| !shot.differs(&chosen, shot.whole()));
        window.click("1", FILE);
        window.wait_until("the menu is open", |shot| shot.differs(&chosen, shot.view()));
        window.key("Escape");
        window.point_at(IN_VIEW);
        window.wait_until("the menu is closed and nothing else", |shot| !shot.differs(&chosen, shot.whole()));
        window.key("Escape");
        window.wait_until("now nothing is chosen", |shot| shot.differs(&chosen, VALUES));
    });
}
