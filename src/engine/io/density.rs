//! Density files: `nx ny nz` in the first line, then as many numbers, x fastest, then y, then z.

use super::error::InputError;
use super::source::{FileSource, reason};
use crate::engine::scene::desc::media::DensityData;

/// Most voxels: 1024³ numbers are 4 GiB.
const MAX_VOXELS: u64 = 1 << 30;

/// Reads the density file at `path`.
pub fn read(files: &dyn FileSource, path: &str) -> Result<DensityData, InputError> {
    let bytes = files
        .read(path)
        .map_err(|e| InputError::in_file(path, reason(&e)))?;
    let Ok(text) = std::str::from_utf8(&bytes) else {
        return Err(InputError::in_file(
            path,
            "it is no text; a density file is",
        ));
    };
    let mut lines = text.lines().enumerate().map(|(i, l)| (i + 1, l));
    let right = "the first line is to be `nx ny nz`, three whole numbers above 0";
    let (_, first) = lines.next().unwrap_or((1, ""));
    let sizes: Vec<u64> = first
        .split_whitespace()
        .map_while(|n| n.parse().ok().filter(|n| *n > 0))
        .collect();
    let [nx, ny, nz] = sizes[..] else {
        return Err(InputError::at(path, 1, right));
    };
    let product = [nx, ny, nz]
        .iter()
        .try_fold(1_u64, |p, n| p.checked_mul(*n));
    let Some(count) = product.filter(|n| *n <= MAX_VOXELS) else {
        let message = format!("{nx} · {ny} · {nz} voxels are more than 2^30");
        return Err(InputError::at(path, 1, message));
    };
    // What the file can hold at the most decides how much is reserved, not what it claims.
    let mut values = Vec::with_capacity(count.min(text.len() as u64 / 2) as usize);
    for (number, line) in lines {
        for word in line.split_ascii_whitespace() {
            let value = word.parse::<f32>().ok();
            let Some(value) = value.filter(|x| x.is_finite() && *x >= 0.0) else {
                let message = format!("a density is a finite number of at least 0, not \"{word}\"");
                return Err(InputError::at(path, number, message));
            };
            values.push(value);
        }
        if values.len() as u64 > count {
            let message = format!("there are more numbers than {nx} · {ny} · {nz} voxels");
            return Err(InputError::at(path, number, message));
        }
    }
    if (values.len() as u64) < count {
        let found = values.len();
        let message = format!("it holds {found} numbers, not {nx} · {ny} · {nz}");
        return Err(InputError::in_file(path, message));
    }
    Ok(DensityData {
        name: path.to_owned(),
        size: [nx, ny, nz].map(|n| n as usize),
        values,
    })
}
