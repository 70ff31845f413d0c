//! The fastest vibrations of a body by power iteration: the reference for the bounds.

use glam::DVec3;

use crate::math::rng::Rng;
use crate::physics::model::BodyModel;

/// Returns the largest eigenvalues of `M⁻¹ K` and of `M⁻¹ C`, by power iteration over all links.
pub(super) fn fastest(body: &BodyModel<f64>, position: &[DVec3]) -> [f64; 2] {
    [false, true].map(|of_damping| {
        let mut rng = Rng::new(3);
        let mut way: Vec<DVec3> =
            position.iter().map(|_| DVec3::from([0; 3].map(|_| rng.between(-1.0, 1.0)))).collect();
        let mut eigenvalue = 0.0;
        for _ in 0..400 {
            let mut pull = vec![DVec3::ZERO; way.len()];
            for family in &body.links {
                for (number, link) in family.links.iter().enumerate() {
                    let [i, j] = link.ends.map(|end| end as usize);
                    let d = position[j] - position[i];
                    let (unit, tension) =
                        (d / d.length(), (1.0 - 1.0 / (link.inverse_rest_length * d.length())).max(0.0));
                    let apart = way[j] - way[i];
                    let part = unit * unit.dot(apart);
                    let [stiffness, damping] = family.constants(number);
                    let (constant, across) = if of_damping { (damping, 0.0) } else { (stiffness, tension) };
                    let f = (part + (apart - part) * across) * constant * link.inverse_rest_length;
                    pull[i] -= f;
                    pull[j] += f;
                }
            }
            for (particle, pull) in pull.iter_mut().enumerate() {
                *pull = if body.is_pinned(particle) { DVec3::ZERO } else { *pull * body.inverse_mass(particle) };
            }
            eigenvalue = pull.iter().map(|pull| pull.length_squared()).sum::<f64>().sqrt();
            way = pull.into_iter().map(|pull| pull / eigenvalue).collect();
        }
        eigenvalue
    })
}
