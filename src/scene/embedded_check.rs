//! Checks the model files within a scene.

use std::io;

use super::Embedded;
use super::embedded::Damage;
use super::param::Problem;
use crate::geometry::import::MAX_FILE_BYTES;
use crate::text::{echo, echo_up_to};

/// All files of a scene together may hold this many bytes: a short packed text can stand for very many.
const MAX_BYTES: u64 = MAX_FILE_BYTES;

/// The longest path of a file, bytes.
const MAX_PATH: usize = 1024;

/// Lists everything that is wrong with the files, without keeping their bytes.
pub(super) fn problems(models: &Embedded) -> Vec<Problem> {
    let files = models.files();
    let problem =
        |place: usize, field: &str, message: String| Problem { path: format!("models.{place}.{field}"), message };
    let total = files.iter().fold(0_u64, |sum, file| sum.saturating_add(file.bytes));
    if total > MAX_BYTES {
        let largest = (0..files.len()).max_by_key(|&place| files[place].bytes).unwrap_or(0);
        let most = MAX_BYTES >> 20;
        let words = format!("{}: all models of a scene together hold at most {most} MiB", files[largest].bytes);
        return vec![problem(largest, "bytes", words)];
    }
    let mut problems = Vec::new();
    for (place, file) in files.iter().enumerate() {
        if !is_sound(&file.path) {
            let words = format!("\"{}\", which is no path; one is such as lamp/lamp.gltf", echo_up_to(&file.path, 60));
            problems.push(problem(place, "path", words));
        }
        match file.unpack_into(&mut io::sink()) {
            Ok(()) => {}
            Err(Damage::Length { found, said }) => {
                let more = if found > said { "it has more" } else { "it has fewer" };
                problems.push(problem(place, "bytes", format!("{said}, but {more}")));
            }
            Err(damage) => {
                let words = format!("{}; save the scene with its models inside again", echo(&damage.to_string()));
                problems.push(problem(place, "deflated", words));
            }
        }
    }
    let mut paths: Vec<(&str, usize)> = files.iter().map(|file| file.path.as_str()).zip(0..).collect();
    paths.sort_unstable();
    let twice = paths.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    problems.extend(twice.map(|pair| {
        let words = format!("\"{}\", which is there twice; every path is there once", echo_up_to(pair[1].0, 60));
        problem(pair[1].1, "path", words)
    }));
    problems
}

/// Whether a path stays among the scene's files.
fn is_sound(path: &str) -> bool {
    let is_name = |name: &str| !matches!(name, "" | "." | "..") && !name.contains(['\\', ':', '\0']);
    path.len() <= MAX_PATH && path.split('/').all(is_name)
}
