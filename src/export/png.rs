//! A picture as a PNG file, written whole or not at all.

use std::io;
use std::path::{Path, PathBuf};

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::disk;
use crate::text::echo_path;
use crate::view::Image;

/// A picture that could not be written. What was at the path before is still there.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The folder or the file cannot be written.
    #[error("cannot write the picture {path}", path = echo_path(path))]
    Write {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The picture does not hold as many pixels as it says.
    #[error("cannot write the picture {path}: it holds {bytes} bytes, not those of {size:?} pixels", path = echo_path(path))]
    Incomplete {
        /// The file.
        path: PathBuf,
        /// Width and height, pixels.
        size: [u32; 2],
        /// Bytes it holds.
        bytes: usize,
    },
    /// The picture cannot be encoded.
    #[error("cannot encode the picture {path} of {size:?} pixels", path = echo_path(path))]
    Encode {
        /// The file.
        path: PathBuf,
        /// Width and height, pixels.
        size: [u32; 2],
        /// Why not.
        source: image::ImageError,
    },
}

/// Writes a picture as PNG: to a new file beside `path`, which takes its place when it is complete.
pub fn write_png(image: &Image, path: &Path) -> Result<(), PngError> {
    let [width, height] = image.size;
    let bytes = image.rgba.len();
    if bytes as u64 != 4 * u64::from(width) * u64::from(height) {
        return Err(PngError::Incomplete { path: path.to_owned(), size: image.size, bytes });
    }
    let mut encoded = Vec::new();
    PngEncoder::new(&mut encoded)
        .write_image(&image.rgba, width, height, ExtendedColorType::Rgba8)
        .map_err(|source| PngError::Encode { path: path.to_owned(), size: image.size, source })?;
    disk::write(path, &encoded).map_err(|source| PngError::Write { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_written_picture_reads_back_pixel_by_pixel() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("picture.png");
        let mut picture = Image::filled([7, 3], [10, 200, 30, 255]);
        picture.blend([6, 2], [255, 0, 0], 1.0);
        write_png(&picture, &path).expect("the folder is writable");
        let read = image::open(&path).expect("a valid PNG").into_rgba8();
        assert_eq!((read.width(), read.height()), (7, 3), "the same size");
        assert_eq!(read.into_raw(), picture.rgba, "the same pixels");
    }

    #[test]
    fn a_failed_write_names_the_file_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let broken = Image { size: [4, 4], rgba: Vec::new() };
        let path = folder.path().join("picture.png");
        std::fs::write(&path, "old").expect("the folder is writable");
        let missing = folder.path().join("missing").join("picture.png");
        let error = write_png(&Image::filled([1, 1], [0; 4]), &missing).expect_err("there is no such folder");
        assert!(error.to_string().contains("missing"), "{error}");
        let error = write_png(&broken, &path).expect_err("there are no pixels");
        assert!(error.to_string().contains("picture.png"), "{error}");
        assert_eq!(std::fs::read(&path).expect("still there"), b"old", "the old file is untouched");
        assert_eq!(std::fs::read_dir(folder.path()).expect("readable").count(), 1, "no temporary file is left");
    }
}
