//! Beams held at one end and loaded at the other, a few cells thick: compares the lattice with beam theory, and the curve
//! shown in `assets/cantilever.svg` and the README with the measured one.

use std::fmt::Write as _;
use std::path::Path;

use gelatin::report::error::cells::cantilever;

/// Cells across the thickness.
const THICKNESS: [u32; 5] = [2, 3, 4, 5, 8];

/// The deflection of the loaded end over that of beam theory.
fn deflection(cells: u32) -> f64 {
    let (found, theory) = cantilever(cells).expect("it is held");
    found / theory
}

/// The curve as a picture: deflection over theory against cells across.
fn svg(curve: &[(u32, f64)]) -> String {
    let at = |cells: u32, ratio: f64| (60.0 + 50.0 * f64::from(cells), 310.0 - 500.0 * (ratio - 0.5));
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

/// Whether a shown file contains the measured text; the fresh one is left beside the test's other output.
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
