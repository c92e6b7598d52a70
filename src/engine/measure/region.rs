//! A rectangle of a picture.

use std::fmt;
use std::str::FromStr;

use glam::UVec2;

/// Pixels from `min` on, `size` of them each way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// The left top pixel.
    pub min: UVec2,
    /// Pixels each way; at least one.
    pub size: UVec2,
}

impl Region {
    /// Its pixels, row by row, out of a picture of `size` pixels; none if it reaches beyond it.
    pub fn of(&self, pixels: &[[f32; 3]], size: UVec2) -> Option<Vec<[f32; 3]>> {
        let end = self.min.checked_add(self.size)?;
        if end.cmpgt(size).any() || pixels.len() != size.x as usize * size.y as usize {
            return None;
        }
        let row = |y: u32| {
            let start = y as usize * size.x as usize + self.min.x as usize;
            &pixels[start..start + self.size.x as usize]
        };
        Some((self.min.y..end.y).flat_map(row).copied().collect())
    }
}

impl FromStr for Region {
    type Err = String;

    /// Reads `X,Y,WxH`.
    fn from_str(text: &str) -> Result<Self, String> {
        let read = || {
            let mut parts = text.splitn(3, ',');
            let (x, y) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
            let (w, h) = parts.next()?.split_once(['x', 'X', '×'])?;
            let size = UVec2::new(w.parse().ok()?, h.parse().ok()?);
            let min = UVec2::new(x, y);
            (size.min_element() > 0).then_some(Self { min, size })
        };
        read().ok_or_else(|| {
            "it must be X,Y,WxH, the left top pixel and the size, such as 10,20,64x48".to_owned()
        })
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (min, size) = (self.min, self.size);
        write!(f, "{},{},{}x{}", min.x, min.y, size.x, size.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_are_read_and_cut_out() {
        let region: Region = "1,2,2x1".parse().unwrap();
        assert_eq!(region.to_string(), "1,2,2x1");
        let size = UVec2::new(4, 3);
        let pixels: Vec<[f32; 3]> = (0..12).map(|i| [i as f32; 3]).collect();
        assert_eq!(region.of(&pixels, size), Some(vec![[9.0; 3], [10.0; 3]]));
        let beyond: Region = "3,2,2x1".parse().unwrap();
        assert_eq!(beyond.of(&pixels, size), None);
        let far: Region = "4294967295,0,1x1".parse().unwrap();
        assert_eq!(far.of(&pixels, size), None);
        for wrong in ["", "1,2", "1,2,3", "1,2,0x3", "a,2,3x3", "1,2,3x3,4"] {
            assert!(wrong.parse::<Region>().is_err(), "{wrong}");
        }
    }
}
