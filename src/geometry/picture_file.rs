//! Decodes the bytes of a PNG or JPEG file to a picture. The size in its header is checked before anything is unpacked: a
//! short file can stand for very many texels.

use std::io::Cursor;

use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use thiserror::Error;

use crate::math::picture::Picture;
use crate::text::echo_up_to;

/// The most texels of a picture that is unpacked.
pub const MAX_TEXELS: u64 = 1 << 26;

/// The most texels along a side of a picture that is kept: a finer one is made coarser.
pub const LONGEST_SIDE: u32 = 4096;

/// The most bytes that unpacking takes beside the picture itself.
const MAX_BYTES: u64 = 1 << 29;

/// What the opacity of texels means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opacity {
    /// Nothing: all of them are opaque.
    Ignored,
    /// How much of a texel there is.
    Counts,
}

/// Why the bytes of a file give no picture. The message continues a sentence that begins with the file's name.
#[derive(Debug, Error)]
pub enum PictureError {
    /// In another format.
    #[error("is no PNG or JPEG picture; save it as one of them")]
    Format,
    /// No texels.
    #[error("has no texels")]
    Empty,
    /// Too many texels.
    #[error("has {width}×{height} texels, more than the {} million that are read; make it smaller", MAX_TEXELS >> 20)]
    TooLarge {
        /// Texels from left to right.
        width: u32,
        /// Texels from top to bottom.
        height: u32,
    },
    /// Damaged, or takes more memory to unpack than is allowed.
    #[error("cannot be unpacked ({})", echo_up_to(&.0.to_string(), 120))]
    Broken(#[from] ImageError),
}

/// Returns the size of a picture according to its header, texels.
///
/// # Errors
/// If the file is no picture that can be read.
pub fn size(bytes: &[u8]) -> Result<[u32; 2], PictureError> {
    let (width, height) = opened(bytes)?.dimensions();
    match u64::from(width) * u64::from(height) {
        0 => Err(PictureError::Empty),
        texels if texels > MAX_TEXELS => Err(PictureError::TooLarge { width, height }),
        _ => Ok([width, height]),
    }
}

/// Returns the picture that a file holds.
///
/// # Errors
/// If the file holds no picture that can be read.
pub fn decode(bytes: &[u8], opacity: Opacity) -> Result<Picture, PictureError> {
    let size = size(bytes)?;
    let mut rgba = DynamicImage::from_decoder(opened(bytes)?)?.into_rgba8().into_raw();
    if opacity == Opacity::Ignored {
        rgba.as_chunks_mut().0.iter_mut().for_each(|[.., opacity]: &mut [u8; 4]| *opacity = u8::MAX);
    }
    Picture::new(size, rgba, LONGEST_SIDE).ok_or(PictureError::Empty)
}

/// Opens a file and reads its header.
fn opened(bytes: &[u8]) -> Result<impl ImageDecoder + '_, PictureError> {
    let is_read = |format: &ImageFormat| matches!(format, ImageFormat::Png | ImageFormat::Jpeg);
    let format = image::guess_format(bytes).ok().filter(is_read).ok_or(PictureError::Format)?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    Ok(reader.into_decoder()?)
}

#[cfg(test)]
pub(crate) mod tests {
    use image::codecs::jpeg::JpegEncoder;
    use image::codecs::png::PngEncoder;
    use image::{ExtendedColorType, ImageEncoder};

    use super::*;

    /// A PNG file of these texels.
    pub(crate) fn png([width, height]: [u32; 2], texels: &[[u8; 4]]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let written =
            PngEncoder::new(&mut bytes).write_image(&texels.concat(), width, height, ExtendedColorType::Rgba8);
        written.expect("memory refuses nothing");
        bytes
    }

    /// A JPEG file of one colour.
    pub(crate) fn jpeg([width, height]: [u32; 2], color: [u8; 3]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let rgb = color.repeat(width as usize * height as usize);
        JpegEncoder::new_with_quality(&mut bytes, 95)
            .write_image(&rgb, width, height, ExtendedColorType::Rgb8)
            .expect("memory refuses nothing");
        bytes
    }

    /// A PNG file whose header claims this size, without the texels.
    fn claim([width, height]: [u32; 2]) -> Vec<u8> {
        let mut bytes = png([1, 1], &[[0; 4]]);
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        let checksum = crc(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
        bytes
    }

    /// The checksum of a PNG chunk (ISO/IEC 15948, annex D).
    fn crc(bytes: &[u8]) -> u32 {
        let of_byte = |crc: u32, byte: &u8| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 })
        };
        !bytes.iter().fold(u32::MAX, of_byte)
    }

    #[test]
    fn both_formats_are_read_and_opacity_counts_where_it_should() {
        let texels = [[255, 0, 0, 255], [0, 255, 0, 0]];
        let file = png([2, 1], &texels);
        let finest = |opacity| decode(&file, opacity).expect("a picture").levels()[0].clone();
        assert_eq!(finest(Opacity::Ignored).rgba, [255, 0, 0, 255, 0, 255, 0, 255]);
        assert_eq!(finest(Opacity::Counts).rgba, [255, 0, 0, 255, 0, 0, 0, 0], "nothing is there");
        let photo = decode(&jpeg([8, 8], [200, 100, 50]), Opacity::Counts).expect("a picture");
        let near = photo.levels()[0].rgba.chunks(4).all(|texel| {
            texel.iter().zip([200, 100, 50, 255]).all(|(&found, wanted): (&u8, u8)| found.abs_diff(wanted) <= 3)
        });
        assert!(near && photo.levels()[0].size == [8, 8], "{:?}", photo.levels()[0].rgba);
    }

    #[test]
    fn what_is_no_picture_says_why() {
        let words = |bytes: &[u8]| decode(bytes, Opacity::Counts).expect_err("no picture").to_string();
        for other in [&b""[..], b"BM....", b"GIF89a", b"RIFF\0\0\0\0WEBP", b"v 0 0 0"] {
            assert_eq!(words(other), "is no PNG or JPEG picture; save it as one of them");
        }
        let file = png([8, 8], &[[1, 2, 3, 255]; 64]);
        assert!(words(&file[..file.len() - 20]).starts_with("cannot be unpacked ("), "cut off");
        let photo = jpeg([8, 8], [0; 3]);
        assert!(words(&photo[..12]).starts_with("cannot be unpacked ("), "cut off");
    }

    #[test]
    fn how_large_it_is_is_looked_at_first() {
        let words = |size| decode(&claim(size), Opacity::Counts).expect_err("no picture").to_string();
        let refused = "has 65536×1025 texels, more than the 64 million that are read; make it smaller";
        assert_eq!(words([65536, 1025]), refused);
        assert!(words([300_000; 2]).contains("texels, more than"), "no product overflows");
        assert!(!words([u32::MAX >> 1; 2]).is_empty(), "whoever refuses it first");
        assert!(words([8192, 8192]).starts_with("cannot be unpacked"), "as many as are read, if they were there");
    }

    #[test]
    fn a_fine_picture_is_kept_coarser() {
        let wide = decode(&png([LONGEST_SIDE + 2, 2], &vec![[9, 9, 9, 255]; 2 * 4098]), Opacity::Counts);
        assert_eq!(wide.expect("a picture").levels()[0].size, [2049, 1]);
    }
}
