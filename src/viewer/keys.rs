//! The one table of what can be done by key: shortcuts, tooltips and the help are made from it.

use crate::viewer::settings::Switching;
use burnish::brdf::Model;
use burnish::scene::builtin::Example;
use egui::os::OperatingSystem;
use egui::{Context, Key, KeyboardShortcut, ModifierNames, Modifiers};

/// Something a key or a button does at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Action {
    Model(Model),
    Smoother,
    Rougher,
    Pause,
    Restart,
    Save,
    SaveScene,
    Sheet,
    Open,
    Browse,
    Reload,
    Frame,
    Home,
    Whole,
    CopyCamera,
    CopyCommand,
    Brighter,
    Darker,
    Compare,
    Tag,
    Lobes,
    Pixel,
    Errors,
    CopyPicture,
    Layer,
    HidePanel,
    TurnUp,
    Zoom,
    FullScreen,
    Undo,
    Redo,
    Help,
    Dismiss,
    Quit,
    /// Writes or copies what a panel has ready to export. It has buttons of its own and
    /// no key.
    Export,
    /// Goes on with the picture in the file that is compared with. It has a button under "Compare".
    Resume,
    /// Opens a shipped scene, or one of those opened last by its place among them. The menu of scenes has
    /// them.
    OpenExample(&'static Example),
    OpenRecent(usize),
    /// Other workers: their number, 0 for one a core.
    Threads(usize),
    /// Whether changed files are read again.
    Watch(bool),
    /// Settings for pictures that are left for others.
    Switching(Switching),
}

/// One line of the table.
pub(super) struct Binding {
    pub(super) action: Action,
    /// Any of these does it; the first is the one that tooltips name.
    pub(super) keys: &'static [KeyboardShortcut],
    /// The word on its button.
    pub(super) name: &'static str,
    /// A few words for the help.
    pub(super) does: &'static str,
    /// A sentence that describes it.
    pub(super) tip: &'static str,
}

const fn plain(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}
const fn shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}
const fn command(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}
const fn command_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

/// In the order of the help.
pub(super) const TABLE: &[Binding] = &[
    Binding {
        action: Action::Model(Model::Phong),
        keys: &[plain(Key::Num1)],
        name: "Phong",
        does: "Model: Phong",
        tip: "Phong's cosine-power distribution, exponent a_p, with Beckmann's rational shadowing.",
    },
    Binding {
        action: Action::Model(Model::Beckmann),
        keys: &[plain(Key::Num2)],
        name: "Beckmann",
        does: "Model: Beckmann",
        tip: "Gaussian slopes of width alpha: short tails, a compact highlight.",
    },
    Binding {
        action: Action::Model(Model::Ggx),
        keys: &[plain(Key::Num3)],
        name: "GGX",
        does: "Model: GGX",
        tip: "Walter et al. 2007: the same width alpha, but long tails: a highlight with glow.",
    },
    Binding {
        action: Action::Smoother,
        keys: &[plain(Key::OpenBracket)],
        name: "Smoother",
        does: "Smoother",
        tip: "Divides the roughness alpha by 2^(1/4); four presses halve it.",
    },
    Binding {
        action: Action::Rougher,
        keys: &[plain(Key::CloseBracket)],
        name: "Rougher",
        does: "Rougher",
        tip: "Multiplies the roughness alpha by 2^(1/4); four presses double it.",
    },
    Binding {
        action: Action::Pause,
        keys: &[plain(Key::Space)],
        name: "Pause",
        does: "Pause or resume",
        tip: "Stops tracing; nothing is lost. Again to go on.",
    },
    Binding {
        action: Action::Restart,
        keys: &[plain(Key::R)],
        name: "Restart",
        does: "Restart from the first pass",
        tip: "Throws the passes away and starts again from the first.",
    },
    Binding {
        action: Action::Save,
        keys: &[plain(Key::S), command(Key::S)],
        name: "Snapshot",
        does: "Snapshot as PNG and OpenEXR",
        tip: "Writes what is shown as PNG, its radiance as OpenEXR, into the working directory.",
    },
    Binding {
        action: Action::SaveScene,
        keys: &[command_shift(Key::S)],
        name: "Save scene",
        does: "Save the edited scene",
        tip: "Writes the scene with its edited materials, camera and size as a new .scn file beside \
              the old one; a scene that comes with burnish goes into the working directory. No file \
              is overwritten.",
    },
    Binding {
        action: Action::Sheet,
        keys: &[shift(Key::S)],
        name: "Contact sheet",
        does: "Contact sheet of models and roughnesses",
        tip: "Traces what is shown with every model and with roughness alpha 0.05, 0.1, 0.2, 0.4 and 0.8, \
              each picture within 320 x 240 pixels to a relative error of at most 3 %, and writes all of \
              them, labelled, as one PNG, and their radiance as OpenEXR, to where snapshots go. The \
              picture waits meanwhile, unless it is changed. Again, or Escape, stops it: then nothing is \
              written.",
    },
    Binding {
        action: Action::Open,
        keys: &[command(Key::O)],
        name: "Open",
        does: "Open a scene",
        tip: "Opens a scene: .scn, .obj or .ply. Dropping a file on the window does the same.",
    },
    Binding {
        action: Action::Browse,
        keys: &[command_shift(Key::O)],
        name: "Browse",
        does: "Open by the file dialog",
        tip: "Opens a scene that you choose in the desktop's file dialog.",
    },
    Binding {
        action: Action::Reload,
        keys: &[plain(Key::F5)],
        name: "Reload",
        does: "Read the scene again",
        tip: "Reads the scene's file again. A camera that was moved stays; edits of materials go.",
    },
    Binding {
        action: Action::TurnUp,
        keys: &[plain(Key::U)],
        name: "Turn up",
        does: "Another axis of a model points up",
        tip: "Stands a model that was opened by itself on its next axis: x, y, z, -x, -y, -z. Scenes \
              are Z up and stay.",
    },
    Binding {
        action: Action::Frame,
        keys: &[plain(Key::F)],
        name: "Frame",
        does: "Frame the selected surfaces or the scene",
        tip: "Moves the camera until the surfaces of the selected material are seen, or without one the \
              whole scene, in the same direction. A camera in a closed room stays in it.",
    },
    Binding {
        action: Action::Home,
        keys: &[plain(Key::Home)],
        name: "Home",
        does: "Camera as in the scene file",
        tip: "Puts the camera back where the scene file has it.",
    },
    Binding {
        action: Action::Whole,
        keys: &[plain(Key::W)],
        name: "Whole picture",
        does: "The whole picture again",
        tip: "Ends the crop that a Ctrl-drag over the picture made: traces all that the camera sees.",
    },
    Binding {
        action: Action::CopyCamera,
        keys: &[plain(Key::V)],
        name: "Copy",
        does: "Copy the camera line",
        tip: "Copies the camera as a line for a .scn file.",
    },
    Binding {
        action: Action::CopyCommand,
        keys: &[shift(Key::V)],
        name: "Copy command",
        does: "Copy the command line",
        tip: "Copies the command that makes this picture again without a window, with as many \
              passes as it has. Edited materials go with it as a scene file.",
    },
    Binding {
        action: Action::Darker,
        keys: &[shift(Key::E)],
        name: "Darker",
        does: "Exposure down",
        tip: "Exposure 1/2 stop down. Changes what is shown, not what is traced.",
    },
    Binding {
        action: Action::Brighter,
        keys: &[plain(Key::E)],
        name: "Brighter",
        does: "Exposure up",
        tip: "Exposure 1/2 stop up. Changes what is shown, not what is traced.",
    },
    Binding {
        action: Action::Compare,
        keys: &[plain(Key::C)],
        name: "Compare",
        does: "Compare two pictures, or not",
        tip: "Lays two pictures against each other: models, roughnesses, a tag, or a file. What they \
              are is under \"Compare\" in the side panel.",
    },
    Binding {
        action: Action::Tag,
        keys: &[plain(Key::T)],
        name: "Tag",
        does: "Tag the picture as it is",
        tip: "Keeps the picture as it is now, to compare others with. The next tag replaces it.",
    },
    Binding {
        action: Action::Lobes,
        keys: &[plain(Key::L)],
        name: "Lobes",
        does: "The lobes' curves, or not",
        tip: "Opens or closes the section in which D, G1 and the lobes of the three models are drawn.",
    },
    Binding {
        action: Action::Pixel,
        keys: &[plain(Key::P)],
        name: "Pixel",
        does: "What the clicked pixel is made of, or not",
        tip: "Opens or closes the section that tells of the pixel last clicked.",
    },
    Binding {
        action: Action::Errors,
        keys: &[plain(Key::G)],
        name: "Error over time",
        does: "The error over time, or not",
        tip: "Opens or closes the section that draws how the relative error fell, of all pictures of \
              this view.",
    },
    Binding {
        action: Action::Layer,
        keys: &[plain(Key::M)],
        name: "Map",
        does: "Picture, noise map, sample map",
        tip: "Shows the picture, then the relative standard error of its pixels, then their samples, \
              and the picture again.",
    },
    Binding {
        action: Action::CopyPicture,
        keys: &[command(Key::C)],
        name: "Copy picture",
        does: "Copy the picture",
        tip: "Copies the picture as it is shown, 8 bits a channel, to the clipboard.",
    },
    Binding {
        action: Action::HidePanel,
        keys: &[plain(Key::N)],
        name: "Hide panel",
        does: "Picture alone, or with the panel",
        tip: "Hides the side panel and the status line, or shows them again.",
    },
    Binding {
        action: Action::Zoom,
        keys: &[plain(Key::Z)],
        name: "Fit or 1:1",
        does: "Fit the picture, or 1:1",
        tip: "Fits the picture to the window, or shows one pixel as one pixel of the screen.",
    },
    Binding {
        action: Action::FullScreen,
        keys: &[plain(Key::F11)],
        name: "Full screen",
        does: "Full screen, the picture alone",
        tip: "Fills the screen with the picture, or goes back. N shows the panel there, too.",
    },
    Binding {
        action: Action::Undo,
        keys: &[command(Key::Z)],
        name: "Undo",
        does: "Undo",
        tip: "Takes back the last change of anything that can be set. A whole drag is one change.",
    },
    Binding {
        action: Action::Redo,
        keys: &[command_shift(Key::Z), command(Key::Y)],
        name: "Redo",
        does: "Redo",
        tip: "Takes back the last undo.",
    },
    Binding {
        action: Action::Help,
        keys: &[plain(Key::Questionmark), plain(Key::F1)],
        name: "Help",
        does: "This help",
        tip: "Shows or hides the list of keys.",
    },
    Binding {
        action: Action::Dismiss,
        keys: &[plain(Key::Escape)],
        name: "Dismiss",
        does: "Dismiss what stands over the picture",
        tip: "Closes the help or the line of the path, stops a contact sheet, takes the message away, \
              leaves the full screen, the picture alone or the comparison, lets go of the selected \
              material: the first of these that there is.",
    },
    Binding {
        action: Action::Quit,
        keys: &[command(Key::Q)],
        name: "Quit",
        does: "Close the window",
        tip: "Closes the window. Colours, curve, goal and recent scenes are remembered.",
    },
];

/// Actions of the mouse over the picture, for the help.
pub(super) const MOUSE: &[(&str, &str)] = &[
    ("Left drag", "Orbit about the surface under the pointer"),
    ("Middle or Shift drag", "Pan the camera"),
    ("Wheel", "Dolly: nearer or farther"),
    ("Ctrl-drag", "Crop: trace only that part, at the full size"),
    ("Click", "Pick the material, or all"),
    ("Ctrl-wheel", "Zoom the picture"),
    ("Right drag", "Move the zoomed picture"),
    ("Drag the bar", "Wipe between two pictures that are compared"),
    ("Hold X", "See the second picture, where they flip"),
];

/// Actions of the arrow keys while the picture has the focus (Tab), for the help.
pub(super) const PICTURE_KEYS: &[(&str, &str)] = &[
    ("Arrows", "Orbit the camera"),
    ("Shift-arrows", "Pan the camera"),
    ("Page up, page down", "Dolly: nearer or farther"),
];

/// The line of an action. Every action has one; a test keeps it so.
pub(super) fn binding(action: Action) -> &'static Binding {
    TABLE.iter().find(|b| b.action == action).unwrap_or(&TABLE[0])
}

/// All keys of a binding, as this system writes them: "S, Ctrl+S".
pub(super) fn keys_text(ctx: &Context, binding: &Binding) -> String {
    // Modifiers by name, but "[" and not "OpenBracket".
    let names = ModifierNames { is_short: true, ..ModifierNames::NAMES };
    let mac = matches!(ctx.os(), OperatingSystem::Mac | OperatingSystem::IOS);
    let keys: Vec<String> = binding.keys.iter().map(|k| k.format(&names, mac)).collect();
    keys.join(", ")
}

/// The sentence and the key.
pub(super) fn tooltip(ctx: &Context, action: Action) -> String {
    let binding = binding(action);
    format!("{}\nKey: {}", binding.tip, keys_text(ctx, binding))
}

/// Takes the actions asked for by key out of the input. None while text is being typed, no Space while
/// it would press the focused widget, and no Escape that closes a menu or leaves a text, `typed` in the
/// frame before.
pub(super) fn pressed(ctx: &Context, picture_has_focus: bool, typed: bool) -> Vec<Action> {
    let mut actions = Vec::new();
    let typing = ctx.text_edit_focused();
    let elsewhere = typed || egui::Popup::is_any_open(ctx);
    let focused = ctx.memory(|m| m.focused().is_some()) && !picture_has_focus;
    let mut bindings: Vec<(&KeyboardShortcut, Action)> =
        TABLE.iter().flat_map(|b| b.keys.iter().map(|k| (k, b.action))).collect();
    // egui ignores further modifiers, so the longer combination has to be asked for first.
    let held = |k: &KeyboardShortcut| {
        u8::from(k.modifiers.shift) + u8::from(k.modifiers.command || k.modifiers.ctrl)
    };
    bindings.sort_by_key(|(k, _)| std::cmp::Reverse(held(k)));
    ctx.input_mut(|input| {
        // The system's copy comes as an event of its own.
        let copies = input.events.iter().filter(|e| matches!(e, egui::Event::Copy)).count();
        if !typing && copies > 0 {
            input.events.retain(|e| !matches!(e, egui::Event::Copy));
            actions.extend(std::iter::repeat_n(Action::CopyPicture, copies));
        }
        for (shortcut, action) in bindings {
            let alone = !shortcut.modifiers.command && shortcut.logical_key != Key::F11;
            // A text that is being typed has an undo of its own.
            let of_text = alone || matches!(action, Action::Undo | Action::Redo);
            if elsewhere && action == Action::Dismiss {
                continue;
            }
            if (typing && of_text) || (focused && shortcut.logical_key == Key::Space) {
                continue;
            }
            // Where frames are slow, one may bring several presses.
            let times = input.count_and_consume_key(shortcut.modifiers, shortcut.logical_key);
            actions.extend(std::iter::repeat_n(action, times));
        }
    });
    actions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_does_two_things() {
        let all: Vec<KeyboardShortcut> = TABLE.iter().flat_map(|b| b.keys).copied().collect();
        for (i, key) in all.iter().enumerate() {
            assert!(!all[..i].contains(key), "{key:?} is bound twice");
        }
    }

    #[test]
    fn every_model_has_its_digit_in_the_order_of_the_buttons() {
        for (model, digit) in Model::ALL.into_iter().zip([Key::Num1, Key::Num2, Key::Num3]) {
            let binding = binding(Action::Model(model));
            assert_eq!((binding.action, binding.name), (Action::Model(model), model.title()));
            assert_eq!(binding.keys, [plain(digit)]);
        }
    }
}
