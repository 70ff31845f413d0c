//! Beams held at one end and loaded at the other, a few cells thick: how far the lattice is from beam theory, and that
//! the curve shown in `assets/cantilever.svg` and the README is the one measured.

use std::fmt::Write as _;
use std::path::Path;

use gelatin::scene::body::CellsShape;
use gelatin::scene::{Body, Material, Shape, Solid};
use glam::DVec3;

use crate::statics::{Linear, face_load, mean_along};
use crate::support::{alone, simulate};

/// Cells across the thickness.
const THICKNESS: [i32; 5] = [2, 3, 4, 5, 8];

/// Length over thickness.
const SLENDERNESS: i32 = 8;

/// The deflection of the loaded end of a square beam over that of Timoshenko's theory (with Cowper's shear coefficient,
/// *Journal of Applied Mechanics* 33, 1966).
fn deflection(cells: i32) -> f64 {
    let cell = 1.0 / f64::from(cells);
    let list = (0..cells * SLENDERNESS)
        .flat_map(|x| (0..cells).flat_map(move |y| (0..cells).map(move |z| [x, y, z])))
        .collect();
    let body = Body {
        shape: Shape::Cells(CellsShape { list, size: cell }),
        material: Material::Solid(Solid { young_modulus: 1.0, density: 1.0, damping_ratio: 0.0 }),
        ..Body::default()
    };
    let size = DVec3::new(f64::from(SLENDERNESS), 1.0, 1.0);
    let mut beam = Linear::of(&simulate::<f64>(&alone(body, 1e-3)).model().bodies[0]);
    beam.hold(DVec3::ONE, |start| start.x < -0.5 * size.x + 1e-9);
    let load = face_load(&beam, size, cell, DVec3::X, DVec3::NEG_Y);
    let (poisson, second_moment) = (0.25, 1.0 / 12.0);
    let shear_modulus = 0.5 / (1.0 + poisson);
    let coefficient = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    let theory = size.x.powi(3) / (3.0 * second_moment) + size.x / (coefficient * shear_modulus);
    mean_along(&load, &beam.solve(&load)) / theory
}

/// The curve as a picture: deflection over theory against cells across.
fn svg(curve: &[(i32, f64)]) -> String {
    let at = |cells: i32, ratio: f64| (60.0 + 50.0 * f64::from(cells), 310.0 - 500.0 * (ratio - 0.5));
    let mut out = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"520\" height=\"370\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"520\" height=\"370\" fill=\"white\"/>\n\
         <text x=\"60\" y=\"24\">Deflection of a cantilever over that of Timoshenko's beam</text>\n",
    );
    for tick in [0.5, 0.6, 0.7, 0.8, 0.9, 1.0] {
        let (x, y) = at(0, tick);
        let color = if tick < 1.0 { "#ddd" } else { "#888" };
        let _ = writeln!(out, "<path d=\"M{x} {y:.0}H500\" stroke=\"{color}\"/>");
        let _ = writeln!(out, "<text x=\"{}\" y=\"{:.0}\" text-anchor=\"end\">{tick:.1}</text>", x - 8.0, y + 4.0);
    }
    let line: Vec<String> =
        curve.iter().map(|&(cells, ratio)| at(cells, ratio)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let _ =
        writeln!(out, "<polyline points=\"{}\" fill=\"none\" stroke=\"#c2410c\" stroke-width=\"2\"/>", line.join(" "));
    for &(cells, ratio) in curve {
        let (x, y) = at(cells, ratio);
        let _ = writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"#c2410c\"/>");
        let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{ratio:.3}</text>", y - 10.0);
        let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"328\" text-anchor=\"middle\">{cells}</text>");
    }
    out.push_str("<text x=\"280\" y=\"354\" text-anchor=\"middle\">cells across the thickness</text>\n</svg>\n");
    out
}

/// Compares a shown file with what was measured; the fresh one is left beside the test's other output.
fn is_shown(file: &str, fresh: &str) -> bool {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(root.join(file)).is_ok_and(|shown| shown.contains(fresh))
}

#[test]
fn a_cantilever_comes_nearer_to_beam_theory_with_every_cell_across_it() {
    let curve: Vec<_> = THICKNESS.iter().map(|&cells| (cells, deflection(cells))).collect();
    for pair in curve.windows(2) {
        assert!(pair[0].1 < pair[1].1 && pair[1].1 < 1.0, "from the stiff side: {curve:?}");
    }
    assert!(curve[0].1 > 0.6 && curve[4].1 > 0.95, "not too stiff: {curve:?}");
    let picture = svg(&curve);
    let fresh = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cantilever.svg");
    std::fs::write(&fresh, &picture).expect("the target folder can be written to");
    let figures: Vec<_> = curve.iter().map(|(_, ratio)| format!("{ratio:.3}")).collect();
    let row = format!("| deflection | {} |", figures.join(" | "));
    assert!(is_shown("assets/cantilever.svg", &picture), "assets/cantilever.svg is not {}", fresh.display());
    assert!(is_shown("README.md", &row), "the README's row of deflections is not {row}");
}

#[test]
fn the_comparison_sees_a_figure_that_was_not_measured() {
    assert!(!is_shown("assets/cantilever.svg", &svg(&[(2, 0.123)])), "another curve");
    assert!(!is_shown("assets/none.svg", ""), "no file at all");
}
