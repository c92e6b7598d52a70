//! Charts by the library plotters.

use std::error::Error;

use plotters::coord::Shift;
use plotters::prelude::{
    BLACK, ChartBuilder, Circle, Color, DashedLineSeries, DrawingArea, DrawingBackend,
    IntoDrawingArea, IntoFont, IntoLogRange, LineSeries, PathElement, Polygon, RGBColor,
    SVGBackend, SeriesLabelPosition, ShapeStyle, TRANSPARENT, Text, WHITE,
};

use super::{Chart, Curve, is_shown};

/// Family of all texts: browsers choose one.
const FAMILY: &str = "sans-serif";
const GREY: RGBColor = RGBColor(130, 130, 130);
const PALE: RGBColor = RGBColor(226, 226, 226);

/// The chart as an SVG document of that size in pixels.
///
/// # Errors
/// A sentence.
pub fn svg(chart: &Chart, size: [u32; 2]) -> Result<String, String> {
    font();
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size.into()).into_drawing_area();
        draw(chart, &root).map_err(|error| format!("the plot cannot be drawn: {error}"))?;
    }
    Ok(text)
}

/// The chart as pixels, row by row.
///
/// # Errors
/// A sentence.
#[cfg(feature = "viewer")]
pub fn pixels(chart: &Chart, size: [u32; 2]) -> Result<Vec<[u8; 3]>, String> {
    font();
    let mut bytes = vec![0; size[0] as usize * size[1] as usize * 3];
    {
        let backend = plotters::prelude::BitMapBackend::with_buffer(&mut bytes, size.into());
        let root = backend.into_drawing_area();
        draw(chart, &root).map_err(|error| format!("the plot cannot be drawn: {error}"))?;
    }
    let pixels = bytes.as_chunks::<3>().0;
    Ok(pixels.to_vec())
}

/// Names the font of the window, so that no font of the system is needed.
#[cfg(feature = "viewer")]
fn font() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        use plotters::style::{FontStyle, register_font};
        let bytes = epaint_default_fonts::UBUNTU_LIGHT;
        // A font that is no font draws no text, which the test of this module sees.
        let _ = register_font(FAMILY, FontStyle::Normal, bytes);
    });
}

/// Without the window texts are measured by a rule of thumb.
#[cfg(not(feature = "viewer"))]
fn font() {}

fn draw<B: DrawingBackend>(
    chart: &Chart,
    root: &DrawingArea<B, Shift>,
) -> Result<(), Box<dyn Error>>
where
    B::ErrorType: 'static,
{
    root.fill(&WHITE)?;
    let Some([x, y]) = chart.ranges() else {
        let style = (FAMILY, 18).into_font().color(&GREY);
        root.draw(&Text::new("no errors yet", (20, 20), style))?;
        root.present()?;
        return Ok(());
    };
    let mut axes = ChartBuilder::on(root)
        .caption(&chart.title, (FAMILY, 17))
        .margin(10)
        .margin_right(18)
        .x_label_area_size(42)
        .y_label_area_size(68)
        .build_cartesian_2d((x[0]..x[1]).log_scale(), (y[0]..y[1]).log_scale())?;
    axes.configure_mesh()
        .bold_line_style(PALE)
        .light_line_style(TRANSPARENT)
        .x_desc(&chart.x_label)
        .y_desc(&chart.y_label)
        .label_style((FAMILY, 13))
        .x_label_formatter(&|v| tick(*v))
        .y_label_formatter(&|v| tick(*v))
        .draw()?;
    if let Some([a, b]) = chart.guide() {
        let inside = clip([a, b], y);
        axes.draw_series(DashedLineSeries::new(inside, 3, 5, ShapeStyle::from(GREY)))?
            .label("slope −1/2")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], GREY));
    }
    if let Some(target) = chart.target.filter(|t| is_shown(*t)) {
        let line = [(x[0], target), (x[1], target)];
        axes.draw_series(LineSeries::new(line, BLACK.stroke_width(1)))?
            .label(format!("target {}", tick(target)))
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK));
    }
    for curve in &chart.curves {
        let color = RGBColor(curve.color[0], curve.color[1], curve.color[2]);
        axes.draw_series(band(curve).map(|b| Polygon::new(b, color.mix(0.18))))?;
        let points: Vec<(f64, f64)> = shown(curve).collect();
        let dots = points.clone();
        axes.draw_series(LineSeries::new(points, color.stroke_width(2)))?
            .label(&curve.label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
        axes.draw_series(dots.into_iter().map(|p| Circle::new(p, 2, color.filled())))?;
    }
    axes.configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(PALE)
        .label_font((FAMILY, 13))
        .draw()?;
    root.present()?;
    Ok(())
}

fn shown(curve: &Curve) -> impl Iterator<Item = (f64, f64)> {
    let points = curve.points.iter().copied();
    points.filter(|(x, y)| is_shown(*x) && is_shown(*y))
}

/// The outline of a curve's band; none if it has none.
fn band(curve: &Curve) -> impl Iterator<Item = Vec<(f64, f64)>> {
    let shown = |b: &&(f64, [f64; 2])| is_shown(b.0) && b.1.iter().all(|y| is_shown(*y));
    let edges: Vec<&(f64, [f64; 2])> = curve.band.iter().filter(shown).collect();
    let high = edges.iter().map(|(x, y)| (*x, y[1]));
    let low = edges.iter().rev().map(|(x, y)| (*x, y[0]));
    let outline: Vec<(f64, f64)> = high.chain(low).collect();
    (edges.len() > 1).then_some(outline).into_iter()
}

/// The part of a falling line of slope −1/2 that lies within `y`.
fn clip([a, b]: [(f64, f64); 2], y: [f64; 2]) -> [(f64, f64); 2] {
    let at = |v: f64| (a.0 * (a.1 / v).powi(2), v);
    let inside = |p: (f64, f64)| at(p.1.clamp(y[0], y[1]));
    [inside(a), inside(b)]
}

/// A number as short as can be.
fn tick(v: f64) -> String {
    if (1e-3..1e4).contains(&v) {
        format!("{}", (v * 1e6).round() / 1e6)
    } else {
        format!("{v:.0e}")
    }
}
