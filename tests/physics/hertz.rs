//! A ball pressed on a plane and on its like, against Hertz's theory.

use gelatin::report::stability::hertz::measure;

#[test]
fn a_pressed_ball_comes_nearer_to_hertz_the_finer_its_cells_are() {
    let figures = measure(true).expect("a ball");
    assert!(figures.passed && figures.rows.len() == 4, "a plane and its like in two resolutions: {figures:?}");
    for pair in figures.rows.chunks(2) {
        assert!(pair[1].error() < 0.7 * pair[0].error(), "{pair:?}");
    }
}
