//! The contact sheet, by one button.

use super::*;
use burnish::brdf::Roughness;
use burnish::picture::{read_exr_part, read_recipe_of};
use burnish::progressive::{Params, Recipe, Sheet, render};

/// Where the button is pressed, and by which key.
fn begun(how: impl FnOnce(&mut Desk)) -> Desk {
    let mut desk = Desk::done(2);
    how(&mut desk);
    desk.harness.step();
    assert!(desk.app().sheet.is_some(), "{}", desk.notice());
    desk
}

/// So large a picture that its sheet is not done in the twinkling of an eye.
fn large(desk: &mut Desk) {
    desk.document(|d| d.params.size = [640, 480]);
    desk.harness.step();
}

fn until_says(desk: &mut Desk, word: &str) {
    desk.until(word, |app| app.notice.as_ref().is_some_and(|n| n.text.contains(word)));
    assert!(desk.app().sheet.is_none());
}

#[test]
fn one_button_makes_two_files_of_what_is_shown_with_its_edits() {
    let mut desk = begun(|desk| {
        // A size that is not the scene's, and one material alone.
        desk.document(|d| d.params.size = [40, 30]);
        desk.document(|d| d.pick(Some(1)));
        desk.click_role(Role::Button, "Contact sheet");
    });
    let params = desk.doc().params.clone();
    desk.until("news of a picture", |app| {
        app.notice.as_ref().is_some_and(|n| n.text.contains("of 15"))
    });
    until_says(&mut desk, "Wrote");
    assert_eq!(desk.files(), ["two_sheet_0001.exr", "two_sheet_0001.png"]);
    let [exr, png] = written(&desk);

    // Every cell is there, by its name, with its recipe, to the error, and not black.
    let mut sheet = Sheet::new(params.clone());
    sheet.materials = vec![1];
    for cell in 0..sheet.len() {
        let name = sheet.name(cell);
        let picture = read_exr_part(&exr, Some(&name)).unwrap().picture;
        assert_eq!([picture.width, picture.height], [40, 30]);
        assert!(picture.pixels.iter().any(|p| p[0] > 0.1), "{name} is black");
        let recipe = read_recipe_of(&exr, Some(&name)).unwrap().unwrap();
        let recipe = Recipe::parse(&recipe.text).unwrap();
        let error = recipe.error.unwrap();
        assert!(error.high.unwrap() <= Sheet::ERROR || recipe.passes == Sheet::MOST_PASSES);
        assert_eq!(recipe.model, sheet.of(cell).unwrap().0.name());
    }
    // One of them is what a render of the edited scene gives.
    let mut own = Params { model: Model::Ggx, ..params };
    std::sync::Arc::make_mut(&mut own.materials)[1].roughness = Roughness::from_alpha(0.8).unwrap();
    let found = read_exr_part(&exr, Some("ggx_alpha_0p8")).unwrap().picture;
    let recipe = read_recipe_of(&exr, Some("ggx_alpha_0p8")).unwrap().unwrap();
    let passes = Recipe::parse(&recipe.text).unwrap().passes;
    assert!(render(own, passes, 1).unwrap().mean() == found);

    let seen = image_size(&png);
    assert!(seen[0] > 5 * 40 && seen[1] > 3 * 30, "{seen:?}");
    // No file is written over.
    desk.key(Key::Space);
    desk.chord(Modifiers::SHIFT, Key::S);
    until_says(&mut desk, "two_sheet_0002.png");
    assert_eq!(desk.files().len(), 4);
}

#[test]
fn a_second_press_or_escape_stops_it_and_nothing_is_written() {
    let presses: [fn(&mut Desk); 2] =
        [|desk| desk.click_role(Role::Button, "Contact sheet"), |desk| desk.key(Key::Escape)];
    for stop in presses {
        let mut desk = begun(|desk| {
            large(desk);
            desk.chord(Modifiers::SHIFT, Key::S);
        });
        desk.until("its first picture", |app| app.sheet.as_ref().is_none_or(|s| s.at > 0));
        assert!(desk.app().sheet.is_some(), "{}", desk.notice());
        stop(&mut desk);
        until_says(&mut desk, "stopped");
        assert_eq!(desk.files(), Vec::<String>::new());
    }
}

/// The picture gives way while the sheet is made, comes back when it is changed, and goes on in the end.
#[test]
fn the_picture_waits_unless_it_is_changed() {
    let mut desk = Desk::done(2);
    desk.document(|d| d.set_limit(1 << 30));
    large(&mut desk);
    desk.chord(Modifiers::SHIFT, Key::S);
    desk.until("a pause", |app| {
        app.render.as_ref().unwrap().newest.as_ref().unwrap().state == State::Paused
    });
    assert!(!desk.doc().paused && desk.app().sheet.is_some());
    let epoch = desk.app().render.as_ref().unwrap().epoch;
    desk.key(Key::Num1);
    desk.until_applied(epoch);
    assert_eq!(desk.app().render.as_ref().unwrap().applied().model, Model::Phong);
    desk.key(Key::Escape);
    until_says(&mut desk, "stopped");
    let passes = desk.newest().passes;
    desk.until("further passes", |app| {
        app.render.as_ref().unwrap().newest.as_ref().unwrap().passes > passes + 2
    });
}

#[test]
fn what_has_no_lobe_has_no_sheet() {
    let scene = "screen 16 12\nenvironment 1 1 1\nbrdf 0.5 0.5 0.5 0 0 0 1\nsphere 0 0 0 1\n";
    let mut desk = Desk::reading(scene);
    desk.until("a picture", |app| app.render.as_ref().is_some_and(|r| r.newest.is_some()));
    desk.click_role(Role::Button, "Contact sheet");
    assert!(desk.app().sheet.is_none() && desk.notice().contains("Ks = 0"), "{}", desk.notice());
}

/// The radiance and the labelled sheet that were written first.
fn written(desk: &Desk) -> [PathBuf; 2] {
    ["exr", "png"].map(|kind| desk.folder.path().join(format!("out/two_sheet_0001.{kind}")))
}

/// Width and height of a PNG file.
fn image_size(path: &Path) -> [u32; 2] {
    let words = burnish::picture::contents(path).unwrap();
    let (width, rest) = words.split_once('x').unwrap();
    let height = rest.split_once(' ').unwrap().0;
    [width, height].map(|side| side.parse().unwrap())
}
