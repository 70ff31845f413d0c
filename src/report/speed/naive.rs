//! The naive loop that everybody writes first: particles and springs as structures in two lists, with springs, gravity and
//! semi-implicit Euler only.

use glam::Vec3;

use crate::physics::Simulation;

/// Gravity, m/s².
const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

#[derive(Debug)]
struct Particle {
    position: Vec3,
    velocity: Vec3,
    force: Vec3,
    mass: f32,
}

#[derive(Debug)]
struct Spring {
    ends: [usize; 2],
    stiffness: f32,
    damping: f32,
    rest_length: f32,
}

/// A body as a first program stores it.
#[derive(Debug)]
pub struct Naive {
    particles: Vec<Particle>,
    springs: Vec<Spring>,
}

impl Naive {
    /// The first body of a simulation, at rest.
    pub fn new(simulation: &Simulation<f32>) -> Self {
        let body = &simulation.model().bodies[0];
        let particle = |position: &Vec3| Particle {
            position: *position,
            velocity: Vec3::ZERO,
            force: Vec3::ZERO,
            mass: body.particle_mass,
        };
        let springs = body.links.iter().flat_map(|family| {
            family.links.iter().map(|link| Spring {
                ends: link.ends.map(|end| end as usize),
                stiffness: family.stiffness,
                damping: family.damping,
                rest_length: link.rest_length,
            })
        });
        Self { particles: body.start.iter().map(particle).collect(), springs: springs.collect() }
    }

    /// Takes a step of `dt` (s).
    pub fn step(&mut self, dt: f32) {
        let Self { particles, springs } = self;
        for particle in particles.iter_mut() {
            particle.force = GRAVITY * particle.mass;
        }
        for spring in springs.iter() {
            let [a, b] = spring.ends;
            let difference = particles[b].position - particles[a].position;
            let length = difference.length();
            let direction = difference / length;
            let rate = (particles[b].velocity - particles[a].velocity).dot(direction);
            let size =
                spring.stiffness * (length / spring.rest_length - 1.0) + spring.damping * rate / spring.rest_length;
            particles[a].force += direction * size;
            particles[b].force -= direction * size;
        }
        for particle in particles.iter_mut() {
            particle.velocity += particle.force * (dt / particle.mass);
            particle.position += particle.velocity * dt;
        }
    }

    /// The height of the middle of all particles, m.
    pub fn height(&self) -> f64 {
        let sum: f64 = self.particles.iter().map(|particle| f64::from(particle.position.y)).sum();
        sum / self.particles.len() as f64
    }
}
