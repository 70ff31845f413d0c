//! The comparison of pictures must be able to fail.

use gelatin::view::Image;
use glam::Vec3;

use crate::gpu::Studio;
use crate::image_diff::difference;
use crate::scenes::{cube, cube_at};

#[test]
fn a_body_moved_by_a_centimetre_is_another_picture() {
    let mut studio = Studio::new();
    let picture = studio.picture(&cube(), [200, 200]);
    assert_eq!(difference(&picture, &studio.picture(&cube(), [200, 200])), None, "the same scene twice");
    let moved = studio.picture(&cube_at(Vec3::new(0.01, 0.5, 0.0)), [200, 200]);
    assert!(difference(&picture, &moved).is_some(), "a centimetre is seen");
}

#[test]
fn another_size_and_another_shade_are_found() {
    let grey = Image::filled([20, 10], [90, 90, 90, 255]);
    assert!(difference(&grey, &Image::filled([10, 20], [90, 90, 90, 255])).is_some(), "as many pixels, other sides");
    assert!(difference(&grey, &Image::filled([20, 10], [90, 94, 90, 255])).is_some(), "four steps of green");
    assert_eq!(difference(&grey, &Image::filled([20, 10], [91, 90, 89, 255])), None, "rounding is no difference");
}
