//! Everything that a key or a button does. Keys, names and tooltips stand in one table, from
//! which menus and the help overlay are made.

use egui::{Key, KeyboardShortcut, Modifiers};

/// An action of the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Command {
    /// Ask for a scene, a state or a screenshot.
    Open,
    /// Show the embedded scenes.
    Gallery,
    /// Read the scene again.
    Reload,
    /// Save the picture as PNG under a new name.
    SavePng,
    /// Save all layers as EXR under a new name.
    SaveExr,
    /// Ask for a name and save.
    SaveAs,
    /// Save the whole window as PNG.
    SaveWindow,
    /// Copy the picture to the clipboard.
    Copy,
    /// Undo.
    Undo,
    /// Redo.
    Redo,
    /// The view the scene opens with.
    Home,
    /// Pause or go on.
    Pause,
    /// The whole picture.
    Whole,
    /// One component alone.
    Solo(usize),
    /// All components side by side.
    Grid,
    /// What a medium scatters alone.
    Volume,
    /// Luminance as colours.
    FalseColor,
    /// A third of a stop brighter.
    Brighter,
    /// A third of a stop darker.
    Darker,
    /// Exposure from the picture.
    AutoExposure,
    /// The next tone map.
    NextToneMap,
    /// Show the values under the cursor.
    Inspector,
    /// The whole picture again, after a look at its pixels.
    ZoomOut,
    /// Show or hide the plot of errors.
    ErrorPlot,
    /// Show or hide the panel.
    Panel,
    /// Light or dark.
    Theme,
    /// Fill the screen.
    FullScreen,
    /// Show or hide all keys.
    Help,
    /// Close the window.
    Quit,
}

/// A command's name, keys and explanation.
pub struct Binding {
    /// The command.
    pub command: Command,
    /// Keys; any of them.
    pub keys: &'static [KeyboardShortcut],
    /// Name on buttons.
    pub label: &'static str,
    /// One sentence.
    pub doc: &'static str,
}

const fn key(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

const fn ctrl(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

const fn ctrl_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(CTRL_SHIFT, key)
}

const fn bind(
    command: Command,
    keys: &'static [KeyboardShortcut],
    label: &'static str,
    doc: &'static str,
) -> Binding {
    Binding {
        command,
        keys,
        label,
        doc,
    }
}

/// All commands. Where one key is part of another's, the longer one stands first.
pub const TABLE: &[Binding] = &[
    bind(
        Command::Open,
        &[ctrl(Key::O)],
        "Open…",
        "Open a scene, a state or a screenshot.",
    ),
    bind(
        Command::Gallery,
        &[key(Key::G)],
        "Gallery",
        "Choose among the scenes within the program by their pictures.",
    ),
    bind(
        Command::Reload,
        &[key(Key::F5), ctrl(Key::R)],
        "Reload",
        "Read the scene again from its file.",
    ),
    bind(
        Command::SaveAs,
        &[ctrl_shift(Key::S)],
        "Save as…",
        "Choose name and format (PNG, EXR, state) and save.",
    ),
    bind(
        Command::SavePng,
        &[ctrl(Key::S)],
        "Save PNG",
        "Save the picture as it is shown, under a new name in the current folder.",
    ),
    bind(
        Command::SaveExr,
        &[ctrl(Key::E)],
        "Save EXR",
        "Save radiance and all layers, under a new name in the current folder.",
    ),
    bind(
        Command::SaveWindow,
        &[key(Key::F12)],
        "Save window",
        "Save the whole window as PNG, under a new name in the current folder.",
    ),
    bind(
        Command::Copy,
        &[ctrl(Key::C)],
        "Copy picture",
        "Copy the picture, as it is shown, to the clipboard.",
    ),
    bind(
        Command::Redo,
        &[ctrl_shift(Key::Z), ctrl(Key::Y)],
        "Redo",
        "Do again what was undone.",
    ),
    bind(
        Command::Undo,
        &[ctrl(Key::Z)],
        "Undo",
        "Take back the last change of view, settings or display.",
    ),
    bind(
        Command::Home,
        &[key(Key::Home)],
        "Reset view",
        "Return to the view the scene opens with.",
    ),
    bind(
        Command::Pause,
        &[key(Key::Space)],
        "Pause",
        "Stop after the pass under way, keeping all samples; or go on.",
    ),
    bind(
        Command::Whole,
        &[key(Key::Num0)],
        "Whole",
        "Show the whole picture.",
    ),
    bind(
        Command::Solo(0),
        &[key(Key::Num1)],
        "Direct alone",
        "Emitters, and light that scatters once at a diffuse surface.",
    ),
    bind(
        Command::Solo(1),
        &[key(Key::Num2)],
        "Specular alone",
        "What is seen in mirrors and through glass.",
    ),
    bind(
        Command::Solo(2),
        &[key(Key::Num3)],
        "Caustic alone",
        "Light that mirrors or glass throw onto diffuse surfaces.",
    ),
    bind(
        Command::Solo(3),
        &[key(Key::Num4)],
        "Indirect alone",
        "Light that scattered at two diffuse surfaces or more.",
    ),
    bind(
        Command::Grid,
        &[key(Key::Num5)],
        "Side by side",
        "Show all four components at once.",
    ),
    bind(
        Command::Volume,
        &[key(Key::Num6)],
        "Volume alone",
        "Light that fog, smoke or another medium scatters, once or more often.",
    ),
    bind(
        Command::FalseColor,
        &[key(Key::F)],
        "False colour",
        "Show luminance on a scale of colours that colour-blind people can read.",
    ),
    bind(
        Command::Brighter,
        &[key(Key::Plus), key(Key::Equals)],
        "Brighter",
        "Raise the exposure by a third of a stop.",
    ),
    bind(
        Command::Darker,
        &[key(Key::Minus)],
        "Darker",
        "Lower the exposure by a third of a stop.",
    ),
    bind(
        Command::AutoExposure,
        &[key(Key::X)],
        "Auto exposure",
        "Choose the exposure from what is shown.",
    ),
    bind(
        Command::NextToneMap,
        &[key(Key::T)],
        "Next tone map",
        "Try the next tone map.",
    ),
    bind(
        Command::Inspector,
        &[key(Key::I)],
        "Inspector",
        "Show what lies under the cursor: radiance, its standard error (from two independent halves, \
         over the 5 × 5 pixels around), samples, material, normal, depth.",
    ),
    bind(
        Command::ZoomOut,
        &[key(Key::Z)],
        "Zoom out",
        "Show the whole picture again after Ctrl + wheel has magnified its pixels.",
    ),
    bind(
        Command::ErrorPlot,
        &[key(Key::M)],
        "Error plot",
        "Show or hide error against time in a window of its own.",
    ),
    bind(
        Command::Panel,
        &[key(Key::P)],
        "Panel",
        "Show or hide the panel.",
    ),
    bind(
        Command::Theme,
        &[key(Key::L)],
        "Light or dark",
        "Switch between light and dark.",
    ),
    bind(
        Command::FullScreen,
        &[key(Key::F11)],
        "Full screen",
        "Fill the screen, or leave it.",
    ),
    bind(
        Command::Help,
        &[key(Key::F1), key(Key::Questionmark)],
        "Help",
        "Show all keys and what the mouse does.",
    ),
    bind(Command::Quit, &[ctrl(Key::Q)], "Quit", "Close the window."),
];

/// The table's line of a command.
pub fn binding(command: Command) -> &'static Binding {
    let line = TABLE.iter().find(|b| b.command == command);
    line.unwrap_or(&TABLE[0])
}

impl Binding {
    /// The keys as they are printed on the keyboard.
    pub fn key_text(&self) -> String {
        let names = egui::ModifierNames::NAMES;
        let texts: Vec<String> = self.keys.iter().map(|k| k.format(&names, false)).collect();
        texts.join(" or ")
    }

    /// Explanation and keys, for a tooltip.
    pub fn tooltip(&self) -> String {
        format!("{} ({})", self.doc, self.key_text())
    }
}

/// The commands whose keys were pressed; they are taken out of the input.
pub fn pressed(input: &mut egui::InputState) -> Vec<Command> {
    let mut commands = Vec::new();
    for binding in TABLE {
        if binding.keys.iter().any(|key| input.consume_shortcut(key)) {
            commands.push(binding.command);
        }
    }
    // The system's own shortcut for copying arrives as an event of its own.
    if input.events.contains(&egui::Event::Copy) {
        input.events.retain(|event| *event != egui::Event::Copy);
        commands.push(Command::Copy);
    }
    commands
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_belongs_to_one_command_and_none_to_flying() {
        let mut seen: Vec<KeyboardShortcut> = Vec::new();
        for binding in TABLE {
            assert!(!binding.keys.is_empty(), "{}", binding.label);
            for key in binding.keys {
                assert!(!seen.contains(key), "{key:?} stands twice");
                let flies = [Key::W, Key::A, Key::S, Key::D, Key::Q, Key::E];
                let alone = key.modifiers.is_none();
                assert!(!(alone && flies.contains(&key.logical_key)), "{key:?}");
                seen.push(*key);
            }
        }
    }

    #[test]
    fn every_command_is_found_by_its_own_line() {
        for line in TABLE {
            assert_eq!(binding(line.command).label, line.label);
        }
    }
}
