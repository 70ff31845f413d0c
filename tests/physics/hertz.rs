//! A ball pressed on a plane, against Hertz's theory.

use gelatin::report::stability::hertz::measure;

#[test]
fn a_pressed_ball_comes_nearer_to_hertz_the_finer_its_cells_are() {
    let figures = measure(true).expect("a ball");
    let [coarse, fine] = &figures.rows[..] else { panic!("two resolutions: {figures:?}") };
    assert!(figures.passed, "{figures:?}");
    assert!(fine.error() < 0.7 * coarse.error(), "{figures:?}");
}
