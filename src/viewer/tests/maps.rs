//! Noise map and sample map.

use super::*;
use crate::viewer::document::comparison::Layout;
use crate::viewer::picture::maps::{Layer, UNKNOWN};
use burnish::film::REL_MSE_FLOOR;

/// Saturation and luminance of a code, 0 to 1: the map's colours differ from a picture's.
fn luminance(c: Color32) -> f32 {
    let [r, g, b, _] = egui::Rgba::from(c).to_array();
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Whether lighter colours stand for larger values: of all pairs of pixels at a distance.
fn is_in_order(codes: &[Color32], values: &[f32]) -> bool {
    assert_eq!(codes.len(), values.len());
    let mut pairs = 0;
    for i in 0..codes.len() - 1000 {
        let j = i + 1000;
        if values[i] > 1.2 * values[j] && codes[i] != codes[j] {
            pairs += 1;
            if luminance(codes[i]) <= luminance(codes[j]) {
                return false;
            }
        }
    }
    pairs > 100
}

#[test]
fn the_noise_map_shows_where_the_noise_is_and_the_picture_comes_back() {
    let mut desk = Desk::done(32);
    let picture = desk.shown();
    desk.click_role(Role::Button, "Noise");
    desk.until("a map", |app| app.canvas.is_settled());
    assert_eq!(desk.doc().layer, Layer::Noise);
    let scale = desk.app().canvas.maps.scale().expect("no scale");
    assert!(scale.ends[0] > 1e-5 && scale.ends[1] < 10.0, "{scale:?}");
    assert!(scale.ends[1] / scale.ends[0] <= 1000.0, "{scale:?}");
    // By the formula, from the snapshot.
    let (mean, error) = (desk.newest().mean(), desk.newest().standard_error());
    let relative = |(x, s): (&[f32; 3], &[f32; 3])| {
        let term = |c: usize| s[c].powi(2) / (x[c].powi(2) + REL_MSE_FLOOR as f32);
        ((0..3).map(term).sum::<f32>() / 3.0).sqrt()
    };
    let values: Vec<f32> = mean.pixels.iter().zip(&error.pixels).map(relative).collect();
    let map = desk.shown();
    assert!(is_in_order(&map, &values));
    // Black without noise, at one end; all known.
    let darkest = map[(BACKGROUND[1] * 64.0 + BACKGROUND[0]) as usize];
    assert!(map.iter().all(|&c| luminance(c) >= luminance(darkest) && c != UNKNOWN));
    // What is copied and written is the picture.
    desk.harness.event(Event::Copy);
    desk.harness.step();
    let commands = &desk.harness.output().platform_output.commands;
    let copied = commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyImage(image) => Some(image.pixels.clone()),
        _ => None,
    });
    assert!(copied.expect("nothing on the clipboard") == picture);
    desk.key(Key::M);
    assert_eq!(desk.doc().layer, Layer::Samples);
    desk.key(Key::M);
    desk.until("the picture", |app| app.canvas.is_settled());
    assert!(desk.shown() == picture && desk.app().canvas.maps.scale().is_none());
}

#[test]
fn the_sample_map_shows_where_the_samples_went() {
    let mut desk = Desk::done(64);
    desk.click_role(Role::Button, "Samples");
    desk.until("a map", |app| app.canvas.is_settled());
    let samples: Vec<f32> = desk.newest().samples().iter().map(|&n| n as f32).collect();
    let [least, most] = [f32::min as fn(f32, f32) -> f32, f32::max]
        .map(|f| samples.iter().copied().reduce(f).unwrap());
    assert!(most > 2.0 * least, "the scene has cells that need more: {least} {most}");
    let scale = desk.app().canvas.maps.scale().unwrap();
    assert!(scale.ends[0] <= least && scale.ends[1] >= most, "{scale:?} {least} {most}");
    assert!(is_in_order(&desk.shown(), &samples));
    // The pixel under the pointer is told as before.
    let at = desk.point(RIGHT_BALL);
    desk.harness.hover_at(at);
    desk.harness.run_ok();
    let hover = desk.app().canvas.hover.unwrap();
    assert_eq!(hover.samples as f32, samples[24 * 64 + 42]);
    let words = format!("{} samples", hover.samples);
    assert!(desk.harness.query_by_label_contains(&words).is_some());
}

#[test]
fn noise_that_is_not_known_yet_is_grey() {
    let mut desk = Desk::done(3);
    desk.key(Key::M);
    desk.until("a map", |app| app.canvas.is_settled());
    assert!(desk.shown().iter().all(|&c| c == UNKNOWN));
    desk.document(|d| d.set_limit(8));
    desk.until_done(8);
    desk.until("a map", |app| app.canvas.is_settled());
    assert!(!desk.shown().contains(&UNKNOWN));
}

#[test]
fn two_pictures_have_one_scale_and_a_difference_none() {
    let mut desk = Desk::done(16);
    desk.key(Key::C);
    desk.until("the other model", |app| {
        app.render.as_ref().unwrap().beside().is_some_and(|s| s.passes == 16)
    });
    desk.key(Key::M);
    desk.until("maps", |app| app.canvas.is_settled());
    assert!(desk.app().canvas.maps.scale().is_some());
    // Both are maps: no two textures of that size are of a picture any more.
    let textures = desk.card.0.borrow();
    let maps: Vec<&Vec<Color32>> = textures
        .values()
        .filter(|(width, pixels)| *width == 64 && pixels.len() == 64 * 48)
        .map(|(_, pixels)| pixels)
        .collect();
    assert_eq!(maps.len(), 2);
    let dark = |map: &[Color32]| map[0] == Color32::from_rgb(0x44, 0x01, 0x54);
    assert!(maps.iter().all(|map| dark(map)), "the black background has no noise");
    assert!(maps[0] != maps[1]);
    drop(textures);
    desk.click("Diff");
    desk.harness.run_ok();
    assert_eq!(desk.doc().comparison.layout, Layout::Difference);
    assert!(desk.app().canvas.maps.scale().is_none());
    desk.key(Key::M);
    assert_eq!(desk.doc().layer, Layer::Noise, "it stays");
    assert!(desk.notice().contains("No maps while a difference is shown"), "{}", desk.notice());
    desk.click("Wipe");
    desk.harness.run_ok();
    assert!(desk.app().canvas.maps.scale().is_some());
}
