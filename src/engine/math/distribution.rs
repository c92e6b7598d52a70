//! Tabulated distributions, sampled by inversion so that stratified numbers stay stratified.
//!
//! Uniform numbers are multiples of 2⁻²⁴. A table whose probabilities are not would miss entries
//! below that, and be off by up to that much in the others: small for the whole, all the light
//! there is where a dim lamp stands alone. The tables here are therefore rounded to 2²⁴ cells
//! first, at least one a positive weight; the probability reported is the one sampled, exactly.

/// Number of cells, and the largest number of positive weights a table can hold.
const CELLS: u32 = 1 << 24;
const CELL: f32 = 1.0 / CELLS as f32;

/// An entry chosen from a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Index of the entry.
    pub index: usize,
    /// Its probability, > 0.
    pub pmf: f32,
    /// The number that chose it, stretched over [0, 1): a number for further use, of as many bits
    /// fewer as the choice took.
    pub rest: f32,
}

/// A distribution over indices 0‥n.
///
/// Invariant: the cells of all entries together number 2²⁴, so that the probabilities, multiples
/// of 2⁻²⁴, sum to exactly 1; an entry has no cell if and only if its weight is 0.
#[derive(Clone, Debug)]
pub struct Discrete {
    /// First cell of each entry, and 2²⁴ at the end.
    starts: Vec<u32>,
}

impl Discrete {
    /// Probabilities in proportion to `weights`. `None` if none is positive, if one is negative or
    /// not finite, or if more than 2²⁴ are positive.
    pub fn new(weights: &[f64]) -> Option<Self> {
        if weights.iter().any(|w| !w.is_finite() || *w < 0.0) {
            return None;
        }
        let largest = weights.iter().copied().fold(0.0, f64::max);
        let positive = weights.iter().filter(|w| **w > 0.0).count();
        if positive == 0 || positive > CELLS as usize {
            return None;
        }
        // Dividing by the largest keeps the sum finite.
        let sum: f64 = weights.iter().map(|w| w / largest).sum();
        let spare = f64::from(CELLS - positive as u32);

        // One cell for each positive weight; the others where the running sum of the weights
        // falls, so that rounding errors do not add up.
        let mut starts = Vec::with_capacity(weights.len() + 1);
        let (mut running, mut given, mut seen) = (0.0, 0, 0);
        starts.push(0);
        for w in weights {
            if *w > 0.0 {
                running += w / largest;
                seen += 1;
                given = if seen == positive {
                    CELLS
                } else {
                    seen as u32 + (spare * (running / sum).min(1.0)).round() as u32
                };
            }
            starts.push(given);
        }
        Some(Self { starts })
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Never: a table has a positive weight.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Probability of an entry; 0 beyond the last.
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        match (self.starts.get(index), self.starts.get(index + 1)) {
            (Some(&start), Some(&end)) => (end - start) as f32 * CELL,
            _ => 0.0,
        }
    }

    /// The entry that `u` in [0, 1) falls on.
    #[inline]
    pub fn sample(&self, u: f32) -> Choice {
        let x = u.clamp(0.0, 1.0) * CELLS as f32;
        let cell = (x as u32).min(CELLS - 1);
        let index = self.starts.partition_point(|&start| start <= cell) - 1;
        let (start, end) = (self.starts[index], self.starts[index + 1]);
        let width = (end - start) as f32;
        let within = (cell - start) as f32 + (x - cell as f32).clamp(0.0, 1.0);
        Choice {
            index,
            pmf: width * CELL,
            rest: (within / width).min(super::float::ONE_MINUS_EPSILON),
        }
    }
}

/// A distribution over the cells of a table: a row first, then a column of it.
#[derive(Clone, Debug)]
pub struct Discrete2d {
    rows: Discrete,
    /// Of each row; a row of probability 0 has none.
    columns: Vec<Option<Discrete>>,
}

impl Discrete2d {
    /// Probabilities in proportion to `weights`, row after row of `width` columns. `None` for a
    /// width of 0 and where [`Discrete::new`] would be.
    pub fn new(weights: &[f64], width: usize) -> Option<Self> {
        if width == 0 {
            return None;
        }
        let largest = weights.iter().copied().fold(0.0, f64::max);
        let scale = |w: &f64| w / largest;
        let sums: Vec<f64> = weights
            .chunks(width)
            .map(|row| row.iter().map(scale).sum())
            .collect();
        let columns: Vec<_> = weights.chunks(width).map(Discrete::new).collect();
        Some(Self {
            rows: Discrete::new(&sums)?,
            columns,
        })
    }

    /// Probability of the cell in `row` and `column`.
    #[inline]
    pub fn pmf(&self, row: usize, column: usize) -> f32 {
        match self.columns.get(row) {
            Some(Some(columns)) => self.rows.pmf(row) * columns.pmf(column),
            _ => 0.0,
        }
    }

    /// Row and column for two numbers in [0, 1); their probabilities multiply.
    #[inline]
    pub fn sample(&self, u_row: f32, u_column: f32) -> Option<(Choice, Choice)> {
        let row = self.rows.sample(u_row);
        let column = self.columns[row.index].as_ref()?.sample(u_column);
        Some((row, column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::math::float::ONE_MINUS_EPSILON;
    use crate::engine::math::hash::{mix64, unit_f32};

    #[test]
    fn every_number_of_the_grid_is_counted_by_the_reported_probability() {
        let weights = [3.0, 0.0, 1e-12, 1.0, 1e12, 0.0, 2e-300, 5e11];
        let table = Discrete::new(&weights).unwrap();
        let mut count = [0u32; 8];
        for cell in 0..CELLS {
            let choice = table.sample(cell as f32 * CELL);
            assert!(choice.rest >= 0.0 && choice.rest < 1.0);
            count[choice.index] += 1;
        }
        for (i, n) in count.iter().enumerate() {
            assert_eq!(*n as f32 * CELL, table.pmf(i));
            assert_eq!(*n == 0, weights[i] == 0.0);
        }
        assert!((table.pmf(4) - 2.0 / 3.0).abs() < 1e-6);
    }

    #[test]
    fn probabilities_sum_to_one_at_any_size_and_range() {
        for n in [1usize, 2, 3, 1000, 100_000] {
            let weights: Vec<f64> = (0..n)
                .map(|i| 10f64.powf(24.0 * f64::from(unit_f32(mix64(i as u64))) - 12.0))
                .collect();
            let table = Discrete::new(&weights).unwrap();
            let sum: f64 = (0..n).map(|i| f64::from(table.pmf(i))).sum();
            assert_eq!(sum, 1.0);
            assert!((0..n).all(|i| table.pmf(i) > 0.0));
            assert_eq!(table.sample(0.0).index, 0);
            assert_eq!(table.sample(ONE_MINUS_EPSILON).index, n - 1);
        }
    }

    #[test]
    fn bad_weights_are_refused() {
        for bad in [
            &[][..],
            &[0.0],
            &[1.0, f64::NAN],
            &[f64::INFINITY],
            &[1.0, -1.0],
        ] {
            assert!(Discrete::new(bad).is_none(), "{bad:?}");
        }
        assert!(Discrete2d::new(&[1.0], 0).is_none());
        assert!(Discrete2d::new(&[0.0, 0.0], 2).is_none());
    }

    #[test]
    fn the_plane_is_sampled_as_reported() {
        let weights = [1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 9.0];
        let table = Discrete2d::new(&weights, 3).unwrap();
        let mut count = [0u32; 9];
        let n = 512;
        for i in 0..n * n {
            let u = |k: u32| (k as f32 + 0.5) / n as f32;
            let (row, column) = table.sample(u(i / n), u(i % n)).unwrap();
            assert_eq!(row.pmf * column.pmf, table.pmf(row.index, column.index));
            count[row.index * 3 + column.index] += 1;
        }
        for (i, weight) in weights.iter().enumerate() {
            let share = f64::from(count[i]) / f64::from(n * n);
            assert!((share - weight / 16.0).abs() < 2e-3, "{i}: {share}");
            assert!((f64::from(table.pmf(i / 3, i % 3)) - weight / 16.0).abs() < 1e-6);
        }
        assert_eq!(table.pmf(7, 0), 0.0);
    }
}
