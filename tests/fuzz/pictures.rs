//! Pictures and the material files that refer to them: good ones written here, with a few changes.

use gelatin::math::rng::Rng;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::models::changed;
use crate::mutate::{below, pick, text};

/// Length of the signature before the chunks of a PNG file, bytes.
const PNG_SIGNATURE: usize = 8;

const MATERIALS: [&str; 3] = [
    "newmtl red\nKd 1 0 0\nmap_Kd p.png\n",
    "# two\nnewmtl red\n  Kd 0.5 .25 1e-1\nd 0.5\nmap_Kd -s 2 4 1 -o 0.5 0 0 -clamp on p.png\r\nnewmtl green\nKd 0 1 0\n",
    "newmtl red\nmap_Kd -blendu off -mm 0 1 -bm 1 -imfchan l \"P.PNG\"\nKd xyz 1 1 1\nillum 2\n",
];

const MATERIAL_WORDS: [&str; 19] = [
    "newmtl ",
    "map_Kd ",
    "Kd ",
    "red",
    "p.png",
    "P.PNG",
    "../p.png",
    "/",
    "\\",
    "-s ",
    "-o 1 ",
    "-clamp on ",
    "-t ",
    "\"",
    "\n",
    "\\\n",
    "#",
    "\u{fe}",
    "\t",
];

/// A model with a material file and a picture beside it.
#[derive(Debug)]
pub(crate) struct Painted {
    pub(crate) materials: Vec<u8>,
    pub(crate) picture: Vec<u8>,
}

impl Painted {
    /// Draws a model of which either the materials or the picture have changes.
    pub(crate) fn draw(rng: &mut Rng) -> Self {
        if below(rng, 2) == 0 {
            return Self { materials: text(rng, &MATERIALS, &MATERIAL_WORDS), picture: good(rng) };
        }
        Self { materials: pick(rng, &MATERIALS).as_bytes().to_vec(), picture: changed_picture(rng) }
    }

    /// Both files in one, for writing down a case.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let length = u32::try_from(self.materials.len()).expect("short").to_le_bytes();
        [&length[..], &self.materials, &self.picture].concat()
    }

    pub(crate) fn from_bytes(bytes: &[u8]) -> Self {
        let (length, rest) = bytes.split_first_chunk().expect("a length");
        let (materials, picture) = rest.split_at(u32::from_le_bytes(*length) as usize);
        Self { materials: materials.to_vec(), picture: picture.to_vec() }
    }
}

/// A picture, with a few changes half of the time.
pub(crate) fn picture(rng: &mut Rng) -> Vec<u8> {
    if below(rng, 2) == 0 { good(rng) } else { changed_picture(rng) }
}

/// A PNG or JPEG file of a few texels.
fn good(rng: &mut Rng) -> Vec<u8> {
    let colors = [ExtendedColorType::L8, ExtendedColorType::La8, ExtendedColorType::Rgb8, ExtendedColorType::Rgba8];
    let color = *pick(rng, &colors);
    let [width, height] = [1, 1].map(|least| least + below(rng, 20));
    let texels: Vec<u8> = (0..=u8::MAX).cycle().take(width * height * usize::from(color.channel_count())).collect();
    let [width, height] = [width, height].map(|side| u32::try_from(side).expect("short"));
    let mut file = Vec::new();
    let is_jpeg = matches!(color, ExtendedColorType::L8 | ExtendedColorType::Rgb8) && below(rng, 2) == 0;
    let written = if is_jpeg {
        JpegEncoder::new_with_quality(&mut file, 80).write_image(&texels, width, height, color)
    } else {
        PngEncoder::new(&mut file).write_image(&texels, width, height, color)
    };
    written.expect("memory refuses nothing");
    file
}

/// A picture with changes. A changed PNG file often gets correct check sums, as otherwise nothing after them would be read.
fn changed_picture(rng: &mut Rng) -> Vec<u8> {
    let good = good(rng);
    let mut file = changed(rng, good);
    if below(rng, 4) > 0 {
        mend_check_sums(&mut file);
    }
    file
}

/// Gives every whole chunk of a PNG file the check sum of its bytes.
fn mend_check_sums(file: &mut [u8]) {
    let mut rest = file.get_mut(PNG_SIGNATURE..).unwrap_or_default();
    while let Some((length, chunk)) = rest.split_first_chunk_mut() {
        let length = (u32::from_be_bytes(*length) as usize).saturating_add(4);
        let Some((named, after)) = chunk.split_at_mut_checked(length) else { return };
        let Some((sum, after)) = after.split_first_chunk_mut() else { return };
        *sum = crc32(named).to_be_bytes();
        rest = after;
    }
}

/// The check sum of PNG's chunks (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| (sum >> 1) ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 })
    })
}

#[test]
fn a_changed_chunk_is_read_with_its_own_check_sum() {
    let mut file = Vec::new();
    PngEncoder::new(&mut file).write_image(&[9; 4], 2, 2, ExtendedColorType::L8).expect("memory refuses nothing");
    let whole = file.clone();
    // The first chunk's check sum follows its length, its name and its thirteen bytes.
    file[PNG_SIGNATURE + 8 + 13] ^= 1;
    assert!(image::load_from_memory(&whole).is_ok() && image::load_from_memory(&file).is_err());
    mend_check_sums(&mut file);
    assert_eq!(file, whole);
}
