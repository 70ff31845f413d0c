//! The paths of a scene's models: whose they are, and how they are written as seen from another folder.

use std::path::{Component, Path, PathBuf};

use crate::scene::{ObstacleShape, Scene, Shape, builtin, embedded};

/// The paths of all models that are files, and whose they are.
pub(super) fn model_files(scene: &mut Scene) -> impl Iterator<Item = (String, &mut String)> {
    models(scene).filter(|(_, path)| !path.starts_with(embedded::PREFIX))
}

/// The paths of all models that the program does not carry, and whose they are.
pub(super) fn models(scene: &mut Scene) -> impl Iterator<Item = (String, &mut String)> {
    let bodies = (1..).zip(&mut scene.bodies).filter_map(|(number, body)| match &mut body.shape {
        Shape::Model(model) => Some((format!("body {number}"), &mut model.path)),
        _ => None,
    });
    let obstacles = (1..).zip(&mut scene.obstacles).filter_map(|(number, obstacle)| match &mut obstacle.shape {
        ObstacleShape::Mesh(mesh) => Some((format!("obstacle {number}"), &mut mesh.path)),
        _ => None,
    });
    bodies.chain(obstacles).filter(|(_, path)| !path.starts_with(builtin::PREFIX))
}

/// Whether a person can choose where the models of a scene are: some are files, and it holds none.
pub(super) fn chooses_models(scene: &Scene) -> bool {
    let of_bodies = scene.bodies.iter().filter_map(|body| match &body.shape {
        Shape::Model(model) => Some(&model.path),
        _ => None,
    });
    let of_obstacles = scene.obstacles.iter().filter_map(|obstacle| match &obstacle.shape {
        ObstacleShape::Mesh(mesh) => Some(&mesh.path),
        _ => None,
    });
    let is_file = |path: &String| !path.starts_with(builtin::PREFIX);
    scene.models.is_empty() && of_bodies.chain(of_obstacles).any(is_file)
}

/// An absolute path as seen from an absolute folder without `.` and `..`.
pub(super) fn relative_to(path: &Path, folder: &Path) -> PathBuf {
    let target = normalized(path);
    let shared = target.components().zip(folder.components()).take_while(|(a, b)| a == b);
    let named = |&(part, _): &(Component<'_>, _)| matches!(part, Component::Normal(_));
    let (all, names) = shared.fold((0, 0), |(all, names), pair| (all + 1, names + usize::from(named(&pair))));
    if names == 0 {
        return target;
    }
    let up = folder.components().skip(all).map(|_| Component::ParentDir);
    let relative: PathBuf = up.chain(target.components().skip(all)).collect();
    // With a symbolic link on the way `..` may lead elsewhere.
    let same = match (folder.join(&relative).canonicalize(), path.canonicalize()) {
        (Ok(found), Ok(wanted)) => found == wanted,
        (_, Err(_missing)) => true,
        (Err(_misled), Ok(_)) => false,
    };
    if same { relative } else { path.to_owned() }
}

/// Returns the absolute path of a folder; an empty path is the current folder.
pub(super) fn absolute(folder: &Path) -> PathBuf {
    let named = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    std::path::absolute(named).unwrap_or_else(|_no_current_folder| folder.to_owned())
}

/// A path without `.` and, as far as they follow a name, without `..`.
pub(super) fn normalized(path: &Path) -> PathBuf {
    let mut normalized = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(normalized.components().next_back(), Some(Component::Normal(_))) => {
                normalized.pop();
            }
            _ => normalized.push(part),
        }
    }
    normalized
}
