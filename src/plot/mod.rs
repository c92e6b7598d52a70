//! Errors against time as a chart with logarithmic axes: SVG for pages and files, pixels for PNG.

mod draw;

#[cfg(any(feature = "viewer", test))]
use std::fmt::Write;

#[cfg(feature = "viewer")]
pub use draw::pixels;
pub use draw::svg;

/// One curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its name.
    pub label: String,
    /// Its colour.
    pub color: [u8; 3],
    /// Points (x, y) in the order of x. What is not positive is left out.
    pub points: Vec<(f64, f64)>,
    /// Lowest and highest y at an x, where there is a spread.
    pub band: Vec<(f64, [f64; 2])>,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Above it.
    pub title: String,
    /// Below it.
    pub x_label: String,
    /// Beside it.
    pub y_label: String,
    /// Its curves.
    pub curves: Vec<Curve>,
    /// A horizontal line.
    pub target: Option<f64>,
    /// Whether x is time or work, along which errors fall with slope −1/2: a line shows it.
    pub guided: bool,
}

impl Chart {
    /// Ends of x and of y, rounded outward a little; none without two positive numbers each.
    fn ranges(&self) -> Option<[[f64; 2]; 2]> {
        let points = self.curves.iter().flat_map(|c| {
            let band = c.band.iter().flat_map(|(x, y)| y.map(|y| (*x, y)));
            c.points.iter().copied().chain(band)
        });
        let mut ranges = [[f64::INFINITY, 0.0]; 2];
        for (x, y) in points.filter(|(x, y)| is_shown(*x) && is_shown(*y)) {
            for (range, v) in ranges.iter_mut().zip([x, y]) {
                *range = [range[0].min(v), range[1].max(v)];
            }
        }
        if let Some(target) = self.target.filter(|t| is_shown(*t)) {
            ranges[1] = [ranges[1][0].min(target), ranges[1][1].max(target)];
        }
        let wide = |[low, high]: [f64; 2]| {
            let margin = (high / low).powf(0.05).max(1.1);
            let [low, high] = [low / margin, high * margin];
            // Only powers of ten have marks: less than two of them are no scale.
            let (first, last) = (low.log10().ceil(), high.log10().floor());
            if last - first < 1.0 {
                [
                    10f64.powf(low.log10().floor()),
                    10f64.powf(high.log10().ceil()),
                ]
            } else {
                [low, high]
            }
        };
        (ranges[0][1] > 0.0).then(|| ranges.map(wide))
    }

    /// The guide of slope −1/2 through the first point of the first curve that has one.
    pub fn guide(&self) -> Option<[(f64, f64); 2]> {
        if !self.guided {
            return None;
        }
        let [[left, right], _] = self.ranges()?;
        let shown = |p: &&(f64, f64)| is_shown(p.0) && is_shown(p.1);
        let first = self
            .curves
            .iter()
            .find_map(|c| c.points.iter().find(shown))?;
        let at = |x: f64| (x, first.1 * (first.0 / x).sqrt());
        Some([at(left), at(right)])
    }

    /// The curves as a table, a line a point.
    #[cfg(any(feature = "viewer", test))]
    pub fn csv(&self) -> String {
        let mut text = format!(
            "curve,{},{},low,high\n",
            quoted(&self.x_label),
            quoted(&self.y_label)
        );
        for curve in &self.curves {
            for (i, (x, y)) in curve.points.iter().enumerate() {
                let band = curve
                    .band
                    .get(i)
                    .map_or(String::from(","), |(_, [low, high])| {
                        format!("{low},{high}")
                    });
                // Writing to a string cannot fail.
                let _ = writeln!(text, "{},{x},{y},{band}", quoted(&curve.label));
            }
        }
        text
    }
}

fn is_shown(x: f64) -> bool {
    x > 0.0 && x.is_finite()
}

/// A field of a CSV file (RFC 4180).
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let curve = |label: &str, factor: f64| Curve {
            label: label.to_owned(),
            color: [0, 114, 178],
            points: vec![(0.0, 1.0), (1.0, factor), (4.0, factor / 2.0)],
            band: Vec::new(),
        };
        Chart {
            title: "a <box>".to_owned(),
            x_label: "seconds".to_owned(),
            y_label: "error".to_owned(),
            curves: vec![curve("path", 0.5), curve("a, b", 0.25)],
            target: Some(0.01),
            guided: true,
        }
    }

    #[test]
    fn charts_have_curves_guide_and_escaped_texts() {
        let svg = svg(&chart(), [640, 400]).expect("a chart");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for text in [
            "path",
            "a, b",
            "a &lt;box&gt;",
            "seconds",
            "slope −1/2",
            "0.01",
        ] {
            assert!(svg.contains(text), "{text} is not in {svg}");
        }
        assert!(svg.matches("<polyline").count() >= 2);
    }

    #[test]
    fn charts_without_points_say_so() {
        let mut empty = chart();
        empty.curves.clear();
        let svg = svg(&empty, [640, 400]).expect("a chart");
        assert!(svg.contains("no errors yet"));
        assert_eq!(empty.guide(), None);
    }

    #[test]
    fn the_guide_halves_over_a_factor_of_four() {
        let [(x0, y0), (x1, y1)] = chart().guide().expect("points");
        assert!(((y0 / y1) - (x1 / x0).sqrt()).abs() < 1e-12);
        assert!((y0 * x0.sqrt() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn tables_quote_what_needs_it() {
        let csv = chart().csv();
        assert!(
            csv.starts_with("curve,seconds,error,low,high\npath,0,1,,\n"),
            "{csv}"
        );
        assert!(csv.contains("\"a, b\",4,0.125,,\n"), "{csv}");
    }

    #[cfg(feature = "viewer")]
    #[test]
    fn pixels_are_drawn_with_text() {
        let pixels = pixels(&chart(), [320, 200]).expect("a chart");
        assert_eq!(pixels.len(), 320 * 200);
        let dark = pixels.iter().filter(|p| p.iter().all(|c| *c < 100)).count();
        assert!(dark > 50, "there is no text: {dark}");
        assert!(pixels.contains(&[0, 114, 178]));
    }
}
