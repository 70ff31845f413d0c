//! Random extreme scenes in automatic mode: nothing explodes (R2). The judge's own tests, in which it must find
//! something, are beside it.

use gelatin::report::extremes::{extreme_scene, lattices};
use gelatin::report::judge::{Patience, judge};

/// Another seed than that of the command, whose scenes were looked at one by one.
const SEED: u64 = 7;

const SCENES: u64 = 300;

#[test]
fn no_extreme_scene_explodes() {
    let patience = Patience { seconds: 2.0, most_link_forces: 2_000_000 };
    let mut found = Vec::new();
    let mut whole = 0;
    for number in 0..SCENES {
        let scene = extreme_scene(SEED, number);
        let verdict = judge::<f32>(&scene, &lattices(&scene).expect("sound shapes"), patience);
        whole += u64::from(!verdict.cut_short);
        found.extend(verdict.fault.map(|fault| format!("scene {number}: {}: {}", fault.words(), verdict.words)));
    }
    assert!(found.is_empty(), "{} of {SCENES}:\n{}", found.len(), found.join("\n"));
    assert!(whole > SCENES / 2, "only {whole} of {SCENES} were watched to their end");
}
