//! Which way is up in a model. A model file does not say: most programs that draw have y up, most that construct have z
//! up, and a model taken the wrong way lies on its side. Here y is up; a model with another axis up is turned.
//!
//! A guess asks on which side the model would stand: its centre must lie well within the hull of what would touch the
//! ground. Only z is ever guessed, and only where the model would stand on that side and topple on y's.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use super::TriMesh;

/// The axis of a model's own coordinates that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UpAxis {
    /// z where the model stands only that way, y otherwise.
    Auto,
    /// +y: the model is not turned.
    #[default]
    Y,
    /// +z.
    Z,
    /// +x.
    X,
    /// −y: upside down.
    MinusY,
    /// −z.
    MinusZ,
    /// −x.
    MinusX,
}

/// A model stands on a side if its centre lies at least this far within the hull of what touches the ground, as a share of
/// the footprint's size. Models made to stand reach 0.1 to 0.5.
const MIN_STANDING_DEPTH: f64 = 0.05;
/// A model topples from a side if its centre lies less than this within the hull. Between the two limits nothing is decided.
const MAX_TOPPLING_DEPTH: f64 = 0.02;
/// Points within this share of the height above the lowest point touch the ground.
const GROUND_TOLERANCE: f64 = 0.01;
/// A relief with a flat back stands on it, but is not meant to: at least this share of the longest extent must be
/// height.
const MIN_HEIGHT_SHARE: f64 = 0.25;

impl UpAxis {
    /// All of them, the choice by the program first.
    pub const ALL: [Self; 7] = [Self::Auto, Self::Y, Self::Z, Self::X, Self::MinusY, Self::MinusZ, Self::MinusX];

    /// The word for it in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Y => "y",
            Self::Z => "z",
            Self::X => "x",
            Self::MinusY => "minus_y",
            Self::MinusZ => "minus_z",
            Self::MinusX => "minus_x",
        }
    }

    /// Returns this axis, or for `Auto` the one guessed for a mesh.
    pub fn found(self, mesh: &TriMesh) -> Self {
        match self {
            Self::Auto if is_z_up(mesh) => Self::Z,
            Self::Auto => Self::Y,
            known => known,
        }
    }

    /// Returns a point of the model after this axis is turned up: by quarter turns, so that nothing is rounded.
    fn turned(self, DVec3 { x, y, z }: DVec3) -> DVec3 {
        match self {
            Self::Auto | Self::Y => DVec3::new(x, y, z),
            Self::Z => DVec3::new(x, z, -y),
            Self::X => DVec3::new(-y, x, z),
            Self::MinusY => DVec3::new(x, -y, -z),
            Self::MinusZ => DVec3::new(x, -z, y),
            Self::MinusX => DVec3::new(y, -x, z),
        }
    }

    /// The point of the model that [`UpAxis::turn`] moves to `place`.
    pub fn turned_back(self, place: DVec3) -> DVec3 {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| self.turned(axis).dot(place));
        DVec3::new(x, y, z)
    }

    /// Turns a mesh so that this axis points up.
    pub fn turn(self, mesh: &mut TriMesh) {
        for position in &mut mesh.positions {
            *position = self.turned(*position);
        }
    }
}

fn is_z_up(mesh: &TriMesh) -> bool {
    let size = mesh.bounds().size();
    let tall = size.z >= MIN_HEIGHT_SHARE * size.max_element();
    tall && steadiness(mesh, UpAxis::Z) >= MIN_STANDING_DEPTH
        && [UpAxis::Y, UpAxis::MinusY].iter().all(|&up| steadiness(mesh, up) < MAX_TOPPLING_DEPTH)
}

/// Returns how far the centre of the surface lies within the hull of what touches the ground, as a share of the footprint's
/// size; negative outside, −1 if there is no hull.
fn steadiness(mesh: &TriMesh, up: UpAxis) -> f64 {
    let used = || mesh.triangles.iter().flatten().map(|&vertex| up.turned(mesh.positions[vertex as usize]));
    let (low, high) = used().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let size = high - low;
    let footprint = libm::sqrt(size.x * size.z);
    let ground = low.y + GROUND_TOLERANCE * size.y;
    let hull = hull(used().filter(|p| p.y <= ground).map(|p| DVec2::new(p.x, p.z)).collect());
    let Some(center) = surface_center(mesh).map(|center| up.turned(center)) else { return -1.0 };
    if hull.len() < 3 || !(footprint > 0.0 && footprint.is_finite()) {
        return -1.0;
    }
    let center = DVec2::new(center.x, center.z);
    let edges = hull.iter().zip(hull.iter().cycle().skip(1));
    let depth = |(a, b): (&DVec2, &DVec2)| (b - a).perp_dot(center - a) / (b - a).length();
    edges.map(depth).fold(f64::INFINITY, f64::min) / footprint
}

/// The centre of a mesh's area; none without area.
fn surface_center(mesh: &TriMesh) -> Option<DVec3> {
    let (mut moment, mut area) = (DVec3::ZERO, 0.0);
    for triangle in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(triangle);
        let weight = (b - a).cross(c - a).length();
        moment += weight * (a + b + c);
        area += weight;
    }
    let center = moment / (3.0 * area);
    center.is_finite().then_some(center)
}

/// The corners of the convex hull, counter-clockwise (Andrew's monotone chain).
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let chain = |points: &mut dyn Iterator<Item = &DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for &point in points {
            while let [.., before, last] = chain[..]
                && (last - before).perp_dot(point - last) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter());
    hull.extend(chain(&mut points.iter().rev()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::import::{self, parse_obj};

    /// A stool: a seat on four legs that spread, its height along y.
    fn stool() -> TriMesh {
        let mut mesh = TriMesh::default();
        let mut pyramid = |base: [[f64; 3]; 4], tip: [f64; 3]| {
            let first = u32::try_from(mesh.positions.len()).expect("few");
            mesh.positions.extend(base.into_iter().chain([tip]).map(DVec3::from_array));
            let faces = [[0, 1, 2], [0, 2, 3], [0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]];
            mesh.triangles.extend(faces.map(|face| face.map(|corner| first + corner)));
        };
        pyramid([[-1.0, 2.0, -1.0], [1.0, 2.0, -1.0], [1.0, 2.0, 1.0], [-1.0, 2.0, 1.0]], [0.1, 2.5, 0.2]);
        for (x, z) in [(-1.0, -1.3), (1.0, -1.3), (1.1, 1.3), (-1.1, 1.3)] {
            let leg =
                [[0.8 * x, 2.0, 0.7 * z], [0.7 * x, 2.0, 0.7 * z], [0.7 * x, 2.0, 0.6 * z], [0.8 * x, 2.0, 0.6 * z]];
            pyramid(leg, [x, 0.0, z]);
        }
        mesh
    }

    /// The model as a program with this axis up would have written it.
    fn written_with(up: UpAxis, mesh: &TriMesh) -> TriMesh {
        TriMesh { positions: mesh.positions.iter().map(|&p| up.turned_back(p)).collect(), ..mesh.clone() }
    }

    #[test]
    fn turning_points_the_axis_up_and_mirrors_nothing() {
        let ways = [DVec3::Y, DVec3::Z, DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z, DVec3::NEG_X];
        for (up, axis) in UpAxis::ALL.into_iter().skip(1).zip(ways) {
            assert_eq!(up.turned(axis), DVec3::Y, "{up:?}");
            let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| up.turned(axis));
            assert_eq!(x.cross(y), z, "{up:?}: right stays right");
            let (mut turned, upright) = (written_with(up, &stool()), stool());
            up.turn(&mut turned);
            assert_eq!(turned, upright, "{up:?}: to the bit");
        }
    }

    #[test]
    fn what_stands_only_with_z_up_is_guessed_so() {
        assert_eq!(UpAxis::Auto.found(&stool()), UpAxis::Y, "it stands as it is");
        assert_eq!(UpAxis::Auto.found(&written_with(UpAxis::Z, &stool())), UpAxis::Z, "it would topple");
        assert_eq!(UpAxis::X.found(&written_with(UpAxis::Z, &stool())), UpAxis::X, "what was asked for is not guessed");
    }

    #[test]
    fn models_that_stand_are_left_alone_and_found_again_when_they_lie() {
        for (name, stands) in [("spot.obj", true), ("tree.obj", true), ("coupler.obj", false)] {
            let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name);
            let mesh = import::load(&path, import::Detail::Form).expect("a sound model").mesh;
            assert_eq!(UpAxis::Auto.found(&mesh), UpAxis::Y, "{name} has y up");
            let lying = UpAxis::Auto.found(&written_with(UpAxis::Z, &mesh));
            // The coupler is round: it would stay on its side as well, so that nothing is sure.
            assert_eq!(lying == UpAxis::Z, stands, "{name} written with z up: {lying:?}");
        }
    }

    #[test]
    fn without_strong_evidence_y_is_up() {
        let mesh = |text: &str| parse_obj(text.as_bytes(), "m.obj").expect("a model").mesh;
        let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
        let pyramid_on_its_back =
            "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 2 2 3\nf 1 2 3 4\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
        let relief = pyramid_on_its_back.replace("2 2 3", "2 2 0.5");
        let flat = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
        assert_eq!(UpAxis::Auto.found(&mesh(cube)), UpAxis::Y, "a box stands on every side");
        assert_eq!(UpAxis::Auto.found(&mesh(pyramid_on_its_back)), UpAxis::Z, "on an edge it would topple");
        assert_eq!(UpAxis::Auto.found(&mesh(&relief)), UpAxis::Y, "a relief hangs on a wall");
        assert_eq!(UpAxis::Auto.found(&mesh(flat)), UpAxis::Y, "a sheet");
        assert_eq!(UpAxis::Auto.found(&TriMesh::default()), UpAxis::Y, "nothing at all");
    }
}
