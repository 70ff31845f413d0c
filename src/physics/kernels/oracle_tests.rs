//! Compares every kernel with the readable loop over the list of links: on bodies of all shapes and materials, with and
//! without damping and bending, at every level and in both precisions.

use std::sync::Arc;

use glam::DVec3;

use super::{BoxedLinks, InitialForce, Layout, Pass, SimdLevel, Tangents, add_forces, are_strained, pieces};
use crate::geometry::Lattice;
use crate::geometry::voxel::Cells;
use crate::math::rng::Rng;
use crate::math::{Real, Vector};
use crate::physics::forces::links::link_force;
use crate::physics::model::link::{Link, LinkConstants, LinkFamily};

/// A body at rest, by name.
pub(super) struct Shape {
    name: String,
    pub(super) lattice: Lattice,
}

pub(super) fn shape(name: &str, dims: [i32; 3], mut keep: impl FnMut([i32; 3]) -> bool) -> Shape {
    let all = (0..dims[2]).flat_map(|z| (0..dims[1]).flat_map(move |y| (0..dims[0]).map(move |x| [x, y, z])));
    let cells: Vec<[i32; 3]> = all.filter(|cell| keep(*cell)).collect();
    let lattice = Lattice::new(&Cells::from_list(&cells, 0.1).expect("some cells"));
    Shape { name: format!("{name} {dims:?}"), lattice }
}

fn shapes() -> Vec<Shape> {
    let full = |_: [i32; 3]| true;
    let mut shapes: Vec<_> = [[1, 1, 1], [2, 1, 1], [1, 1, 2], [3, 5, 7], [8, 8, 8], [11, 9, 13]]
        .map(|dims| shape("block", dims, full))
        .into();
    shapes.extend([[70, 1, 1], [1, 70, 1], [1, 1, 70]].map(|dims| shape("rod", dims, full)));
    shapes.extend([[30, 30, 1], [30, 1, 30], [1, 30, 30]].map(|dims| shape("sheet", dims, full)));
    let mut rng = Rng::new(11);
    shapes.extend([0.5, 0.8].map(|share| shape("subset", [9, 8, 7], |_| rng.between(0.0, 1.0) < share)));
    // More corners than a window has, even after a cut into halves.
    shapes.push(shape("block", [9, 9, 300], full));
    shapes.push(shape("subset", [9, 300, 9], |_| rng.between(0.0, 1.0) < 0.8));
    // Rows with one place more than they need.
    shapes.push(shape("block", [31, 15, 3], full));
    shapes.push(shape("shell", [12, 12, 12], |cell| cell.iter().any(|c| [0, 11].contains(c))));
    shapes
}

/// How the links of a family are made.
#[derive(Clone, Copy, Debug)]
pub(super) enum Material {
    /// All alike, as springs are.
    Alike,
    /// Each link has one of two values, in no order, as in bodies of two materials.
    Mixed,
}

pub(super) fn families<R: Real>(lattice: &Lattice, material: Material, damping: [f64; 3]) -> [LinkFamily<R>; 3] {
    let mut rng = Rng::new(3);
    [0, 1, 2].map(|number| {
        let measure = |ends: &[u32; 2]| {
            let [from, to] = ends.map(|end| DVec3::from(lattice.corners[end as usize].map(f64::from)));
            let rest_length = from.distance(to) * lattice.grid.cell_size;
            let [rest_length, inverse_rest_length] = [rest_length, 1.0 / rest_length].map(R::from_f64);
            Link { ends: *ends, rest_length, inverse_rest_length }
        };
        let links: Arc<[Link<R>]> = lattice.links[number].iter().map(measure).collect();
        let [stiffness, damping] = [[30.0, 25.0, 12.0][number], damping[number]].map(R::from_f64);
        let constants = match material {
            Material::Alike => LinkConstants::Uniform([stiffness, damping]),
            Material::Mixed => LinkConstants::Classes {
                of_link: links.iter().map(|_| u16::from(rng.between(0.0, 1.0) < 0.3)).collect(),
                constants: vec![[stiffness, damping], [stiffness, damping].map(|c| c * R::from_f64(0.3))],
            },
        };
        LinkFamily { stiffness, damping, links, constants }
    })
}

/// Positions and velocities of a crumpled body in motion, with two particles in one place.
pub(super) fn motion<R: Real>(lattice: &Lattice) -> [Vec<R::Vec3>; 2] {
    let mut rng = Rng::new(7);
    let mut noise = |size: f64| DVec3::from([0; 3].map(|_| rng.between(-size, size)));
    let place = |particle: usize| lattice.rest_position(particle);
    let mut position: Vec<_> = (0..lattice.corners.len()).map(|p| place(p) + noise(0.03)).collect();
    position[1] = position[0];
    let velocity = position.iter().map(|_| R::Vec3::from_dvec3(noise(1.0))).collect();
    [position.into_iter().map(R::Vec3::from_dvec3).collect(), velocity]
}

/// Returns the sum of forces on every particle, and the sum of their magnitudes, which rounding errors are measured against.
fn listed<R: Real>(
    families: &[LinkFamily<R>; 3],
    [position, velocity]: &[Vec<R::Vec3>; 2],
    chosen: [bool; 3],
) -> (Vec<R::Vec3>, Vec<f64>) {
    let (mut force, mut scale) = (vec![R::Vec3::ZERO; position.len()], vec![0.0; position.len()]);
    for (family, _) in families.iter().zip(chosen).filter(|(_, chosen)| *chosen) {
        for (number, link) in family.links.iter().enumerate() {
            let [i, j] = link.ends.map(|end| end as usize);
            let (d, dv) = (position[j] - position[i], velocity[j] - velocity[i]);
            let [stiffness, damping] = family.constants(number);
            let on_i = link_force(d, dv, link.inverse_rest_length, stiffness, damping);
            force[i] += on_i;
            force[j] -= on_i;
            let stretch = (d.length() * link.inverse_rest_length).to_f64();
            let rate = (dv.length() * link.inverse_rest_length).to_f64();
            for end in [i, j] {
                scale[end] += stiffness.to_f64() * (1.0 + stretch) + damping.to_f64() * rate;
            }
        }
    }
    (force, scale)
}

/// Puts the links into their box, whether it pays or not.
pub(super) fn in_box<R: Real>(lattice: &Lattice, families: &[LinkFamily<R>; 3]) -> BoxedLinks<R> {
    let layout = Layout::bounding(lattice).expect("a body is not empty").filled(lattice);
    BoxedLinks::new(Arc::new(layout), lattice, families)
}

/// Returns the same forces from the kernel.
fn boxed<R: Real>(
    links: &BoxedLinks<R>,
    motion: &[Vec<R::Vec3>; 2],
    chosen: [[bool; 3]; 2],
    level: SimdLevel,
) -> (Vec<R::Vec3>, u64) {
    in_pieces(links, motion, chosen, level, &[])
}

/// Fills the room for positions and velocities: places without a particle may hold anything.
fn fill_with_junk<R: Real>(rooms: [[&mut [R]; 3]; 2]) {
    let places = rooms.into_iter().flatten().flatten();
    places.enumerate().for_each(|(place, room)| *room = R::from_f64(if place % 3 == 0 { 1e3 } else { 0.0 }));
}

/// Returns the same forces of a body that is cut after these shares of its work. The workspace starts with junk in it, and NaN
/// in the sums.
fn in_pieces<R: Real>(
    links: &BoxedLinks<R>,
    [position, velocity]: &[Vec<R::Vec3>; 2],
    [chosen, damped]: [[bool; 3]; 2],
    level: SimdLevel,
    cuts: &[f64],
) -> (Vec<R::Vec3>, u64) {
    let mut force = vec![R::Vec3::ZERO; position.len()];
    let pass = Pass { level, families: chosen, damped };
    let (mut count, mut from) = (0, 0);
    for mut piece in pieces(links, cuts) {
        assert_eq!(piece.particles.start, from, "pieces follow one another");
        from = piece.particles.end;
        let [position_room, velocity_room, force_room] = piece.room.split();
        fill_with_junk([position_room, velocity_room]);
        for list in force_room {
            list.fill(R::from_f64(f64::NAN));
        }
        let own = &mut force[piece.particles.clone()];
        count += add_forces(
            links,
            pass,
            [position, velocity],
            InitialForce::Each,
            own,
            &mut piece,
            &|| false,
            &mut |_, _| (),
        );
    }
    assert_eq!(from, position.len(), "and come to the end");
    (force, count)
}

/// Returns the largest difference between two sets of forces, in rounding errors of the sums of magnitudes.
fn largest_difference<R: Real>(a: &[R::Vec3], b: &[R::Vec3], scale: &[f64]) -> f64 {
    let differences = a.iter().zip(b).zip(scale).map(|((a, b), scale)| {
        let difference = (a.to_dvec3() - b.to_dvec3()).length();
        if difference == 0.0 { 0.0 } else { difference / (scale * R::EPSILON.to_f64()) }
    });
    differences.fold(0.0, f64::max)
}

fn levels() -> impl Iterator<Item = SimdLevel> {
    SimdLevel::ALL.into_iter().filter(|level| level.is_available())
}

/// Where bodies are cut: into halves, thirds and eighths, and unevenly.
const CUTS: [&[f64]; 4] =
    [&[0.5], &[1.0 / 3.0, 2.0 / 3.0], &[0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875], &[0.01, 0.02, 0.9, 0.95]];

/// The most rounding errors of the sum of magnitudes by which a force may differ from the sum along the list: those of 32
/// links, and of their other order, mostly cancel.
const ROUNDINGS: f64 = 1.0;

fn compare<R: Real>() -> usize {
    let mut compared = 0;
    let mut farthest = 0.0_f64;
    for Shape { name, lattice } in &shapes() {
        let motion = motion::<R>(lattice);
        for material in [Material::Alike, Material::Mixed] {
            for damping in [[0.1, 0.12, 0.3], [0.0, 0.12, 0.0], [0.0; 3]] {
                let families = families::<R>(lattice, material, damping);
                let links = in_box(lattice, &families);
                for chosen in [[true; 3], [true, true, false], [false, true, false]] {
                    let (expected, scale) = listed(&families, &motion, chosen);
                    let damped = [0, 1, 2].map(|family| damping[family] > 0.0);
                    let [first, all_damped] =
                        [damped, [true; 3]].map(|damped| boxed(&links, &motion, [chosen, damped], SimdLevel::Portable));
                    let off = largest_difference::<R>(&first.0, &expected, &scale);
                    farthest = farthest.max(off);
                    assert!(off <= ROUNDINGS, "{name} {material:?} {damping:?} {chosen:?}: {off} roundings off");
                    assert_eq!(first, all_damped, "{name}: damping of nothing changes no bit");
                    let count: usize = (0..3).filter(|f| chosen[*f]).map(|f| families[f].links.len()).sum();
                    assert_eq!(first.1, count as u64, "{name}: every link is counted");
                    for level in levels() {
                        let at_level = boxed(&links, &motion, [chosen, damped], level);
                        assert!(at_level == first, "{name} {material:?} {damping:?}: other bits at {}", level.name());
                        for cuts in CUTS {
                            let cut = in_pieces(&links, &motion, [chosen, damped], level, cuts);
                            assert!(
                                cut == first,
                                "{name} {material:?} {damping:?}: other bits in {cuts:?} at {level:?}"
                            );
                        }
                        compared += 1;
                    }
                }
            }
        }
    }
    eprintln!("largest difference from the list: {farthest:.3} roundings");
    compared
}

#[test]
fn every_kernel_gives_what_the_list_of_links_gives() {
    let levels: Vec<_> = levels().map(SimdLevel::name).collect();
    let compared = [compare::<f32>(), compare::<f64>()];
    assert_eq!(compared, [shapes().len() * 18 * levels.len(); 2], "compared at {levels:?}");
}

#[test]
fn a_wrong_constant_of_one_family_is_seen() {
    let Shape { lattice, .. } = shape("block", [8, 8, 8], |_| true);
    let motion = motion::<f32>(&lattice);
    let right = families::<f32>(&lattice, Material::Alike, [0.1; 3]);
    let mut wrong = right.clone();
    wrong[2].stiffness *= 1.0 + 1e-3;
    wrong[2].constants = LinkConstants::Uniform([wrong[2].stiffness, wrong[2].damping]);
    let links = in_box(&lattice, &wrong);
    let (expected, scale) = listed(&right, &motion, [true; 3]);
    let (force, _) = boxed(&links, &motion, [[true; 3]; 2], SimdLevel::best());
    let off = largest_difference::<f32>(&force, &expected, &scale);
    assert!(off > ROUNDINGS, "a constant that is off by 1e-3: {off} roundings");
}

#[test]
fn a_piece_without_what_reaches_it_from_before_is_seen() {
    let Shape { lattice, .. } = shape("block", [8, 8, 8], |_| true);
    let motion = motion::<f32>(&lattice);
    let links = in_box(&lattice, &families::<f32>(&lattice, Material::Alike, [0.1; 3]));
    let whole = boxed(&links, &motion, [[true; 3]; 2], SimdLevel::best()).0;
    let mut half = pieces(&links, &[0.5]).remove(1);
    let pass = Pass { level: SimdLevel::best(), families: [true; 3], damped: [true; 3] };
    let of = |half: &mut super::Piece<f32>| {
        let mut force = vec![glam::Vec3::ZERO; half.particles.len()];
        add_forces(
            &links,
            pass,
            [&motion[0], &motion[1]],
            InitialForce::Each,
            &mut force,
            half,
            &|| false,
            &mut |_, _| (),
        );
        force
    };
    assert_eq!(of(&mut half), whole[half.particles.clone()], "the half of the whole");
    half.panels[0].blocks.start += 1;
    assert_ne!(of(&mut half), whole[half.particles.clone()], "the first block is needed");
}

#[test]
fn links_without_length_have_no_force() {
    let Shape { lattice, .. } = shape("block", [3, 3, 3], |_| true);
    let families = families::<f32>(&lattice, Material::Alike, [0.1; 3]);
    let links = in_box(&lattice, &families);
    let [_, velocity] = motion::<f32>(&lattice);
    let point = vec![glam::Vec3::new(0.3, 0.2, 0.1); lattice.corners.len()];
    for level in levels() {
        let (force, _) = boxed(&links, &[point.clone(), velocity.clone()], [[true; 3]; 2], level);
        assert!(force.iter().all(|force| *force == glam::Vec3::ZERO), "all particles in one place");
    }
}

/// Returns the largest strain of any link, now or after `secs`, along the list.
fn listed_strain<R: Real>(families: &[LinkFamily<R>; 3], [position, velocity]: &[Vec<R::Vec3>; 2], secs: f64) -> f64 {
    let strain = |link: &Link<R>, secs: f64| {
        let [i, j] = link.ends.map(|end| end as usize);
        let (d, dv) = (position[j] - position[i], velocity[j] - velocity[i]);
        let length = (d.to_dvec3() + dv.to_dvec3() * secs).length();
        (length / link.rest_length.to_f64() - 1.0).abs()
    };
    let links = families.iter().flat_map(|family| family.links.iter());
    links.map(|link| strain(link, 0.0).max(strain(link, secs))).fold(0.0, f64::max)
}

/// Whether the kernel finds links strained by more than `strain`, in a body cut after these shares of its work.
fn finds_strain<R: Real>(
    links: &BoxedLinks<R>,
    [position, velocity]: &[Vec<R::Vec3>; 2],
    (strain, secs): (f64, f64),
    level: SimdLevel,
    cuts: &[f64],
) -> bool {
    pieces(links, cuts).iter_mut().any(|piece| {
        let [position_room, velocity_room, _] = piece.room.split();
        fill_with_junk([position_room, velocity_room]);
        are_strained(links, level, strain, R::from_f64(secs), [position, velocity], piece)
    })
}

fn compare_strain<R: Real>() {
    const SECS: f64 = 0.01;
    let mut rng = Rng::new(5);
    for Shape { name, lattice } in &shapes() {
        let families = families::<R>(lattice, Material::Alike, [0.0; 3]);
        let links = in_box(lattice, &families);
        let count = lattice.corners.len();
        let place = |particle: usize| R::Vec3::from_dvec3(lattice.rest_position(particle));
        for moved in 0..6 {
            // One particle is out of place, or about to be.
            let mut motion = [(0..count).map(place).collect::<Vec<_>>(), vec![R::Vec3::ZERO; count]];
            let drawn = usize::try_from(rng.next_u64() % count as u64).expect("a particle");
            let particle = if moved == 0 { count - 1 } else { drawn };
            let way = DVec3::from([0; 3].map(|_| rng.between(-0.05, 0.05)));
            let is_about_to = moved % 2 == 1;
            let way = if is_about_to { way * (1.0 / SECS) } else { way };
            motion[usize::from(is_about_to)][particle] += R::Vec3::from_dvec3(way);
            let strain = listed_strain(&families, &motion, SECS);
            for level in levels() {
                for cuts in CUTS.into_iter().chain([&[][..]]) {
                    let finds = |share: f64| finds_strain(&links, &motion, (share * strain, SECS), level, cuts);
                    let found = [0.999, 1.001].map(finds);
                    assert_eq!(found, [true, false], "{name}: {strain} at {particle}, {level:?}, {cuts:?}");
                }
            }
        }
    }
}

#[test]
fn strained_links_are_found_as_along_the_list() {
    compare_strain::<f32>();
    compare_strain::<f64>();
}

/// The time step that matrices of links are made for, s.
const DT: f64 = 0.05;

/// Returns, link by link, a third of the trace of every particle's diagonal block, the product of `dt² K⁺ + dt C` with a
/// vector, and the sum of magnitudes of each product.
fn listed_product<R: Real>(
    families: &[LinkFamily<R>; 3],
    [position, velocity]: &[Vec<R::Vec3>; 2],
    chosen: [bool; 3],
    of: &[DVec3],
) -> (Vec<f64>, Vec<DVec3>, Vec<f64>) {
    let count = position.len();
    let (mut diagonal, mut product, mut scale) = (vec![0.0; count], vec![DVec3::ZERO; count], vec![0.0; count]);
    for (family, _) in families.iter().zip(chosen).filter(|(_, chosen)| *chosen) {
        for (number, link) in family.links.iter().enumerate() {
            let [i, j] = link.ends.map(|end| end as usize);
            let d = (position[j] - position[i]).to_dvec3();
            if d == DVec3::ZERO {
                continue;
            }
            let [stiffness, damping] = family.constants(number).map(Real::to_f64);
            let (length, rest) = (d.length(), link.rest_length.to_f64());
            let turned = ((velocity[j] - velocity[i]).to_dvec3() * DT).reject_from(d);
            let unturned = (length * length - turned.length_squared()).max(0.0).sqrt();
            let across = DT * DT * stiffness / rest * (1.0 - rest / unturned).max(0.0);
            let along = DT * DT * stiffness / rest - across + DT * damping / rest;
            let difference = of[i] - of[j];
            let part = difference * across + d * (along * d.dot(difference) / (length * length));
            product[i] += part;
            product[j] -= part;
            for end in [i, j] {
                diagonal[end] += across + along / 3.0;
                scale[end] += (across + along) * difference.length();
            }
        }
    }
    (diagonal, product, scale)
}

/// Returns the same diagonal and product from the kernel.
fn boxed_product<R: Real>(
    links: &BoxedLinks<R>,
    [position, velocity]: &[Vec<R::Vec3>; 2],
    choice: (SimdLevel, [bool; 3]),
    cuts: &[f64],
    of: &[DVec3],
) -> (Vec<f64>, Vec<DVec3>) {
    let mut tangents = Tangents::new(Some(links));
    let (mut diagonal, mut product) = (vec![0.0; of.len()], vec![DVec3::ZERO; of.len()]);
    tangents.assemble(links, choice, DT, [position, velocity], |particle, third| diagonal[particle] += third);
    let links = links.in_double();
    let mut rest = &mut product[..];
    for mut piece in pieces(&links, cuts) {
        let own = rest.split_off_mut(..piece.particles.len()).expect("pieces are of all particles");
        tangents.multiply(&links, choice.0, of, &mut piece, own, &mut |_, _| ());
    }
    (diagonal, product)
}

/// The most rounding errors of the sum of magnitudes by which a product may differ from that along the list. A link's
/// resistance across its direction is a difference, and loses as many digits as it is smaller than the stiffness.
const ROUNDINGS_OF_A_PRODUCT: f64 = 3.0;

fn compare_products<R: Real>() -> f64 {
    let mut rng = Rng::new(12);
    let mut farthest = 0.0_f64;
    for Shape { name, lattice } in &shapes() {
        let motion = motion::<R>(lattice);
        let of: Vec<_> = motion[0].iter().map(|_| DVec3::from([0; 3].map(|_| rng.between(-1.0, 1.0)))).collect();
        for material in [Material::Alike, Material::Mixed] {
            let families = families::<R>(lattice, material, [0.1, 0.0, 0.3]);
            let links = in_box(lattice, &families);
            for chosen in [[true; 3], [true, true, false], [false, true, false]] {
                let (diagonal, expected, scale) = listed_product(&families, &motion, chosen, &of);
                let first = boxed_product(&links, &motion, (SimdLevel::Portable, chosen), &[], &of);
                let off = largest_difference::<f64>(&first.1, &expected, &scale) * f64::EPSILON / R::EPSILON.to_f64();
                farthest = farthest.max(off);
                for (found, expected) in first.0.iter().zip(&diagonal) {
                    assert!((found - expected).abs() <= 10.0 * R::EPSILON.to_f64() * expected, "{name} {material:?}");
                }
                for level in levels() {
                    for cuts in CUTS {
                        let cut = boxed_product(&links, &motion, (level, chosen), cuts, &of);
                        assert!(cut == first, "{name} {material:?} {chosen:?}: other bits in {cuts:?} at {level:?}");
                    }
                }
            }
        }
    }
    farthest
}

#[test]
fn the_matrix_of_links_in_their_box_is_that_along_their_list() {
    for farthest in [compare_products::<f32>(), compare_products::<f64>()] {
        assert!(farthest <= ROUNDINGS_OF_A_PRODUCT, "{farthest} roundings off");
    }
}

#[test]
fn a_matrix_of_the_wrong_links_is_seen() {
    let Shape { lattice, .. } = shape("block", [8, 8, 8], |_| true);
    let motion = motion::<f32>(&lattice);
    let of: Vec<_> = motion[1].iter().map(|v| v.to_dvec3()).collect();
    let families = families::<f32>(&lattice, Material::Mixed, [0.1; 3]);
    let links = in_box(&lattice, &families);
    let (_, expected, scale) = listed_product(&families, &motion, [true; 3], &of);
    let (_, product) = boxed_product(&links, &motion, (SimdLevel::best(), [true, true, false]), &[], &of);
    let off = largest_difference::<f64>(&product, &expected, &scale) * f64::EPSILON / f64::from(f32::EPSILON);
    assert!(off > 1000.0 * ROUNDINGS_OF_A_PRODUCT, "without bending: {off} roundings");
}
