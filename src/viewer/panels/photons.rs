//! What is shown of the photon maps.

use egui::{ComboBox, RichText, Slider, Ui};

use super::inspector::number;
use super::photon_lines::color_of;
use super::widgets;
use crate::engine::integrators::{Params, PhotonView, photon};
use crate::engine::math::Rgb;
use crate::engine::photon::MapKind;
use crate::viewer::display::Shown;
use crate::viewer::photons::{self, Choice, ColorBy, Drawn, Found, Photons};
use crate::viewer::workspace::Workspace;

/// Most photons whose ways are drawn.
const MAX_WAYS: u64 = 1000;
/// Most levels of splitting planes.
const MAX_PLANES: u32 = 10;
/// Largest side of a photon in pixels.
const MAX_SIDE: u32 = 8;

/// Makes what is shown fit for the frame, and lets photons land.
pub fn keep_up(ui: &Ui, workspace: &mut Workspace) {
    if !workspace.photons.choice.is_on() {
        return;
    }
    photons::refresh(workspace);
    let seconds = ui.input(|i| i.stable_dt);
    if workspace.photons.tick(seconds) {
        ui.ctx().request_repaint();
    }
}

/// Draws the section.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let view = workspace.frame.as_ref().and_then(|f| f.photons.clone());
    let Some(view) = view else {
        offer(ui, workspace);
        return;
    };
    points(ui, &mut workspace.photons, &view);
    lines(ui, &mut workspace.photons.choice, &view);
    ui.checkbox(&mut workspace.photons.choice.asks, "Ask by a click")
        .on_hover_text(
            "A click on a surface shows the nearest photons of each map, the disc that holds \
             them, their weights, the estimate, and the rays of a final gather.",
        );
    if workspace.photons.choice.asks {
        match &workspace.photons.found {
            Some(found) => answer(ui, found),
            None => drop(ui.weak("Click a surface of the picture.")),
        }
    }
    if workspace.model.display.shown == Shown::Grid && workspace.photons.choice.is_on() {
        ui.weak("Not drawn while pictures stand side by side.");
    }
}

/// Without photons: how to get some.
fn offer(ui: &mut Ui, workspace: &mut Workspace) {
    let settings = &mut workspace.model.settings;
    if settings.integrator.id == photon::ENTRY.id {
        ui.weak("The photons are on their way.");
        return;
    }
    ui.weak("Photon mapping makes photons that can be seen here.");
    if ui.button("Use photon mapping").clicked()
        && let Some(entry) = crate::engine::integrators::find(photon::ENTRY.id)
    {
        settings.integrator = entry;
        settings.params = Params::defaults(entry.params);
    }
}

fn points(ui: &mut Ui, photons: &mut Photons, view: &PhotonView) {
    let choice = &mut photons.choice;
    ui.horizontal_wrapped(|ui| {
        for (drawn, label, doc) in [
            (Drawn::None, "No photons", "Draw no photons."),
            (
                Drawn::Caustic,
                "Of the caustic map",
                "Photons that mirrors, glass or gloss threw onto diffuse surfaces.",
            ),
            (Drawn::Global, "Of the global map", "All other photons."),
            (
                Drawn::Volume,
                "Of the volume map",
                "Photons where a medium scatters light.",
            ),
            (Drawn::All, "Of all maps", "Those of all maps."),
        ] {
            if drawn == Drawn::Volume && view.map(MapKind::Volume).is_none() {
                continue;
            }
            ui.selectable_value(&mut choice.drawn, drawn, label)
                .on_hover_text(doc);
        }
    });
    if choice.drawn == Drawn::None {
        return;
    }
    color(ui, &mut choice.color);
    ui.horizontal_wrapped(|ui| {
        ui.checkbox(&mut choice.alone, "Without the picture")
            .on_hover_text("Draw the photons on black. Off by default.");
        ui.checkbox(&mut choice.hide, "Hide behind surfaces")
            .on_hover_text("Leave out photons that a surface hides. On by default.");
    });
    ui.add(
        Slider::new(&mut choice.side, 1..=MAX_SIDE)
            .text("Size")
            .suffix(" pixels"),
    )
    .on_hover_text("Side of a photon in pixels of the screen. Default 2.");
    landing(ui, photons);
    for (name, [r, g, b]) in &photons.legend {
        let color = egui::Color32::from_rgb(*r, *g, *b);
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
            ui.painter().rect_filled(rect, 2.0, color);
            ui.label(name).on_hover_text(
                "Paths that begin with these events, or with others of their class.",
            );
        });
    }
}

fn color(ui: &mut Ui, color: &mut ColorBy) {
    let name = |c: ColorBy| match c {
        ColorBy::Power => "power",
        ColorBy::Direction => "direction",
        ColorBy::Class => "class",
    };
    let combo = ComboBox::from_label("Photon colour")
        .selected_text(name(*color))
        .show_ui(ui, |ui| {
            for c in [ColorBy::Power, ColorBy::Direction, ColorBy::Class] {
                ui.selectable_value(color, c, name(c));
            }
        });
    combo.response.on_hover_text(
        "Colour by power, by the direction a photon came from (x, y, z as red, green, blue), or by \
         the class of its path. Default power.",
    );
}

fn landing(ui: &mut Ui, photons: &mut Photons) {
    let all = photons.count();
    let mut landed = photons.landed();
    ui.horizontal(|ui| {
        let slider = Slider::new(&mut landed, 0..=all.max(1))
            .logarithmic(true)
            .text("Landed");
        let moved = ui.add(slider).on_hover_text(format!(
            "How many of the {all} photons are drawn, in an order mixed from the tree's."
        ));
        if moved.changed() {
            photons.choice.landed = (landed < all).then_some(landed);
            photons.choice.landing = false;
        }
    });
    let label = if photons.choice.landing {
        "Stop"
    } else {
        "Let them land"
    };
    let doc = "Draw the photons one by one, then faster and faster.";
    if ui.button(label).on_hover_text(doc).clicked() {
        let landing = !photons.choice.landing;
        if landing && photons.choice.landed.is_none() {
            photons.choice.landed = Some(0);
        }
        photons.choice.landing = landing;
    }
}

fn lines(ui: &mut Ui, choice: &mut Choice, view: &PhotonView) {
    let map = match choice.map() {
        MapKind::Caustic => "caustic",
        MapKind::Global => "global",
        MapKind::Volume => "volume",
    };
    let doc = format!(
        "Draw the ways of the first photons of the {map} map from their light to where they end."
    );
    widgets::number(ui, "Ways", &doc, &mut choice.ways, |drag| {
        drag.range(0..=MAX_WAYS).speed(0.2).suffix(" photons")
    });
    let doc = format!("Levels of the planes by which the kd-tree of the {map} map splits space.");
    ui.add(
        Slider::new(&mut choice.planes, 0..=MAX_PLANES)
            .text("Splitting planes")
            .suffix(" levels"),
    )
    .on_hover_text(doc);
    if let Some(cache) = view.cache() {
        let label = format!("Cache records ({})", cache.records().len());
        ui.checkbox(&mut choice.records, label)
            .on_hover_text("Draw where interpolated gathers were computed and how far they serve.");
    }
}

fn answer(ui: &mut Ui, found: &Found) {
    egui::Grid::new("found").num_columns(2).show(ui, |ui| {
        for (kind, query, photons) in &found.queries {
            let name = match kind {
                MapKind::Caustic => "Caustic map",
                MapKind::Global => "Global map",
                MapKind::Volume => "Volume map",
            };
            ui.label(RichText::new(name).color(color_of(*kind)));
            let counted = photons.iter().filter(|(_, weight)| *weight > 0.0).count();
            ui.label(format!(
                "{counted} of {} photons within {:.4}",
                photons.len(),
                query.radius
            ))
            .on_hover_text("Of those found, the farthest gives the radius and does not count.");
            ui.end_row();
            let weights = query.photons.iter().map(|w| w.density).filter(|d| *d > 0.0);
            let (least, most) =
                weights.fold((f32::INFINITY, 0.0_f32), |(a, b), d| (a.min(d), b.max(d)));
            if most > 0.0 {
                widgets::figure(
                    ui,
                    "kernel weights",
                    format!("{least:.3} to {most:.3} /m²"),
                    "Kernel over the disc's area, of the photons that count.",
                );
            }
            widgets::figure(
                ui,
                "estimate",
                radiance(query.radiance),
                "Radiance toward the eye.",
            );
        }
        let met = found.rays.iter().filter(|ray| ray.end.is_some()).count();
        ui.label(RichText::new("Gather").color(egui::Color32::from_rgb(120, 220, 140)));
        ui.label(format!("{} rays, {met} met a surface", found.rays.len()));
        ui.end_row();
        widgets::figure(
            ui,
            "gathered",
            radiance(found.gathered),
            "Indirect radiance toward the eye that the gather rays bring, both maps read where \
             they end.",
        );
    });
}

fn radiance(rgb: Rgb) -> String {
    rgb.to_array()
        .map(|x| number(x).trim().to_owned())
        .join(" ")
}
