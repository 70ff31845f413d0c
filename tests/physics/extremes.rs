//! Random extreme scenes in automatic mode: nothing explodes. The judge's own tests, in which it must find faults, are
//! beside it.

use gelatin::report::extremes::{Edition, extreme_of, lattices};
use gelatin::report::judge::{Patience, judge_disturbed};
use gelatin::scene::{Body, Material};

/// Another seed than the command's, whose scenes were examined one by one.
const SEED: u64 = 7;

const SCENES: u64 = 300;

#[test]
fn no_extreme_scene_explodes() {
    let patience = Patience { seconds: 2.0, most_link_forces: 2_000_000 };
    let mut found = Vec::new();
    let mut whole = 0;
    for number in 0..SCENES {
        let (scene, disturbances) = extreme_of(Edition::First, SEED, number);
        let lattices = lattices(&scene).expect("sound shapes");
        let verdict = judge_disturbed::<f32>(&scene, &disturbances, &lattices, patience);
        whole += u64::from(!verdict.cut_short);
        found.extend(verdict.fault.map(|fault| format!("scene {number}: {}: {}", fault.words(), verdict.words)));
    }
    assert!(found.is_empty(), "{} of {SCENES}:\n{}", found.len(), found.join("\n"));
    assert!(whole > SCENES / 2, "only {whole} of {SCENES} were watched to their end");
}

#[test]
fn no_extreme_scene_of_mixed_springs_explodes() {
    let patience = Patience { seconds: 2.0, most_link_forces: 2_000_000 };
    let mut scenes = 0;
    for number in 0..SCENES {
        let (scene, disturbances) = extreme_of(Edition::Third, SEED, number);
        let is_mixed = |body: &Body| matches!(body.material, Material::Springs(_)) && !body.inlays.is_empty();
        if !is_mixed(&scene.bodies[0]) {
            continue;
        }
        let lattices = lattices(&scene).expect("sound shapes");
        let verdict = judge_disturbed::<f32>(&scene, &disturbances, &lattices, patience);
        assert_eq!(verdict.fault, None, "scene {number}: {}", verdict.words);
        scenes += 1;
    }
    assert!(scenes > 20, "only {scenes} of {SCENES} are of two springs");
}

#[test]
fn no_extreme_scene_of_several_bodies_explodes() {
    let patience = Patience { seconds: 2.0, most_link_forces: 2_000_000 };
    let (mut scenes, mut most) = (0, 0);
    for number in 0..SCENES {
        let (scene, disturbances) = extreme_of(Edition::Sixth, SEED, number);
        if scene.bodies.len() == 1 {
            continue;
        }
        let lattices = lattices(&scene).expect("sound shapes");
        let verdict = judge_disturbed::<f32>(&scene, &disturbances, &lattices, patience);
        assert_eq!(verdict.fault, None, "scene {number}: {}", verdict.words);
        (scenes, most) = (scenes + 1, most.max(scene.bodies.len()));
    }
    assert!(scenes > 40 && most == 6, "{scenes} of {SCENES} are of several bodies, at most {most}");
}

#[test]
fn scenes_that_once_exploded_do_not() {
    // A plane that begins to turn under a light cube beside a ball; a cube that begins deep within two planes; damping of
    // 7e4 N·s on 1e-6 kg, of which no explicit step takes what halvings leave.
    // Of another seed a cube 400 m large that weighs 35 g: single precision shakes it.
    // A plane that has just come to a body that falls away from it; particles that one obstacle presses into another.
    // A particle under a plate that comes down aslant to a floor; a cube that swings across the limit of strain; particles
    // that an obstacle leaves pinched against another.
    // A plate whose sublattices fall apart, with cells a hundred times as wide as at rest; a cube of shear links that its
    // own weight crushes and stretches.
    // A plane that drags particles over a rough sphere against their links; one that presses a very light body, stiffly.
    // A cube that folds along its structural links, whose damping alone sets the step.
    // Cubes and a plate of families far apart, whose links are stretched while they are soft; one that is pulled to shape
    // by more than its links hold.
    // Cells that a sweeping plane crushes, by Verlet.
    // A link that swings in step with evenly spaced looks; a light part that a heavy one tears from an edge.
    // Links that turn about within a substep. What one obstacle pushes into a stiff one that was looked at before.
    // A rod of a tenth of a millimetre a cell, a kilometre up. Undamped bodies whose pinned part stops the rest.
    // Soft contact in the long substeps of the stabilised scheme; light particles that it stops there.
    let scenes = [
        (1, 1914),
        (1, 7453),
        (1, 8352),
        (224_435, 420),
        (1_936_210_600, 8768),
        (104_573_344, 365),
        (3_860_054_719, 39),
        (3_860_054_719, 3884),
        (2_041_115_181, 2280),
        (2_041_115_181, 7760),
        (2_312_345_692, 293),
        (2_609_448_581, 7996),
        (1_727_241_092, 2714),
        (1_645_524_471, 5714),
        (1_727_241_092, 4972),
        (2_247_651_514, 1538),
        (1_084_358_429, 7060),
        (1_623_209_670, 3851),
        (1_623_209_670, 9354),
        (2_365_174_796, 2791),
        (2_490_027_188, 2620),
        (1_815_592_683, 4030),
        (1_623_209_670, 3728),
        (483_690_211, 7585),
        (157_923_987, 1594),
        (1_609_327_005, 9011),
        (606_990_034, 5328),
        (606_990_034, 6920),
        (1_609_327_005, 2153),
        (1_609_327_005, 2160),
        (1_609_327_005, 3228),
        (3_051_302_913, 8723),
        (3_051_302_913, 2854),
        (2_946_822_479, 7824),
        (777_041, 616),
    ];
    // A heavy body in a light one that links hold there; a light one in a heavy one that an obstacle pushes as well; a light
    // one that a heavy one hits within a substep, and has left at its end; a soft light one in the same place as a heavy one;
    // one that keeps another from going deeper. One that the stabilised scheme tears apart at an edge;
    // one whose many contacts with another have not settled. Stiff links under tension that weak ones damp across; a corner
    // of a cell that another body throws back with the motion of all eight.
    let second = [
        (2_950_612_423, 1290),
        (3_014_289_722, 662),
        (3_014_289_722, 1580),
        (3_532_797_356, 134),
        (2_313_755_053, 1455),
        (1_084_280_381, 7685),
        (2_675_233_212, 1101),
        (1_705_650_560, 993),
        (2_252_673_541, 6665),
        (2_151_317_611, 9257),
    ];
    // Soft light cells beside stiff heavy ones that are turned back from inversion; soft links beside ones that are ten thousand
    // times as stiff. One without shear stiffness whose damped bending links line up.
    let third = [
        (2_577_914_098, 522),
        (2_577_914_098, 737),
        (2_577_914_098, 855),
        (1_419_505_935, 55),
        (1_419_505_935, 205),
        (1_419_505_935, 289),
        (1_419_505_935, 327),
        (1_625_107_691, 7967),
        (3_345_416_435, 4207),
    ];
    // A bowl that begins deep within a ball and is parted from rest: the work of n pushes goes as n², its motion half a push
    // later as (n + 1/2)². A plane that sweeps through the pinned half of a model.
    // A cylinder that pinches particles of next to no links against planes; links that turn about in long substeps.
    // Stiff bodies whose contacts with another, or of the mesh with an obstacle, have not settled when the rounds end, and pull.
    // A mesh that two planes pinch; RK4 whose substeps semi-implicit Euler takes near a plane.
    // Edges of thin obstacles in bodies that begin deep in other obstacles; one that is put back while it is parted.
    let fourth = [
        (887_961_642, 304),
        (887_961_642, 3958),
        (3_376_194_074, 287),
        (692_774_577, 2303),
        (4_143_628_233, 5965),
        (4_143_628_233, 5024),
        (4_143_628_233, 7986),
        (1_924_401_159, 7768),
        (1_924_401_159, 7182),
        (2_791_829_337, 963),
        (2_791_829_337, 2215),
        (2_791_829_337, 3448),
        (2_791_829_337, 4786),
    ];
    // A cell that a point of the mesh throws back gives a corner the energy of all eight.
    // The energy of a body within a model that swings away from it: the coming push was taken as if the model stood still.
    let fifth = [(3_877_375_996, 566), (668_480_849, 3098)];
    // A body that rides on a ball which turns: what links do on the chords of its way was counted as the ball's work.
    // A plane of 4.6 km that turns by a quarter within a step: the body about to be struck had half of the energy of that.
    // A cube between a plane that turns and a capsule: the work in a motion that the implicit scheme refused was counted too.
    // Three obstacles in one cell: the rounds ended unsettled, and friction drove the sliding that was left.
    // A plane that sweeps towards a body is put elsewhere before it strikes: that push did not come.
    let sixth = [(1_012_288_173, 4041), (59_257_229, 6579), (59_257_229, 593), (59_257_229, 1483), (59_257_229, 6789)];
    let editions = [
        (Edition::First, &scenes[..]),
        (Edition::Second, &second),
        (Edition::Third, &third),
        (Edition::Fourth, &fourth),
        (Edition::Fifth, &fifth),
        (Edition::Sixth, &sixth),
    ];
    let all = editions.into_iter().flat_map(|(edition, scenes)| scenes.iter().map(move |scene| (edition, *scene)));
    for (edition, (seed, number)) in all {
        let (scene, disturbances) = extreme_of(edition, seed, number);
        let lattices = lattices(&scene).expect("sound shapes");
        let patience = Patience { seconds: 2.0, most_link_forces: 20_000_000 };
        let verdict = judge_disturbed::<f32>(&scene, &disturbances, &lattices, patience);
        assert_eq!(verdict.fault, None, "scene {number} of {seed}: {}", verdict.words);
    }
}
