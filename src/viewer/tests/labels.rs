//! Every control has a name and words, and `CONTROLS.md` lists them all.

use super::*;
use crate::viewer::keys::{MOUSE, PICTURE_KEYS};
use crate::viewer::style::labels;
use egui_kittest::kittest::NodeT;
use std::collections::HashSet;
use std::fmt::Write;

/// The list of all keys and controls for readers.
const LIST: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/viewer/CONTROLS.md");

fn cell(text: &str) -> String {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    text.replace('|', "\\|").replace('*', "\\*").replace('<', "&lt;")
}

fn rows(text: &mut String, head: [&str; 2], rows: impl IntoIterator<Item = [String; 2]>) {
    let _ = write!(text, "\n| {} | {} |\n| --- | --- |\n", head[0], head[1]);
    for [what, does] in rows {
        let _ = writeln!(text, "| {} | {} |", cell(&what), cell(&does));
    }
}

/// What the file is to be.
fn list() -> String {
    let head = "# Keys and controls of the window\n\n\
                Made from the window's own tables; `UPDATE_CONTROLS=1 cargo test --release --bin burnish \
                lists_every` writes it.\n";
    let mut text = head.to_owned();
    let ctx = egui::Context::default();
    ctx.set_os(egui::os::OperatingSystem::Nix);
    let keys = TABLE.iter().map(|b| {
        let keys = keys::keys_text(&ctx, b).replace('`', "");
        [
            keys.split(", ").map(|k| format!("`{k}`")).collect::<Vec<_>>().join(" "),
            format!("{}. {}", b.does, b.tip),
        ]
    });
    rows(&mut text, ["key", "what it does"], keys);
    let pairs = |pairs: &[(&str, &str)]| {
        pairs.iter().map(|(a, b)| [(*a).to_owned(), (*b).to_owned()]).collect::<Vec<_>>()
    };
    rows(&mut text, ["over the picture", ""], pairs(MOUSE));
    rows(&mut text, ["with the picture focused (Tab)", ""], pairs(PICTURE_KEYS));
    text += "\n## Every control, with its formula and unit\n";
    for (part, controls) in labels::table() {
        rows(&mut text, [part, ""], controls.into_iter().map(|(name, tip)| [name, tip]));
    }
    text
}

#[test]
fn the_list_lists_every_key_and_control() {
    let expected = list();
    if std::env::var_os("UPDATE_CONTROLS").is_some() {
        std::fs::write(LIST, &expected).unwrap();
    }
    let found = std::fs::read_to_string(LIST).unwrap_or_default().replace("\r\n", "\n");
    assert!(found == expected, "{LIST} must be:\n{expected}");
}

/// All words that a control may bear.
fn known(desk: &Desk) -> HashSet<String> {
    let mut known: HashSet<String> = TABLE.iter().map(|b| b.name.to_owned()).collect();
    for (part, controls) in labels::table() {
        known.insert(part.to_owned());
        for (name, _) in controls {
            known.extend(name.split(": ").flat_map(|n| n.split(", ")).map(str::to_owned));
        }
    }
    for colour in [labels::KD, labels::KS, labels::EMISSION] {
        known.extend(labels::CHANNELS.map(|c| format!("{} {c}", colour.name)));
    }
    known.extend(["Checks", "Picture", "Kd colour", "Ks colour"].map(str::to_owned));
    known.extend(desk.doc().params.materials.iter().map(|m| m.name.clone()));
    known
}

#[test]
fn every_control_is_in_the_table() {
    let mut desk = Desk::done(1);
    desk.document(|d| d.pick(Some(0)));
    desk.document(|d| d.clicked = Some([42, 24]));
    // From the foot up: what opens does not move the others' headers away.
    for section in [
        "Checks",
        "Deliberate bugs",
        "Sampling",
        "Kept pictures",
        "Tracing",
        "Pixel",
        "Lobes",
        "Compare",
    ] {
        desk.click_role(Role::Button, section);
        desk.harness.run_ok();
    }
    desk.until("a pixel's report", |app| app.panels.pixel.is_shown());
    desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::O);
    desk.harness.run_ok();
    let known = known(&desk);
    let mut seen = HashSet::new();
    for role in [
        Role::Button,
        Role::CheckBox,
        Role::ComboBox,
        Role::Image,
        Role::RadioButton,
        Role::Slider,
        Role::SpinButton,
        Role::TextInput,
    ] {
        for node in desk.harness.query_all_by_role(role) {
            let node = node.accesskit_node();
            let mut names = vec![node.label().unwrap_or_default()];
            names.extend(node.labelled_by().filter_map(|n| n.value()));
            assert!(names.iter().any(|n| known.contains(n)), "{role:?} {names:?} is in no table");
            seen.extend(names);
        }
    }
    for name in [
        "Width",
        "Seed",
        "Threads",
        "Kd red",
        "Exposure",
        "Bug",
        "Open path",
        "Undo",
        "Keep",
        "Shown",
        "Match",
        "theta of wo",
        "Lobe curves",
        "Copy CSV",
        "Column",
        "theta of wi",
        "Draw over the picture",
    ] {
        assert!(seen.contains(name), "{name} is not in the window: {seen:?}");
    }
    assert_eq!(desk.harness.unnamed_widgets(), Vec::<String>::new());
}
