//! A body that moves by its modes: each is an oscillator of its own, whatever the number of cells (SC §5).
//!
//! ```text
//!   q'' + c q' + ω² q = f        c = φᵀ C φ,  f = φᵀ F
//! ```
//!
//! Over a step in which `f` stays the same the solution is exact, so that no step is too long and no frequency too high.
//! The pull of a hand is a spring at a point of the body, taken implicitly as in `physics::step::pull`: with the modes' part
//! in that point `P` (3 × modes) the impulse is `(1 + r P Pᵀ) J = dt k (target − p) − r p'`, `r = dt (dt k + d)`.
//!
//! The motion is linear and about the place of rest, so it is one of bodies that are held somewhere: a free one would have
//! to turn.

use glam::{DMat3, DVec3};

use super::{Mode, Modes};
use crate::math::Real;
use crate::physics::BodyModel;

/// A body's modes, made ready for steps of one length.
#[derive(Clone, Debug)]
pub struct ModalModel {
    oscillators: Vec<Oscillator>,
    /// By particle and mode, 1/√kg: what a particle moves by is a row of these with the amplitudes.
    shapes: Vec<[f32; 3]>,
    /// What a uniform acceleration along each axis of the body does to every mode, √kg.
    loads: Vec<DVec3>,
    /// Mass of the body, kg.
    mass: f64,
    dt_secs: f64,
}

/// How far every mode is from rest and how fast it goes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModalState {
    /// `q`, m √kg.
    pub amplitude: Vec<f64>,
    /// `q'`, m √kg / s.
    pub rate: Vec<f64>,
}

/// A hand that pulls a body by a point.
#[derive(Clone, Debug, PartialEq)]
pub struct ModalPull {
    /// The particles that carry the point and their weights, which sum to 1; numbers of the body.
    pub weights: Vec<(usize, f64)>,
    /// How far from its place at rest the point is pulled to, m, in the body's coordinates.
    pub target: DVec3,
    /// Stiffness of the pull, N/m; its damping is half the critical one of the whole body on that spring.
    pub stiffness: f64,
}

/// What a step does to an oscillator: the exact solution for a force that stays the same.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Oscillator {
    /// What the amplitude is after the step for one of 1, and for a rate of 1, s.
    amplitude: [f64; 2],
    /// The same of the rate, 1/s and without unit.
    rate: [f64; 2],
    /// What a force of 1 adds to both.
    force: [f64; 2],
}

impl Oscillator {
    fn new(omega: f64, damping: f64, dt: f64) -> Self {
        let half = 0.5 * damping;
        let square = omega * omega - half * half;
        let decay = libm::exp(-half * dt);
        // `cosine` and `sine` are e^{−ct/2} cos wt and e^{−ct/2} sin(wt)/w, of a w that may be imaginary.
        let [cosine, sine] = if square.abs() * dt * dt < 1e-12 {
            [decay, decay * dt]
        } else if square > 0.0 {
            let w = square.sqrt();
            [decay * libm::cos(w * dt), decay * libm::sin(w * dt) / w]
        } else {
            // No power is positive, as w is at most half the damping.
            let w = (-square).sqrt();
            let [slow, fast] = [w - half, -w - half].map(|power| libm::exp(power * dt));
            [0.5 * (slow + fast), 0.5 * (slow - fast) / w]
        };
        let stays = cosine + half * sine;
        let pushed = if omega * dt > 1e-4 {
            (1.0 - stays) / (omega * omega)
        } else if damping * dt > 1e-4 {
            (dt - sine) / damping
        } else {
            // The first terms of the series, as the differences above would be rounding.
            0.5 * dt * dt * (1.0 - damping * dt / 3.0)
        };
        Self { amplitude: [stays, sine], rate: [-omega * omega * sine, cosine - half * sine], force: [pushed, sine] }
    }
}

impl ModalModel {
    /// The modes of a compiled body for steps of `dt_secs`.
    pub fn new<R: Real>(body: &BodyModel<R>, modes: &Modes, dt_secs: f64) -> Self {
        let modes = &modes.modes;
        let oscillators = modes.iter().map(|mode| Oscillator::new(mode.angular_frequency(), mode.damping, dt_secs));
        let particles = body.start.len();
        let shapes = (0..particles).flat_map(|p| modes.iter().map(move |mode| mode.shape[p].as_vec3().to_array()));
        let load = |mode: &Mode| (0..particles).map(|p| mode.shape[p] * body.mass(p).to_f64()).sum();
        Self {
            oscillators: oscillators.collect(),
            shapes: shapes.collect(),
            loads: modes.iter().map(load).collect(),
            mass: body.total_mass().to_f64(),
            dt_secs,
        }
    }

    /// How many modes there are.
    pub fn count(&self) -> usize {
        self.oscillators.len()
    }

    /// At rest.
    pub fn start(&self) -> ModalState {
        ModalState { amplitude: vec![0.0; self.count()], rate: vec![0.0; self.count()] }
    }

    /// Takes a step under an acceleration of the whole body (m/s², in its coordinates) and a hand's pull. It costs as much
    /// as there are modes.
    pub fn step(&self, state: &mut ModalState, acceleration: DVec3, pull: Option<&ModalPull>) {
        if let Some(pull) = pull {
            self.pull(state, pull);
        }
        let modes = self.oscillators.iter().zip(&self.loads).zip(state.amplitude.iter_mut().zip(&mut state.rate));
        for ((oscillator, load), (amplitude, rate)) in modes {
            let (q, v, force) = (*amplitude, *rate, load.dot(acceleration));
            let [a, b] = oscillator.amplitude;
            let [c, d] = oscillator.rate;
            let [to_amplitude, to_rate] = oscillator.force;
            *amplitude = a * q + b * v + to_amplitude * force;
            *rate = c * q + d * v + to_rate * force;
        }
    }

    /// Changes the rates by the impulse of a hand.
    fn pull(&self, state: &mut ModalState, pull: &ModalPull) {
        let part = |mode: usize| self.part(pull, mode);
        let (mut point, mut speed, mut mobility) = (DVec3::ZERO, DVec3::ZERO, DMat3::ZERO);
        for mode in 0..self.count() {
            let way = part(mode);
            point += way * state.amplitude[mode];
            speed += way * state.rate[mode];
            mobility += DMat3::from_cols(way * way.x, way * way.y, way * way.z);
        }
        let dt = self.dt_secs;
        let resistance = dt * (dt * pull.stiffness + (pull.stiffness * self.mass).sqrt());
        let pulling = (pull.target - point) * (dt * pull.stiffness) - speed * resistance;
        let impulse = (DMat3::IDENTITY + mobility * resistance).inverse() * pulling;
        for mode in 0..self.count() {
            state.rate[mode] += part(mode).dot(impulse);
        }
    }

    /// How far the point of a pull moves with an amplitude of 1, 1/√kg.
    fn part(&self, pull: &ModalPull, mode: usize) -> DVec3 {
        let of = |&(particle, weight): &(usize, f64)| {
            DVec3::from(self.shapes[particle * self.count() + mode].map(f64::from)) * weight
        };
        pull.weights.iter().map(of).sum()
    }

    /// How far every particle is from rest, m, in the body's coordinates: what is drawn, and the only thing that costs
    /// more with more cells.
    #[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than single precision")]
    pub fn displacements(&self, state: &ModalState, to: &mut Vec<[f32; 3]>) {
        let amplitudes: Vec<f32> = state.amplitude.iter().map(|&q| q as f32).collect();
        to.clear();
        if self.count() == 0 {
            return;
        }
        to.extend(self.shapes.chunks_exact(self.count()).map(|row| {
            row.iter().zip(&amplitudes).fold([0.0; 3], |sum, (way, q)| [0, 1, 2].map(|axis| sum[axis] + way[axis] * q))
        }));
    }
}

impl Modes {
    /// What the modes take up of a motion of all particles of the body: displacements from rest (m) and velocities (m/s) in
    /// the body's coordinates.
    pub fn project<R: Real>(&self, body: &BodyModel<R>, [displacement, velocity]: [&[DVec3]; 2]) -> ModalState {
        let onto = |of: &[DVec3]| -> Vec<f64> {
            let part = |mode: &Mode| {
                let of_particle = |p: usize| body.mass(p).to_f64() * mode.shape[p].dot(of[p]);
                (0..of.len()).map(of_particle).sum()
            };
            self.modes.iter().map(part).collect()
        };
        ModalState { amplitude: onto(displacement), rate: onto(velocity) }
    }

    /// The energy of a motion, J: kinetic and elastic.
    pub fn energy(&self, state: &ModalState) -> [f64; 2] {
        let kinetic = state.rate.iter().map(|v| 0.5 * v * v).sum();
        let elastic = self.modes.iter().zip(&state.amplitude).map(|(mode, q)| {
            let swing = mode.angular_frequency() * q;
            0.5 * swing * swing
        });
        [kinetic, elastic.sum()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same by many small steps of Verlet's scheme.
    fn followed(omega: f64, damping: f64, force: f64, [mut q, mut v]: [f64; 2], secs: f64) -> [f64; 2] {
        let steps = 200_000;
        let dt = secs / f64::from(steps);
        for _ in 0..steps {
            // The middle of the step, with what the damping takes in it solved for.
            let half = q + 0.5 * dt * v;
            v = (v * (1.0 - 0.5 * dt * damping) + dt * (force - omega * omega * half)) / (1.0 + 0.5 * dt * damping);
            q = half + 0.5 * dt * v;
        }
        [q, v]
    }

    #[test]
    fn a_step_of_any_length_is_exact() {
        for (omega, damping) in [(3.0, 0.0), (3.0, 0.4), (3.0, 6.0), (3.0, 40.0), (0.0, 0.0), (0.0, 2.0), (1e-6, 1e-6)]
        {
            for secs in [0.01, 0.7, 5.0] {
                let Oscillator { amplitude, rate, force } = Oscillator::new(omega, damping, secs);
                let [q, v, f] = [0.7, -1.1, 2.5];
                let found = [amplitude, rate].map(|[of_q, of_v]| of_q * q + of_v * v);
                let found = [found[0] + force[0] * f, found[1] + force[1] * f];
                let expected = followed(omega, damping, f, [q, v], secs);
                for (found, expected) in found.into_iter().zip(expected) {
                    let off = (found - expected).abs();
                    assert!(
                        off < 1e-6 * (1.0 + expected.abs()),
                        "ω {omega}, c {damping}, {secs} s: {found} for {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_is_damped_beyond_measure_stays_finite() {
        for (omega, damping, dt) in [(1e6, 1e12, 10.0), (1e6, 0.0, 10.0), (1e-9, 1e9, 1e3)] {
            let Oscillator { amplitude, rate, force } = Oscillator::new(omega, damping, dt);
            assert!([amplitude, rate, force].iter().flatten().all(|x| x.is_finite()), "ω {omega}, c {damping}");
            assert!(amplitude[0].abs() <= 1.0 + 1e-12, "nothing grows: {}", amplitude[0]);
        }
    }
}
