//! Converts between the colours that people name (sRGB) and those in which light adds up (linear).

/// Linear red, green, blue of an sRGB colour, each 0..1 (IEC 61966-2-1).
pub fn linear_from_srgb(srgb: [u8; 3]) -> [f32; 3] {
    srgb.map(|channel| {
        let encoded = f32::from(channel) / 255.0;
        if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    })
}

/// The nearest sRGB colour of a linear one; values outside 0..1 are clipped.
pub fn srgb_from_linear(linear: [f32; 3]) -> [u8; 3] {
    linear.map(|value| {
        let value = value.clamp(0.0, 1.0);
        let encoded = if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
        to_byte(encoded)
    })
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the value is within 0..1")]
fn to_byte(unit: f32) -> u8 {
    (unit * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_srgb_value_survives_the_way_there_and_back() {
        for value in 0..=255 {
            let srgb = [value, 255 - value, value / 2];
            assert_eq!(srgb_from_linear(linear_from_srgb(srgb)), srgb, "no step is lost");
        }
    }
}
