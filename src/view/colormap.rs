//! Colours for scalars: perceptually uniform and safe for colour-blind people. One table serves the picture and the
//! legend.

/// A perceptually uniform colour map, dark for low values and light for high ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Colormap {
    /// Violet over green to yellow.
    #[default]
    Viridis,
    /// Black over red to pale yellow.
    Inferno,
    /// Blue to yellow, nearly the same for every kind of colour vision.
    Cividis,
}

/// sRGB colours for several curves in one plot, distinct for colour-blind people too (Okabe, Ito), and a grey.
pub const SERIES: [[u8; 3]; 7] =
    [[0, 114, 178], [204, 121, 167], [0, 158, 115], [230, 159, 0], [213, 94, 0], [86, 180, 233], [90, 90, 90]];

/// Entries of [`Colormap::table`].
pub const TABLE_SIZE: u32 = 256;

impl Colormap {
    /// All of them, in the order of lists.
    pub const ALL: [Self; 3] = [Self::Viridis, Self::Inferno, Self::Cividis];

    /// The name on screen and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viridis => "viridis",
            Self::Inferno => "inferno",
            Self::Cividis => "cividis",
        }
    }

    /// The sRGB colour at a place in the map, from 0 (lowest) to 1 (highest). Places outside are clipped, NaN counts as
    /// lowest.
    pub fn srgb(self, place: f32) -> [u8; 3] {
        let gradient = match self {
            Self::Viridis => colorous::VIRIDIS,
            Self::Inferno => colorous::INFERNO,
            Self::Cividis => colorous::CIVIDIS,
        };
        let place = if place.is_nan() { 0.0 } else { f64::from(place.clamp(0.0, 1.0)) };
        gradient.eval_continuous(place).as_array()
    }

    /// The sRGB colours of [`TABLE_SIZE`] evenly spaced places, lowest first.
    pub fn table(self) -> [[u8; 3]; TABLE_SIZE as usize] {
        std::array::from_fn(|entry| self.srgb(entry as f32 / (TABLE_SIZE - 1) as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::color::linear_from_srgb;

    /// CIE lightness L*, 0..100.
    fn lightness(srgb: [u8; 3]) -> f32 {
        let [r, g, b] = linear_from_srgb(srgb);
        let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        if luminance > 0.008_856 { 116.0 * luminance.cbrt() - 16.0 } else { 903.3 * luminance }
    }

    #[test]
    fn every_map_grows_lighter_all_the_way() {
        for map in Colormap::ALL {
            let samples: Vec<f32> = (0..=16).map(|i| lightness(map.srgb(i as f32 / 16.0))).collect();
            assert!(samples.is_sorted(), "{} is not monotone in lightness: {samples:?}", map.name());
            assert!(samples[16] - samples[0] > 60.0, "{} spans too little lightness", map.name());
        }
    }

    #[test]
    fn values_outside_the_range_take_the_end_colours() {
        let map = Colormap::Viridis;
        assert_eq!(map.srgb(-3.0), map.table()[0], "below is lowest");
        assert_eq!(map.srgb(f32::INFINITY), map.table()[TABLE_SIZE as usize - 1], "above is highest");
        assert_eq!(map.srgb(f32::NAN), map.table()[0], "not a number is lowest");
    }
}
