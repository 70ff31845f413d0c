//! The comparison: the same links must give the same body, and another body must be found out.

use super::contender::Tuning;
use super::pile::PileFigures;
use super::words::{advice, csv, markdown};
use super::*;

fn cube(young_modulus: f64) -> Cube {
    Cube::hanging(3, Solid { young_modulus, ..Solid::default() }).expect("a cube")
}

fn compared(theirs: &Cube) -> PeersFigures {
    compare([&cube(1e5), theirs], 6.0 * SAMPLE_INTERVAL_SECS, &()).expect("not cancelled")
}

#[test]
fn another_engine_with_our_links_hangs_and_swings_as_ours() {
    let figures = compared(&cube(1e5));
    assert_eq!(figures.defects, Vec::<String>::new());
    assert!((0.03..0.06).contains(&figures.sag_m), "{} m", figures.sag_m);
    for MatchedPeer { peer, same_sag, sag_m, .. } in &figures.peers {
        assert!(same_sag, "{peer:?} hangs {sag_m} m low, ours {} m", figures.sag_m);
    }
    let finest = |contender: Contender| figures.rows.iter().rfind(|row| row.contender == contender).expect("a row");
    let links = finest(Contender::Peer(Peer::Links));
    assert!(links.rest_rms_m < 1e-5, "the same links rest at the same places: {links:?}");
    assert!(links.swing_rms_m < Some(1e-3), "and swing alike: {links:?}");
    let cells = finest(Contender::Peer(Peer::Cells));
    assert!(cells.rest_rms_m > 30.0 * links.rest_rms_m, "cells are another body: {cells:?}");
    assert_eq!(csv(std::slice::from_ref(&figures)).lines().count(), figures.rows.len() + 1);
    let page = markdown(&[figures], &PileFigures::default());
    assert!(page.contains("rapier, our links") && !page.contains("another sag"), "{page}");
}

#[test]
fn a_peer_of_another_stiffness_is_found_out() {
    let figures = compared(&cube(1.3e5));
    assert!(figures.defects.iter().any(|defect| defect.contains("0.7")), "1/1.3 = 0.77: {:?}", figures.defects);
    assert!(markdown(&[figures], &PileFigures::default()).contains("only with 0.7"), "the page says so");
    let ours = cube(1e5);
    let still = run_to_rest(&ours, Peer::Links, Tuning { stiffness: 1.3, ..Peer::Links.start(&ours) }, 0.008, &());
    let sag = |still: &[[f64; 3]]| ours.sag(still);
    let (stiff, ours) = (sag(&still.expect("it rests")), sag(&ours.rest_positions(&()).expect("it rests")));
    assert!(!is_same_sag(stiff, ours) && stiff < 0.9 * ours, "untuned it hangs {stiff} m low, ours {ours} m");
}

fn row(contender: Contender, error_m: f64, secs: f64, same_sag: bool) -> Row {
    Row {
        contender,
        dt_secs: 0.004,
        sag_m: 0.05,
        same_sag,
        swing_rms_m: error_m.is_finite().then_some(error_m),
        rest_rms_m: 0.0,
        wall_secs_median: 2.0 * secs,
        wall_secs_min: secs,
        wall_secs_max: 3.0 * secs,
        processor_secs_median: secs,
        processor_secs_min: secs,
        processor_secs_max: secs,
        pareto: false,
    }
}

#[test]
fn only_bodies_of_the_same_sag_are_compared() {
    let (ours, theirs) = (Contender::Ours(SteppingMethod::Automatic), Contender::Peer(Peer::Cells));
    let mut rows = vec![
        row(ours, 5e-4, 0.02, true),
        row(theirs, 5e-4, 0.05, true),
        row(theirs, 1e-4, 0.01, false),
        row(theirs, f64::INFINITY, 0.001, true),
    ];
    mark_pareto(&mut rows);
    assert_eq!(rows.iter().map(|row| row.pareto).collect::<Vec<_>>(), [true, false, false, false]);
    let figures = PeersFigures {
        divisions: 5,
        particles: 1,
        links: 1,
        simulated_secs: 1.0,
        sag_m: 0.05,
        reference_dt_secs: 1e-5,
        reference_error_m: 1e-9,
        peers: Vec::new(),
        defects: defects(&[], &rows),
        rows,
    };
    assert!(advice(&figures, 1e-3).ends_with("rapier, cells with a step of 4 ms: 50.0 ms: 2.5 times ours."));
    assert!(
        advice(&figures, 1e-4).starts_with("Nothing measured stays below 0.1 mm"),
        "the one of another sag does not count"
    );
    let page = markdown(std::slice::from_ref(&figures), &PileFigures::default());
    assert!(page.contains("(another sag)") && page.contains("| diverged |"), "{page}");
    assert_eq!(figures.defects.len(), 1, "there are no figures of the same links: {:?}", figures.defects);
}
