//! Error against time, as it grows: both axes logarithmic.

use std::ops::RangeInclusive;

use egui::{Color32, Rangef, Ui, Window};
use egui_plot::{
    AxisHints, Corner, GridInput, GridMark, HLine, HoverPosition, Legend, Line, LineStyle, Plot,
    PlotPoints, Points, VLine,
};

use crate::plot::{Chart, Curve};
use crate::viewer::workspace::Workspace;

/// Draws the plot, `height` points high; with names if it is large.
pub fn show(ui: &mut Ui, workspace: &Workspace, height: f32, large: bool) {
    let target = workspace.preferences.target_error;
    let chart = workspace.measuring.chart(target);
    let reached = workspace
        .measuring
        .prediction(target)
        .map(|p| match workspace.measuring.along {
            crate::viewer::measuring::Along::Seconds => p.seconds,
            crate::viewer::measuring::Along::Samples => p.passes,
        });
    let along = chart.x_label.clone();
    let mut plot = Plot::new(("error", large)).height(height);
    // In the panel names and colours stand below the plot.
    if large {
        plot = plot.legend(Legend::default().position(Corner::LeftBottom));
    }
    let response = plot
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .custom_x_axes(vec![axis(AxisHints::new_x(), &chart.x_label)])
        .custom_y_axes(vec![axis(AxisHints::new_y(), &chart.y_label)])
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .label_formatter(move |at| hover(at, &along))
        .show(ui, |plot| {
            for curve in &chart.curves {
                draw(plot, curve);
            }
            guide(plot, &chart);
            plot.hline(
                HLine::new("target", target.log10())
                    .color(Color32::from_gray(140))
                    .style(LineStyle::dashed_loose()),
            );
            if let Some(at) = reached.filter(|at| *at > 0.0 && !chart.curves.is_empty()) {
                let line = VLine::new("target reached", at.log10());
                plot.vline(
                    line.color(Color32::from_gray(140))
                        .style(LineStyle::dotted_loose()),
                );
            }
        });
    response
        .response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Error plot"));
}

/// An axis of powers of ten: they are short, and stand close where there are many.
fn axis<'a>(hints: AxisHints<'a>, label: &str) -> AxisHints<'a> {
    hints
        .label(label)
        .formatter(power)
        .label_spacing(Rangef::new(16.0, 30.0))
}

/// Draws it in a window of its own.
pub fn large(ui: &mut Ui, workspace: &mut Workspace) {
    let mut open = workspace.measuring.large;
    if !open {
        return;
    }
    Window::new("Error against time")
        .open(&mut open)
        .default_size([640.0, 440.0])
        .show(ui.ctx(), |ui| {
            let height = (ui.available_height() - 4.0).max(160.0);
            show(ui, workspace, height, true);
        });
    workspace.measuring.large = open;
}

fn draw(plot: &mut egui_plot::PlotUi<'_>, curve: &Curve) {
    let [r, g, b] = curve.color;
    let color = Color32::from_rgb(r, g, b);
    let shown = |p: &&(f64, f64)| p.0 > 0.0 && p.1 > 0.0 && p.1.is_finite();
    let logs: Vec<[f64; 2]> = curve
        .points
        .iter()
        .filter(shown)
        .map(|(x, y)| [x.log10(), y.log10()])
        .collect();
    for end in [0, 1] {
        let edge = curve.band.iter().filter(|(x, y)| *x > 0.0 && y[end] > 0.0);
        let edge: Vec<[f64; 2]> = edge.map(|(x, y)| [x.log10(), y[end].log10()]).collect();
        // Without a name it is not in the legend.
        let line = Line::new("", PlotPoints::from(edge)).id((&curve.label, end));
        let faint = color.gamma_multiply(0.35);
        plot.line(line.color(faint).width(1.0).allow_hover(false));
    }
    plot.line(
        Line::new(curve.label.clone(), PlotPoints::from(logs.clone()))
            .color(color)
            .width(2.0),
    );
    // A curve of one point is no line.
    let last: Vec<[f64; 2]> = logs.last().copied().into_iter().collect();
    plot.points(
        Points::new(curve.label.clone(), PlotPoints::from(last))
            .color(color)
            .radius(3.0),
    );
}

fn guide(plot: &mut egui_plot::PlotUi<'_>, chart: &Chart) {
    let Some([a, b]) = chart.guide() else { return };
    let points = [a, b].map(|(x, y)| [x.log10(), y.log10()]).to_vec();
    plot.line(
        Line::new("slope −1/2", PlotPoints::from(points))
            .color(Color32::from_gray(128))
            .style(LineStyle::dotted_dense())
            .allow_hover(false),
    );
}

/// Lines at 1, 2, 3 … 9 times powers of ten, and thicker ones at these.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let mut marks = Vec::new();
    // Bounds without any point are wide beyond use.
    let first = low.floor().max(-40.0) as i32;
    let last = high.ceil().min(40.0) as i32;
    for decade in first..=last {
        for step in 1..10u8 {
            let value = f64::from(decade) + f64::from(step).log10();
            // Marks beyond the ends would have their names drawn beside the plot.
            if (low..=high).contains(&value) {
                let step_size = if step == 1 { 1.0 } else { 0.1 };
                marks.push(GridMark { value, step_size });
            }
        }
    }
    marks
}

/// Names of powers of ten.
fn power(mark: GridMark, _: &RangeInclusive<f64>) -> String {
    if (mark.value - mark.value.round()).abs() > 1e-6 {
        return String::new();
    }
    number(10f64.powf(mark.value.round()))
}

fn number(x: f64) -> String {
    if (1e-3..1e4).contains(&x) {
        format!("{}", (x * 1e6).round() / 1e6)
    } else {
        format!("{x:.0e}")
    }
}

/// What is told under the pointer.
fn hover(at: &HoverPosition<'_>, along: &str) -> Option<String> {
    let (name, position) = match at {
        HoverPosition::NearDataPoint {
            plot_name,
            position,
            ..
        } => (*plot_name, position),
        HoverPosition::Elsewhere { position } => ("", position),
    };
    let (x, error) = (10f64.powf(position.x), 10f64.powf(position.y));
    let line = format!("{x:.3} {along}\nerror {:.3} %", error * 100.0);
    Some(match name {
        "" => line,
        name => format!("{name}\n{line}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_have_names_and_nothing_else_has() {
        let marks = decades(GridInput {
            bounds: (-1.2, 0.7),
            base_step_size: 0.01,
        });
        let range = -1.2..=0.7;
        let names: Vec<String> = marks.iter().map(|m| power(*m, &range)).collect();
        let named: Vec<&String> = names.iter().filter(|n| !n.is_empty()).collect();
        assert_eq!(named, ["0.1", "1"]);
        // 0.07, 0.08, 0.09, nine of 0.1 … 0.9, and 1 … 5.
        assert_eq!(marks.len(), 17);
    }

    #[test]
    fn hovering_tells_name_place_and_error() {
        let at = HoverPosition::NearDataPoint {
            plot_name: "path",
            position: egui_plot::PlotPoint::new(1.0, -2.0),
            index: 0,
        };
        let text = hover(&at, "seconds").expect("a text");
        assert_eq!(text, "path\n10.000 seconds\nerror 1.000 %");
    }
}
