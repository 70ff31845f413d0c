//! Nothing is uploaded twice: only particles change in a frame.

use std::sync::Arc;

use gelatin::math::picture::{Picture, Sampling, Texture};
use gelatin::render::{FrameCounters, FrameTarget, offscreen};
use gelatin::view::overlay::{CellFrames, LineEnds, Lines, PointPlaces, Points, Segment};
use gelatin::view::style::Tint;
use gelatin::view::{DrawList, Overlay, Selected, Skin, SkinInstance, SkinTextures, SkinVertex, TexturedRun};
use glam::Vec3;

use crate::gpu::Studio;
use crate::scenes::cube;

struct Film {
    studio: Studio,
    view: wgpu::TextureView,
}

impl Film {
    const SIZE: [u32; 2] = [64, 64];

    fn new() -> Self {
        let studio = Studio::new();
        let texture = studio.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: Self::SIZE[0], height: Self::SIZE[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: offscreen::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        Self { studio, view: texture.create_view(&wgpu::TextureViewDescriptor::default()) }
    }

    fn frame(&mut self, draw_list: &DrawList) -> FrameCounters {
        let Studio { gpu, renderer } = &mut self.studio;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let target = FrameTarget { view: &self.view, size: Self::SIZE, viewport: None };
        let counters = renderer.render(&gpu.device, &gpu.queue, &mut encoder, &target, draw_list).unwrap();
        gpu.queue.submit([encoder.finish()]);
        gpu.check().unwrap();
        counters
    }
}

#[test]
fn the_first_frame_uploads_everything_and_a_still_one_nothing() {
    let (mut film, scene) = (Film::new(), cube());
    let first = film.frame(&scene);
    assert_eq!(first.particle_bytes, 125 * 12, "twelve bytes a particle");
    assert!(first.static_bytes > 0 && first.passes.contains(&"skin"), "the skin is new");
    let second = film.frame(&scene);
    assert_eq!((second.particle_bytes, second.scalar_bytes, second.static_bytes), (0, 0, 0), "nothing has changed");
    let passes = ["skin", "shadow", "contact shadow"];
    assert!(passes.iter().all(|pass| first.passes.contains(pass)), "the maps are new: {:?}", first.passes);
    assert!(!passes.iter().any(|pass| second.passes.contains(pass)), "a body at rest is drawn from the same maps");
    let mut turned = scene.clone();
    turned.camera.eye.x += 0.5;
    assert!(!film.frame(&turned).passes.contains(&"shadow"), "nor does the eye change shadows");
    turned.light.direction.x += 0.5;
    assert!(film.frame(&turned).passes.contains(&"shadow"), "the light does");
}

#[test]
fn a_moving_body_costs_its_particles_and_colours_their_scalars() {
    let (mut film, mut scene) = (Film::new(), cube());
    film.frame(&scene);
    scene.particles = Arc::new(scene.particles.to_vec());
    let moved = film.frame(&scene);
    assert_eq!((moved.particle_bytes, moved.scalar_bytes, moved.static_bytes), (1500, 0, 0), "only particles");
    scene.scalars = Some(Arc::new(vec![0.5; 125]));
    let colored = film.frame(&scene);
    assert_eq!((colored.particle_bytes, colored.scalar_bytes, colored.static_bytes), (0, 500, 0), "only scalars");
    scene.scalars = None;
    assert!(film.frame(&scene).passes.contains(&"skin"), "colours go away again");
}

/// A surface of a million triangles over the first eight particles.
fn fine_skin() -> Skin {
    const SIDE: u32 = 708;
    let share = |n: u32| n as f32 / (SIDE - 1) as f32;
    let vertex = |n: u32| {
        let [u, v] = [n % SIDE, n / SIDE].map(share);
        let mut position = [0.0; 8];
        (position[0], position[1], position[2], position[3]) =
            ((1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v);
        let mut tangent_u = [0.0; 8];
        (tangent_u[0], tangent_u[1]) = (-1.0, 1.0);
        let mut tangent_v = [0.0; 8];
        (tangent_v[0], tangent_v[2]) = (-1.0, 1.0);
        SkinVertex { particles: [0, 1, 5, 6, 0, 0, 0, 0], position, tangent_u, tangent_v, ..SkinVertex::default() }
    };
    let quad = |n: u32| {
        let low = n / (SIDE - 1) * SIDE + n % (SIDE - 1);
        [[low, low + 1, low + SIDE], [low + 1, low + SIDE + 1, low + SIDE]]
    };
    Skin::new((0..SIDE * SIDE).map(vertex).collect(), (0..(SIDE - 1) * (SIDE - 1)).flat_map(quad).collect())
}

#[test]
fn a_million_triangles_cost_no_more_than_their_particles() {
    let (mut film, mut scene) = (Film::new(), cube());
    let skin = fine_skin();
    assert!(skin.triangles().len() > 999_000, "{} triangles", skin.triangles().len());
    scene.skins[0].skin = Arc::new(skin);
    assert!(film.frame(&scene).static_bytes > 10_000_000, "it is uploaded once");
    for _ in 0..2 {
        scene.particles = Arc::new(scene.particles.to_vec());
        let moved = film.frame(&scene);
        assert_eq!((moved.particle_bytes, moved.scalar_bytes, moved.static_bytes), (1500, 0, 0), "only particles");
    }
}

#[test]
fn a_body_more_uploads_only_that_one() {
    let (mut film, mut scene) = (Film::new(), cube());
    let first = film.frame(&scene);
    let mut second = scene.skins[0].clone();
    second.skin = Arc::new((*second.skin).clone());
    scene.skins.push(second);
    assert_eq!(film.frame(&scene).static_bytes, first.static_bytes, "one skin as large as the first");
    scene.skins.swap(0, 1);
    assert_eq!(film.frame(&scene).static_bytes, 0, "another order uploads nothing");
    scene.skins.clear();
    assert_eq!(film.frame(&scene).triangles, 0, "bodies can go");
}

#[test]
fn without_overlays_nothing_is_uploaded_and_no_pass_runs() {
    let (mut film, mut scene) = (Film::new(), cube());
    let overlays = ["lines", "cells", "points", "outline", "fills"];
    let runs = |counters: &FrameCounters| counters.passes.iter().any(|pass| overlays.contains(pass));
    for _ in 0..2 {
        let none = film.frame(&scene);
        assert!(none.overlay_bytes == 0 && !runs(&none), "no overlay: {none:?}");
    }
    cube_overlay(&mut scene, Arc::new(vec![[0, 1], [1, 2]]));
    assert!(runs(&film.frame(&scene)), "the check sees one that is drawn");
    scene.overlay = Overlay::default();
    scene.selected = Some(Selected::Skin(0));
    assert!(film.frame(&scene).passes.contains(&"outline"), "and what is selected");
    assert_eq!(film.frame(&scene).overlay_bytes, 0, "whose edges are uploaded once");
    scene.selected = None;
    let none = film.frame(&scene);
    assert!(none.overlay_bytes == 0 && !runs(&none), "off again: {none:?}");
}

#[test]
fn what_hangs_on_particles_is_uploaded_once_however_they_move() {
    let (mut film, mut scene) = (Film::new(), cube());
    cube_overlay(&mut scene, Arc::new(vec![[0, 1], [1, 2]]));
    let ends = LineEnds::Skin(0);
    scene.overlay.lines.push(Lines { ends, tint: Tint::Own, opacity: 1.0, width: 1.0, hidden: 0.0 });
    let cells = Arc::new(vec![[0, 1, 5, 6, 25, 26, 30, 31]]);
    scene.overlay.cells.push(CellFrames { cells, first: 0, width: 1.0 });
    assert!(film.frame(&scene).overlay_bytes > 0, "the lists are new");
    for _ in 0..2 {
        scene.particles = Arc::new(scene.particles.iter().map(|[x, y, z]| [*x, y + 0.1, *z]).collect());
        assert_eq!(film.frame(&scene).overlay_bytes, 0, "only particles are uploaded");
    }
    let segment = Segment::new(Vec3::ZERO, Vec3::ONE, [1.0; 4], 1.0);
    scene.overlay.lines[0].ends = LineEnds::Placed(Arc::new(vec![segment]));
    let bytes = film.frame(&scene).overlay_bytes;
    assert!((48..=96).contains(&bytes), "one segment and its look: {bytes}");
}

/// Two links and all particles.
fn cube_overlay(scene: &mut DrawList, ends: Arc<Vec<[u32; 2]>>) {
    let ends = LineEnds::Particles { ends, first: 0 };
    scene.overlay.lines = vec![Lines { ends, tint: Tint::Own, opacity: 1.0, width: 2.0, hidden: 0.2 }];
    let places = PointPlaces::Particles { first: 0, count: 125 };
    scene.overlay.points = vec![Points { places, tint: Tint::Particle, size: 3.0, hidden: 0.0 }];
}

#[test]
fn a_picture_is_uploaded_once_for_all_that_show_it_and_not_before_it_is_shown() {
    let (mut film, mut scene) = (Film::new(), cube());
    let picture = Arc::new(Picture::new([8, 4], vec![255; 8 * 4 * 4], 8).unwrap());
    let bytes = picture.bytes();
    assert_eq!(bytes, 4 * (32 + 8 + 2 + 1), "every coarseness");
    let with = |sampling: Sampling| {
        let skin = &cube().skins[0].skin;
        let places = vec![[0.5; 2]; skin.vertices().len()];
        let texture = Texture { picture: Arc::clone(&picture), sampling };
        let runs = vec![TexturedRun { texture, triangles: 0..skin.triangles().len() }];
        let skin = Skin::new(skin.vertices().to_vec(), skin.triangles().to_vec());
        Arc::new(skin.with_textures(SkinTextures { places, runs }))
    };
    let sharp = Sampling { levels: None, ..Sampling::default() };
    scene.skins = [with(Sampling::default()), with(sharp), with(sharp)]
        .map(|skin| SkinInstance { skin, ..scene.skins[0].clone() })
        .to_vec();
    let hidden = film.frame(&scene);
    assert!(!hidden.passes.contains(&"textured"), "nobody asked for it: {:?}", hidden.passes);
    scene.painted = true;
    let shown = film.frame(&scene);
    assert_eq!(shown.static_bytes, bytes, "one picture, though it is looked up in two ways");
    assert!(shown.passes.contains(&"textured"));
    assert_eq!(film.frame(&scene).static_bytes, 0, "it is there");
    scene.scalars = Some(Arc::new(vec![0.5; 125]));
    assert!(!film.frame(&scene).passes.contains(&"textured"), "a map of scalars is shown alone");
    scene.scalars = None;
    assert_eq!(film.frame(&scene).static_bytes, 0, "it is still there");
    let skins = std::mem::replace(&mut scene.skins, cube().skins);
    assert!(!film.frame(&scene).passes.contains(&"textured"), "nothing has a picture");
    scene.skins = skins;
    assert!(film.frame(&scene).static_bytes > bytes, "what nobody showed was forgotten");
}
