//! What is offered to someone whose simulation broke: true words, and cures that cure.

use std::path::PathBuf;

use super::*;
use crate::report::extremes::{Edition, extreme_of};
use crate::report::judge::{Patience, judge};
use crate::scene::edit::Edit;
use crate::scene::presets::preset;
use crate::scene::settings::{ContactRule, Integrator, Stepping};
use crate::scene::{Material, Solid};

fn open(scene: Scene) -> Session {
    Session::new(scene, PathBuf::new(), String::new()).expect("it resolves")
}

/// The preset that explodes, changed.
fn exploding(change: impl FnOnce(&mut Scene)) -> Scene {
    let mut scene = (preset("exploding").expect("a preset").build)();
    change(&mut scene);
    scene
}

fn explode(scene: &Scene) -> Trouble {
    let mut session = open(scene.clone());
    for _ in 0..200_000 {
        if !session.step() {
            break;
        }
    }
    session.find_cures();
    session.status().trouble.expect("it explodes")
}

fn cured(scene: &Scene, cure: &Cure) -> Scene {
    let mut cured = scene.clone();
    let _undo = cured.apply(cure.edit.clone()).expect("a cure is allowed");
    cured
}

/// Every cure that is offered for a scene holds for a second, and there is one.
fn check(scene: &Scene, what: &str) -> Trouble {
    let trouble = explode(scene);
    assert!(!trouble.cures.is_empty() && !trouble.looking, "{what}: {trouble:?}");
    for cure in &trouble.cures {
        let session = open(cured(scene, cure));
        let patience = Patience { seconds: 1.0, most_link_forces: u64::MAX };
        let verdict = judge::<f32>(session.scene(), &session.bodies.lattices(), patience);
        assert_eq!(verdict.fault, None, "{what}: {}: {verdict:?}", cure.words);
    }
    trouble
}

#[test]
fn every_cure_that_is_offered_holds_and_no_step_cures_a_scheme_without_a_stable_one() {
    check(&exploding(|_| ()), "as it is");
    check(
        &exploding(|scene| {
            scene.bodies[0].material = Material::Solid(Solid { young_modulus: 1e7, ..Solid::default() });
        }),
        "a solid",
    );
    check(&exploding(|scene| scene.settings.integrator = Integrator::Verlet), "Verlet");
    for integrator in [Integrator::Explicit, Integrator::Rk2] {
        for stepping in [Stepping::Auto, Stepping::Manual] {
            let scene = exploding(|scene| {
                (scene.settings.integrator, scene.settings.stepping) = (integrator, stepping);
                // On the ground RK2 leaves steps to semi-implicit Euler, in parts that are stable up to its own limit.
                scene.settings.dt = 2e-3;
            });
            let trouble = check(&scene, integrator.name());
            assert!(trouble.words.contains("no stable step"), "the reason: {}", trouble.words);
            let kept = |cure: &Cure| matches!(&cure.edit, Edit::Settings(new) if new.integrator == integrator);
            assert!(!trouble.cures.iter().any(kept), "{integrator:?}: {:?}", trouble.cures);
        }
    }
}

#[test]
fn trials_that_are_stopped_do_nothing_and_go_on_to_the_same_cures() {
    let scene = exploding(|_| ());
    let straight = explode(&scene).cures;
    let mut session = open(scene);
    while session.step() {}
    let stop = Arc::new(AtomicBool::new(true));
    session.set_stop(Arc::clone(&stop));
    session.find_cures();
    assert!(session.is_looking_for_cures() && session.status().trouble.expect("trouble").cures.is_empty(), "stopped");
    let mut stopped = 0;
    while let Some(trials) = session.trials.as_mut().filter(|trials| !trials.are_over()) {
        stopped += u64::from(trials.given_up(&stop));
        trials.run_until(Instant::now().checked_add(Duration::from_millis(1)), &AtomicBool::new(false));
    }
    assert!(stopped > 10, "{stopped} substeps were given up");
    let cures = session.status().trouble.expect("trouble").cures;
    assert_eq!(cures.len(), straight.len(), "{cures:?}");
    assert!(cures.iter().zip(&straight).all(|(a, b)| a.words == b.words), "{cures:?}");
}

#[test]
fn a_step_or_a_material_that_is_offered_ends_below_the_limit_it_names() {
    let scene = exploding(|_| ());
    let trouble = check(&scene, "as it is");
    let limit = step_words::limit_text(open(scene.clone()).status().dt_safe_secs);
    assert!(trouble.words.contains(&format!("the largest safe step is {limit}")), "{}", trouble.words);
    assert!(trouble.cures.iter().any(|cure| cure.words == format!("Use a step of {limit}")), "the same number");
    for cure in &trouble.cures {
        let status = open(cured(&scene, cure)).status();
        assert!(status.dt_secs <= status.dt_safe_secs * (1.0 + 1e-12), "{}: {status:?}", cure.words);
    }
}

#[test]
fn what_is_looked_for_in_slices_is_what_is_found_at_once() {
    let scene = exploding(|_| ());
    let mut session = open(scene.clone());
    while session.step() {}
    let mut slices = 0;
    while session.status().trouble.is_some_and(|trouble| trouble.looking) {
        session.advance(Duration::ZERO, Duration::from_millis(1));
        slices += 1;
    }
    assert!(slices > 3, "nobody waits: {slices}");
    assert_eq!(session.status().trouble.expect("it exploded").cures, explode(&scene).cures);
}

/// A cube in the air, torn apart by steps of explicit Euler.
fn torn_in_the_air() -> (Session, usize) {
    let mut scene = (preset("cube-on-plane").expect("a preset").build)();
    let settings = &mut scene.settings;
    (settings.integrator, settings.stepping, settings.dt) = (Integrator::Explicit, Stepping::Manual, 5e-3);
    let mut session = open(scene);
    let steps = (0..1000).take_while(|_| session.step()).count();
    (session, steps)
}

#[test]
fn an_explosion_without_a_stable_step_marks_links_and_tells_of_the_state_that_stands() {
    let (session, steps) = torn_in_the_air();
    let status = session.status();
    assert!((2..1000).contains(&steps) && (status.time_secs - 5e-3 * steps as f64).abs() < 1e-9, "{steps} steps stand");
    assert!(!status.trouble.expect("it exploded").guilty_links.is_empty(), "the links that tear it apart are marked");
    assert_eq!((status.contacts, session.report.last.max_penetration_m), (0, 0.0), "it is in the air");
    let figures = run::run(&mut open(session.scene().clone()), 1.0, &());
    assert_eq!((figures.contacts, figures.body_contacts, figures.finite), (0, 0, false), "as a script reads it");
}

#[test]
fn to_play_what_exploded_is_to_start_again() {
    let (mut session, _) = torn_in_the_air();
    assert!(session.status().trouble.is_some_and(|trouble| trouble.stopped), "only a new start lets time run");
    session.handle(Command::Play).expect("always possible");
    let status = session.status();
    assert_eq!((status.playing, status.time_secs, status.trouble), (true, 0.0, None), "from the beginning");
}

/// Words that belong in a file and not on a screen.
fn is_jargon(words: &str) -> bool {
    let path = ["settings.", "bodies.", "obstacles.", "Obstacles.", "Bodies."].iter().any(|path| words.contains(path));
    let letters: Vec<char> = words.chars().collect();
    let snake = letters.windows(3).any(|w| w[0].is_alphanumeric() && w[1] == '_' && w[2].is_alphanumeric());
    path || snake
}

#[test]
fn what_a_person_reads_has_no_paths_in_it() {
    let mut read = Vec::new();
    for number in 0..60 {
        let mut scene = extreme_of(Edition::First, 7, number).0;
        scene.settings.stepping = if number % 2 == 0 { Stepping::Manual } else { Stepping::Auto };
        for obstacle in &mut scene.obstacles {
            obstacle.friction_dynamic = obstacle.friction_static + 0.1;
        }
        scene.settings.integrator = Integrator::ALL[usize::try_from(number % 6).unwrap_or(0)];
        if number % 5 == 0 {
            scene.settings.contact = ContactRule::Thesis;
        }
        let mut session = open(scene);
        read.extend(session.warnings());
        for _ in 0..50 {
            if !session.step() {
                break;
            }
        }
        let status = session.status();
        read.extend([status.message, status.limited_by, status.dt_limited_by]);
        read.extend(status.trouble.into_iter().flat_map(|trouble| [trouble.title, trouble.words]));
    }
    let scene = exploding(|_| ());
    read.extend(explode(&scene).cures.into_iter().map(|cure| cure.words));
    let mut session = open(scene.clone());
    let refused = Edit::Settings(crate::scene::Settings { dt: 7.0, ..scene.settings });
    read.push(session.handle(Command::Edit(refused)).expect_err("out of range").to_string());
    let spoken: Vec<_> = read.iter().filter(|words| !words.is_empty()).collect();
    assert!(spoken.len() > 60, "there is much to say: {}", spoken.len());
    for words in spoken {
        assert!(!is_jargon(words), "{words}");
    }
    assert!(is_jargon("settings.dt = 7 s") && is_jargon("allow_implicit"), "the test can fail");
}
