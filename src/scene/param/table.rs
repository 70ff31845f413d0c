//! The table of every tunable. Reads like a list; what a row means is in the module above.

use super::definition::{Kind, MESH_PATH, MODEL_PATH, Param};
use crate::scene::VERSION;

/// Metres to the edge of the world: further out a single-precision position is coarser than a millimetre.
const MAX_COORDINATE: f64 = 1e4;

/// Every tunable of a scene.
pub const PARAMS: &[Param] = &[
    integer("version", 1, VERSION as i64, "The version of the scene format."),
    number("settings.dt", "s", 1e-6, 0.1, "The step asked for; automatic stepping divides it where it must. Well damped bodies cost less in steps of 4 ms than of 1 ms.").log(),
    words("settings.integrator", &["semi_implicit", "explicit", "verlet", "rk2", "rk4", "stabilised", "implicit"], "The scheme that advances a step; explicit and rk2 are never quite stable and step as they are told; rk2 and rk4 leave steps near obstacles and other bodies, and those in which a hand pulls, to semi_implicit."),
    words("settings.stepping", &["auto", "manual"], "Whether the program divides steps so that they stay stable."),
    words("settings.contact", &["implicit", "thesis"], "How obstacles push back; the thesis's rule is there to teach with."),
    flag("settings.body_contact", "Whether bodies meet each other; where it is off they pass through one another."),
    flag("settings.allow_implicit", "Whether automatic stepping may choose the stabilised or the implicit scheme where that is cheaper than the steps it would need."),
    flag("settings.inversion_recovery", "Whether cells that are crushed or turned inside out are pushed back to shape."),
    flag("settings.sleeping", "Whether a body at rest is left alone until something touches it or a value changes, and one that fell out of the scene until it is brought back; it costs nothing then."),
    number("settings.gravity", "m/s²", -1000.0, 1000.0, "Acceleration of gravity; a single number g means (0, −g, 0).").of(3),
    text("bodies.*.name", "What the body is called in lists."),
    integer("bodies.*.shape.cube.cells", 1, 199, "Cells along an edge of the cube."),
    number("bodies.*.shape.cube.size", "m", 1e-3, 1e3, "Edge length of the cube.").log(),
    list("bodies.*.shape.cells.list", "The filled cells as [i, j, k]."),
    integer("bodies.*.shape.cells.list.*", -1000, 1000, "Grid coordinates of a filled cell.").of(3),
    number("bodies.*.shape.cells.size", "m", 1e-4, 1e3, "Edge of a cell.").log(),
    text(MODEL_PATH, "The model file, relative to the scene file; builtin:NAME for one the program carries."),
    integer("bodies.*.shape.model.divisions", 1, 256, "Cells along the model's longest extent."),
    words("bodies.*.shape.model.occupancy", &["auto", "centre", "surface", "solid"], "Which cells of the grid are filled."),
    words("bodies.*.shape.model.keep", &["all", "largest"], "Which connected pieces of the cells are kept."),
    number("bodies.*.shape.model.length", "m", 0.0, 1e3, "Longest extent after scaling, at least 0.0001 m; 0 keeps the file's own size."),
    words("bodies.*.shape.model.up", &["auto", "y", "z", "x", "minus_y", "minus_z", "minus_x"], "The axis of the model's file that points up; auto is z where the model stands only that way, y otherwise."),
    words("bodies.*.shape.model.mass_from", &["cells", "samples"], "What a solid's mass comes from: cells that are all full, or samples of the model, which has the same mass in any number of divisions; a cell is as stiff as it is full."),
    list("bodies.*.shape.model.attached", "Cells put beside the model's own by hand, as [i, j, k] in their grid, whose lowest corner is [0, 0, 0]."),
    integer("bodies.*.shape.model.attached.*", -1000, 1000, "Grid coordinates of a cell put there by hand.").of(3),
    list("bodies.*.shape.model.erased", "Cells of the model's own taken away by hand, in the same grid."),
    integer("bodies.*.shape.model.erased.*", -1000, 1000, "Grid coordinates of a cell taken away by hand.").of(3),
    number("bodies.*.pose.position", "m", -MAX_COORDINATE, MAX_COORDINATE, "Where the middle of the body's box starts.").of(3),
    number("bodies.*.pose.rotation_deg", "°", -360.0, 360.0, "Turns about x, then y, then z (fixed axes).").of(3),
    number("bodies.*.velocity", "m/s", -1e3, 1e3, "Velocity at the start.").of(3),
    number("bodies.*.material.springs.structural.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the links to the nearest particles; seven free values make a material that is in general anisotropic.").log(),
    number("bodies.*.material.springs.structural.damping", "N·s", 0.0, 1e5, "Damping of the links to the nearest particles.").log(),
    number("bodies.*.material.springs.shear.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the diagonal links.").log(),
    number("bodies.*.material.springs.shear.damping", "N·s", 0.0, 1e5, "Damping of the diagonal links.").log(),
    number("bodies.*.material.springs.bending.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the links to the second neighbours.").log(),
    number("bodies.*.material.springs.bending.damping", "N·s", 0.0, 1e5, "Damping of the links to the second neighbours.").log(),
    number("bodies.*.material.springs.particle_mass", "kg", 1e-6, 1e3, "Mass of every particle.").log(),
    number("bodies.*.material.solid.young_modulus", "Pa", 1.0, 1e10, "Tension over strain of the solid, whatever the number of cells; Poisson's ratio is always 1/4.").log(),
    number("bodies.*.material.solid.density", "kg/m³", 1e-2, 1e5, "Mass of the solid over its volume.").log(),
    number("bodies.*.material.solid.damping_ratio", "", 0.0, 10.0, "Damping of the slowest vibration along the body; at 1 it no longer swings."),
    number("bodies.*.material.solid.poisson_ratio", "", -1.0, 0.5, "Noted, and told where it is not 1/4, which every lattice of central forces has."),
    list("bodies.*.inlays", "Boxes in body coordinates whose cells are of another material, at most 16: of another solid in a solid, of other springs in a body of springs, where a link has the mean of the cells that hold it."),
    number("bodies.*.inlays.*.min", "m", -MAX_COORDINATE, MAX_COORDINATE, "The lowest corner of a box of another material.").of(3),
    number("bodies.*.inlays.*.max", "m", -MAX_COORDINATE, MAX_COORDINATE, "The highest corner of a box of another material.").of(3),
    list("bodies.*.inlays.*.cells", "Cells of another material besides those in the box, as [i, j, k]: of a list by its coordinates, of others in their grid, whose lowest corner is [0, 0, 0]."),
    integer("bodies.*.inlays.*.cells.*", -1000, 1000, "Grid coordinates of a cell of another material.").of(3),
    number("bodies.*.inlays.*.solid.young_modulus", "Pa", 1.0, 1e10, "Tension over strain of the other solid, in a body that is a solid.").log(),
    number("bodies.*.inlays.*.solid.density", "kg/m³", 1e-2, 1e5, "Mass of the other solid over its volume.").log(),
    number("bodies.*.inlays.*.solid.damping_ratio", "", 0.0, 10.0, "Damping of the slowest vibration along a body of the other solid."),
    number("bodies.*.inlays.*.solid.poisson_ratio", "", -1.0, 0.5, "Noted, and told where it is not 1/4, which every lattice of central forces has."),
    number("bodies.*.inlays.*.springs.structural.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the links to the nearest particles within an inlay of a body of springs.").log(),
    number("bodies.*.inlays.*.springs.structural.damping", "N·s", 0.0, 1e5, "Damping of the links to the nearest particles within an inlay of a body of springs.").log(),
    number("bodies.*.inlays.*.springs.shear.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the diagonal links within an inlay of a body of springs.").log(),
    number("bodies.*.inlays.*.springs.shear.damping", "N·s", 0.0, 1e5, "Damping of the diagonal links within an inlay of a body of springs.").log(),
    number("bodies.*.inlays.*.springs.bending.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the links to the second neighbours within an inlay of a body of springs.").log(),
    number("bodies.*.inlays.*.springs.bending.damping", "N·s", 0.0, 1e5, "Damping of the links to the second neighbours within an inlay of a body of springs.").log(),
    number("bodies.*.inlays.*.springs.particle_mass", "kg", 1e-6, 1e3, "Mass of a particle within an inlay of a body of springs.").log(),
    list("bodies.*.parts", "Parts of a model, by the names in its file, that are of another material, at most 64: of another solid in a solid, of other springs in a body of springs."),
    text("bodies.*.parts.*.name", "The name of a material, a group or an object of the model's file; the first of these that has it is meant."),
    number("bodies.*.parts.*.solid.young_modulus", "Pa", 1.0, 1e10, "Tension over strain of the other solid, in a body that is a solid.").log(),
    number("bodies.*.parts.*.solid.density", "kg/m³", 1e-2, 1e5, "Mass of the other solid over its volume.").log(),
    number("bodies.*.parts.*.solid.damping_ratio", "", 0.0, 10.0, "Damping of the slowest vibration along a body of the other solid."),
    number("bodies.*.parts.*.solid.poisson_ratio", "", -1.0, 0.5, "Noted, and told where it is not 1/4, which every lattice of central forces has."),
    number("bodies.*.parts.*.springs.structural.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the links to the nearest particles within such a part of a body of springs.").log(),
    number("bodies.*.parts.*.springs.structural.damping", "N·s", 0.0, 1e5, "Damping of the links to the nearest particles within such a part of a body of springs.").log(),
    number("bodies.*.parts.*.springs.shear.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the diagonal links within such a part of a body of springs.").log(),
    number("bodies.*.parts.*.springs.shear.damping", "N·s", 0.0, 1e5, "Damping of the diagonal links within such a part of a body of springs.").log(),
    number("bodies.*.parts.*.springs.bending.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the links to the second neighbours within such a part of a body of springs.").log(),
    number("bodies.*.parts.*.springs.bending.damping", "N·s", 0.0, 1e5, "Damping of the links to the second neighbours within such a part of a body of springs.").log(),
    number("bodies.*.parts.*.springs.particle_mass", "kg", 1e-6, 1e3, "Mass of a particle within such a part of a body of springs.").log(),
    list("bodies.*.pins", "Boxes in body coordinates whose particles are held."),
    number("bodies.*.pins.*.min", "m", -MAX_COORDINATE, MAX_COORDINATE, "The lowest corner of a box whose particles are held.").of(3),
    number("bodies.*.pins.*.max", "m", -MAX_COORDINATE, MAX_COORDINATE, "The highest corner of a box whose particles are held.").of(3),
    list("bodies.*.pinned_cells", "Cells whose particles are held besides those in boxes, as [i, j, k]: of a list by its coordinates, of others in their grid, whose lowest corner is [0, 0, 0]."),
    integer("bodies.*.pinned_cells.*", -1000, 1000, "Grid coordinates of a cell whose particles are held.").of(3),
    flag("bodies.*.collides", "Whether the body meets other bodies; it always meets obstacles."),
    flag("bodies.*.self_collides", "Whether parts of the body that are apart at rest meet each other."),
    number("bodies.*.friction_static", "", 0.0, 10.0, "Coulomb coefficient between touching bodies below which they do not slide; of two bodies the geometric mean counts."),
    number("bodies.*.friction_dynamic", "", 0.0, 10.0, "Coulomb coefficient between bodies that slide past each other; of two bodies the geometric mean counts."),
    words("bodies.*.contact_on", &["cells", "mesh"], "With what a model meets obstacles and other bodies: the particles of its cells, or points on its own surface, up to eight a cell, whose forces go to the particles of the cell by their weights. Others meet its surface too where that is closed, else its cells."),
    words("bodies.*.moves_by", &["cells", "modes"], "What the motion is worked out from: all cells, or the lowest modes, at a cost that no cell adds to. A body that nothing holds moves and turns as a whole beside them. Modes are linear: right for a small swing; where a part turns far against the rest it looks wrong, it grows."),
    integer("bodies.*.mode_count", 1, 60, "How many of the lowest modes a body moves by that moves by modes; more follow a push more closely."),
    words("bodies.*.skin", &["auto", "cells"], "Which surface is drawn: the model's own where there is one, or the cells'."),
    flag("bodies.*.hidden", "Hidden bodies are not drawn but still move."),
    text("obstacles.*.name", "What the obstacle is called in lists."),
    number("obstacles.*.plane.center", "m", -MAX_COORDINATE, MAX_COORDINATE, "The middle of the plane.").of(3),
    number("obstacles.*.plane.rotation_deg", "°", -360.0, 360.0, "Turns about x, then y, then z (fixed axes); none faces up.").of(3),
    number("obstacles.*.plane.half_extents", "m", 1e-3, MAX_COORDINATE, "Half the plane's extents along its own x and z axes.").of(2).log(),
    number("obstacles.*.sphere.center", "m", -MAX_COORDINATE, MAX_COORDINATE, "The middle of the sphere.").of(3),
    number("obstacles.*.sphere.radius", "m", 1e-3, MAX_COORDINATE, "The radius of the sphere.").log(),
    number("obstacles.*.box.center", "m", -MAX_COORDINATE, MAX_COORDINATE, "The middle of the box.").of(3),
    number("obstacles.*.box.rotation_deg", "°", -360.0, 360.0, "Turns about x, then y, then z (fixed axes).").of(3),
    number("obstacles.*.box.half_extents", "m", 1e-3, MAX_COORDINATE, "Half the sides of the box along its own axes.").of(3).log(),
    number("obstacles.*.capsule.center", "m", -MAX_COORDINATE, MAX_COORDINATE, "The middle of the capsule.").of(3),
    number("obstacles.*.capsule.rotation_deg", "°", -360.0, 360.0, "Turns about x, then y, then z (fixed axes); none is upright.").of(3),
    number("obstacles.*.capsule.radius", "m", 1e-3, MAX_COORDINATE, "The radius of the capsule and of its round ends.").log(),
    number("obstacles.*.capsule.half_height", "m", 1e-3, MAX_COORDINATE, "Half the length of the capsule without its round ends.").log(),
    number("obstacles.*.cylinder.center", "m", -MAX_COORDINATE, MAX_COORDINATE, "The middle of the cylinder.").of(3),
    number("obstacles.*.cylinder.rotation_deg", "°", -360.0, 360.0, "Turns about x, then y, then z (fixed axes); none is upright.").of(3),
    number("obstacles.*.cylinder.radius", "m", 1e-3, MAX_COORDINATE, "The radius of the cylinder.").log(),
    number("obstacles.*.cylinder.half_height", "m", 1e-3, MAX_COORDINATE, "Half the length of the cylinder.").log(),
    text(MESH_PATH, "The model file of the obstacle, relative to the scene file; builtin:NAME for one the program carries."),
    number("obstacles.*.mesh.center", "m", -MAX_COORDINATE, MAX_COORDINATE, "The middle of the box of the model.").of(3),
    number("obstacles.*.mesh.rotation_deg", "°", -360.0, 360.0, "Turns about x, then y, then z (fixed axes).").of(3),
    number("obstacles.*.mesh.length", "m", 0.0, 1e3, "Longest extent after scaling, at least 0.0001 m; 0 keeps the file's own size."),
    words("obstacles.*.mesh.up", &["auto", "y", "z", "x", "minus_y", "minus_z", "minus_x"], "The axis of the model's file that points up; auto is z where the model stands only that way, y otherwise."),
    number("obstacles.*.motion.turn.axis", "", -100.0, 100.0, "The axis in the scene about which the obstacle turns, through its middle; any length but zero.").of(3),
    number("obstacles.*.motion.turn.turns_per_sec", "1/s", -20.0, 20.0, "Turns a second; less than nothing the other way."),
    number("obstacles.*.motion.oscillate.axis", "", -100.0, 100.0, "The axis in the scene along which the obstacle swings; any length but zero.").of(3),
    number("obstacles.*.motion.oscillate.amplitude", "m", 0.0, 100.0, "The farthest that the obstacle gets from its middle."),
    number("obstacles.*.motion.oscillate.period_secs", "s", 0.1, 1e3, "The time that the obstacle takes to swing to one side, to the other and back.").log(),
    Param {
        kind: Kind::NumberOr { word: "auto", min: 0.0, max: 1e9 },
        ..number("obstacles.*.stiffness", "N/m", 0.0, 1e9, "How hard the obstacle pushes a particle back; auto chooses so that resting bodies sink little.").log()
    },
    number("obstacles.*.friction_static", "", 0.0, 10.0, "Coulomb coefficient below which a touching particle stays."),
    number("obstacles.*.friction_dynamic", "", 0.0, 10.0, "Coulomb coefficient of a sliding particle."),
    flag("obstacles.*.hidden", "Hidden obstacles are not drawn but still stop bodies."),
    number("view.camera.target", "m", -MAX_COORDINATE, MAX_COORDINATE, "The point looked at.").of(3),
    number("view.camera.yaw_deg", "°", -360.0, 360.0, "Turn about the vertical; 0 looks along −z."),
    number("view.camera.pitch_deg", "°", -90.0, 90.0, "Angle above the horizon."),
    number("view.camera.distance", "m", 1e-3, 1e5, "From the eye to the point looked at.").log(),
    number("view.camera.fov_deg", "°", 5.0, 120.0, "Vertical field of view."),
    number("view.light.direction", "", -100.0, 100.0, "From the scene towards the light; any length but zero.").of(3),
    number("view.light.strength", "", 0.0, 10.0, "Multiplies the light's colour."),
    number("view.light.color", "", 0.0, 1.0, "Linear red, green and blue of the light.").of(3),
    words("view.color", &["plain", "load", "force", "net", "strain", "speed", "contact", "model", "stiffness"], "The scalar that colours the jelly, or the colours of the models' own files."),
    number("view.color_range", "", -1e12, 1e12, "Fixed ends of the colour range in the scalar's unit; automatic when absent.").of(2),
    flag("view.overlays.wireframe", "Draws the edges of the skin's triangles."),
    flag("view.overlays.structural", "Draws the links to the nearest particles."),
    flag("view.overlays.shear", "Draws the diagonal links."),
    flag("view.overlays.bending", "Draws the links to the second neighbours."),
    flag("view.overlays.particles", "Draws the particles."),
    flag("view.overlays.pins", "Marks the particles that are held."),
    flag("view.overlays.contacts", "Marks where bodies touch obstacles and each other, with the forces as arrows: what carries a particle of a body at rest is a fifth of the body long."),
    flag("view.overlays.boxes", "Draws the boxes of the broad phase; those of pairs that meet are stronger."),
    flag("view.overlays.cells", "Draws the cells and marks those turned inside out."),
];

impl Param {
    const fn of(self, len: usize) -> Self {
        Self { len, ..self }
    }

    const fn log(self) -> Self {
        Self { logarithmic: true, ..self }
    }
}

const fn number(path: &'static str, unit: &'static str, min: f64, max: f64, help: &'static str) -> Param {
    Param { path, kind: Kind::Number { min, max }, len: 1, unit, logarithmic: false, help }
}

const fn integer(path: &'static str, min: i64, max: i64, help: &'static str) -> Param {
    Param { path, kind: Kind::Integer { min, max }, len: 1, unit: "", logarithmic: false, help }
}

const fn words(path: &'static str, words: &'static [&'static str], help: &'static str) -> Param {
    Param { path, kind: Kind::Word(words), len: 1, unit: "", logarithmic: false, help }
}

const fn text(path: &'static str, help: &'static str) -> Param {
    Param { path, kind: Kind::Text, len: 1, unit: "", logarithmic: false, help }
}

const fn flag(path: &'static str, help: &'static str) -> Param {
    Param { path, kind: Kind::Flag, len: 1, unit: "", logarithmic: false, help }
}

const fn list(path: &'static str, help: &'static str) -> Param {
    Param { path, kind: Kind::List, len: 1, unit: "", logarithmic: false, help }
}
