//! The window that shows folders.

use egui::text::{CCursor, CCursorRange};
use egui::{Align2, Button, Key, ScrollArea, TextEdit, Ui, Window};

use crate::viewer::browser::{Browser, Entry, Purpose};
use crate::viewer::measuring::reference::Reference;
use crate::viewer::workspace::{Request, Workspace};

/// Size of the window in points.
const SIZE: [f32; 2] = [520.0, 460.0];

/// Draws it while a file is chosen.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let Some(mut browser) = workspace.browser.take() else {
        return;
    };
    let title = match browser.purpose {
        Purpose::Open => "Open a scene, a state or a screenshot",
        Purpose::Reference => "Open a reference (.exr, .hdr)",
        Purpose::Save => "Save picture (.png, .exr) or state (.json)",
    };
    let mut open = true;
    let mut answer = Answer::None;
    Window::new(title)
        .id(egui::Id::unique("browser"))
        .open(&mut open)
        .collapsible(false)
        .default_size(SIZE)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(ui.ctx().content_rect().center())
        .show(ui.ctx(), |ui| {
            recent(ui, &browser, &workspace.preferences.recent, &mut answer);
            folder(ui, &mut browser);
            list(ui, &mut browser, &mut answer);
            name(ui, &mut browser, &mut answer);
        });
    let escape = ui.input_mut(|i| i.consume_key(egui::Modifiers::NONE, Key::Escape));
    let chosen = match answer {
        Answer::Cancel => return,
        Answer::Accept => browser.accept(false),
        Answer::Replace => browser.accept(true),
        Answer::Path(path) => Some(path),
        Answer::None if !open || escape => return,
        Answer::None => None,
    };
    match chosen {
        Some(path) if browser.purpose == Purpose::Open => {
            workspace.requests.push(Request::Open(path))
        }
        Some(path) if browser.purpose == Purpose::Reference => open_reference(workspace, &path),
        Some(path) => workspace.requests.push(Request::SaveAs(path)),
        None => workspace.browser = Some(browser),
    }
}

fn open_reference(workspace: &mut Workspace, path: &std::path::Path) {
    match Reference::open(path) {
        Ok(reference) => workspace.measuring.set_reference(reference),
        Err(sentence) => workspace.notices.set_error("reference", sentence),
    }
}

/// What the user did.
enum Answer {
    None,
    Accept,
    Replace,
    Cancel,
    Path(std::path::PathBuf),
}

fn recent(ui: &mut Ui, browser: &Browser, recent: &[std::path::PathBuf], answer: &mut Answer) {
    if browser.purpose != Purpose::Open || recent.is_empty() {
        return;
    }
    ui.menu_button("Recent files", |ui| {
        for path in recent {
            if ui.button(path.display().to_string()).clicked() {
                *answer = Answer::Path(path.clone());
            }
        }
    });
}

fn folder(ui: &mut Ui, browser: &mut Browser) {
    ui.horizontal(|ui| {
        if ui
            .button("Up")
            .on_hover_text("The folder that holds this one.")
            .clicked()
        {
            browser.up();
        }
        let label = ui.label("Folder");
        let width = ui.available_width() - 190.0;
        let edit = TextEdit::singleline(&mut browser.folder_text).desired_width(width);
        let response = ui.add(edit).labelled_by(label.id);
        if response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter)) {
            browser.go_to_typed();
        }
        let label = ui.label("Filter");
        let edit = TextEdit::singleline(&mut browser.filter).desired_width(110.0);
        ui.add(edit).labelled_by(label.id);
    });
}

fn list(ui: &mut Ui, browser: &mut Browser, answer: &mut Answer) {
    let entries: Vec<Entry> = browser.visible().cloned().collect();
    let height = (ui.available_height() - 84.0).max(80.0);
    ScrollArea::vertical()
        .auto_shrink(false)
        .max_height(height)
        .show(ui, |ui| {
            for entry in &entries {
                match entry {
                    Entry::Folder(name) => {
                        if ui.selectable_label(false, format!("{name}/")).clicked() {
                            let folder = browser.folder().join(name);
                            browser.go_to(&folder);
                        }
                    }
                    Entry::File(name) => {
                        let row = ui.selectable_label(browser.name == *name, name);
                        if row.clicked() {
                            browser.name.clone_from(name);
                        }
                        if row.double_clicked() {
                            *answer = Answer::Accept;
                        }
                    }
                }
            }
            if entries.is_empty() {
                ui.weak("Nothing here that can be chosen.");
            }
        });
}

fn name(ui: &mut Ui, browser: &mut Browser, answer: &mut Answer) {
    ui.horizontal(|ui| {
        let label = ui.label("Name");
        let edit = TextEdit::singleline(&mut browser.name).desired_width(f32::INFINITY);
        let response = ui.add(edit).labelled_by(label.id);
        if std::mem::take(&mut browser.fresh) {
            response.request_focus();
            select_stem(ui, response.id, &browser.name);
        }
        if response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter)) {
            *answer = Answer::Accept;
        }
    });
    if let Some(error) = &browser.error {
        ui.colored_label(ui.visuals().error_fg_color, error);
    }
    if let Some(path) = &browser.replace {
        ui.horizontal(|ui| {
            ui.label(format!("{} exists.", path.display()));
            if ui.button("Replace it").clicked() {
                *answer = Answer::Replace;
            }
        });
        return;
    }
    ui.horizontal(|ui| {
        let verb = match browser.purpose {
            Purpose::Open | Purpose::Reference => "Open file",
            Purpose::Save => "Save file",
        };
        if ui.add(Button::new(verb)).clicked() {
            *answer = Answer::Accept;
        }
        if ui.button("Cancel").clicked() {
            *answer = Answer::Cancel;
        }
    });
}

/// Selects a proposed name without its extension: what is typed replaces it.
fn select_stem(ui: &Ui, id: egui::Id, name: &str) {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
    let (start, end) = (CCursor::new(0), CCursor::new(stem.chars().count()));
    let range = CCursorRange::two(start, end);
    state.cursor.set_char_range(Some(range));
    state.store(ui.ctx(), id);
}
