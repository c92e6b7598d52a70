//! The look: egui's two themes, calmed down.

use egui::{Color32, Context, CornerRadius, Frame, Margin, Stroke, Theme, Ui, Visuals};

/// Sets sizes and colours of both themes, once.
pub fn apply(context: &Context) {
    context.style_mut_of(Theme::Dark, |style| style.visuals = dark());
    context.style_mut_of(Theme::Light, |style| style.visuals = light());
    context.all_styles_mut(|style| {
        style.spacing.item_spacing = egui::vec2(8.0, 6.0);
        style.spacing.interact_size.y = 22.0;
        style.spacing.slider_width = 130.0;
        style.spacing.combo_width = 150.0;
        style.spacing.indent = 10.0;
        style.interaction.tooltip_delay = 0.4;
    });
}

/// Switches to the theme that is chosen.
pub fn follow_theme(ui: &Ui, dark: bool) {
    let wanted = if dark { Theme::Dark } else { Theme::Light };
    if ui.ctx().theme() != wanted {
        ui.ctx().set_theme(wanted);
        ui.ctx().request_repaint();
    }
}

fn dark() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = Color32::from_gray(30);
    visuals.window_fill = Color32::from_gray(34);
    visuals.extreme_bg_color = Color32::from_gray(20);
    visuals.override_text_color = Some(Color32::from_gray(208));
    accent(&mut visuals, Color32::from_rgb(52, 92, 132));
    visuals
}

fn light() -> Visuals {
    let mut visuals = Visuals::light();
    visuals.panel_fill = Color32::from_gray(244);
    // Text fields are white: they must stand out.
    visuals.window_fill = Color32::from_gray(240);
    visuals.override_text_color = Some(Color32::from_gray(40));
    accent(&mut visuals, Color32::from_rgb(168, 204, 236));
    visuals
}

fn accent(visuals: &mut Visuals, color: Color32) {
    visuals.selection.bg_fill = color;
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, visuals.faint_bg_color);
    for widget in [
        &mut visuals.widgets.inactive,
        &mut visuals.widgets.hovered,
        &mut visuals.widgets.active,
        &mut visuals.widgets.open,
    ] {
        widget.corner_radius = CornerRadius::same(4);
    }
}

/// The slim line below the picture.
pub fn status_frame(ui: &Ui) -> Frame {
    Frame::new()
        .fill(ui.visuals().panel_fill)
        .inner_margin(Margin::symmetric(10, 3))
}

/// The ground of labels that lie on the picture.
pub fn overlay_frame() -> Frame {
    Frame::new()
        .fill(Color32::from_black_alpha(190))
        .corner_radius(CornerRadius::same(4))
        .inner_margin(Margin::symmetric(8, 4))
}
