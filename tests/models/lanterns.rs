//! The scene `lights.scn`: a hall with two hundred bulbs on five strings, no two of one power.

use super::arithmetic::exp;
use std::fmt::Write;

const STRINGS: u32 = 5;
const BULBS: u32 = 40;
/// Half the hall's width, and its length towards the camera and away from it.
const HALF: f64 = 3.0;
/// Colours of the bulbs as a share of the brightest channel.
const COLOURS: [[f64; 3]; 6] = [
    [1.0, 0.62, 0.28],
    [1.0, 0.44, 0.12],
    [1.0, 0.74, 0.46],
    [1.0, 0.10, 0.05],
    [0.10, 0.34, 1.0],
    [0.12, 1.0, 0.22],
];

/// What does not repeat.
const HALL: &str = "\
# A hall with two hundred bulbs on five strings: the strongest has 150 times the power of the weakest.
# Each point sees all of them and is lit by a few: the pictures differ by how a light is chosen to be asked.
# Made by tests/models.
caption Two hundred bulbs of unequal power: which of them is asked for light decides how noisy the picture is

screen 800 600
camera 0 -7.4 1.65  0.36 x 87

# Walls, plaster
brdf 0.62 0.57 0.50  0 0 0  1
box -3.1 -8 0  0.1 16 4.4
box 3 -8 0  0.1 16 4.4
box -3 8 0  6 0.1 4.4
box -3 -8.1 0  6 0.1 4.4
# Ceiling, dark blue
brdf 0.12 0.15 0.26  0 0 0  1
box -3 -8 4.4  6 16 0.1
# Floor, polished stone
brdf 0.16 0.14 0.13  0.10 0.10 0.10  500
box -3 -8 -0.1  6 16 0.1

# Three balls: a mirror, brass, red lacquer
brdf 0 0 0  0.93 0.93 0.93  20000
sphere -1.05 -2.6 0.62  0.62
brdf 0 0 0  0.91 0.74 0.46  300
sphere 0.95 -1.6 0.75  0.75
brdf 0.50 0.04 0.03  0.06 0.06 0.06  1500
sphere 0.15 -3.1 0.36  0.36

";

/// The whole file.
pub(crate) fn lights() -> String {
    let mut scene = HALL.to_owned();
    scene += "# Columns, white marble\nbrdf 0.72 0.71 0.69  0.04 0.04 0.04  200\n";
    for string in 0..STRINGS {
        for x in [-HALF + 0.35, HALF - 0.35] {
            line(&mut scene, format_args!("cylinder {x} {} 0  0 0 4.4  0.2", at(string)));
        }
    }
    for string in 0..STRINGS {
        line(&mut scene, format_args!("\n# String {}", string + 1));
        for bulb in 0..BULBS {
            // From column to column, hanging through as a parabola.
            let across = (f64::from(bulb) + 0.5) / f64::from(BULBS) * 2.0 - 1.0;
            let (x, z) = (across * (HALF - 0.55), 2.75 + 1.0 * across * across);
            let [size, power, colour] = [0, 1, 2].map(|i| even(3 * (string * BULBS + bulb) + i));
            // Radii from 2.8 to 5.6 cm; radiance over a range of 75, as many in each octave.
            let radius = 0.028 * (1.0 + size);
            let radiance = 1.1 * exp(4.32 * power);
            let [r, g, b] = COLOURS[(colour * 5.999) as usize].map(|c| c * radiance);
            line(&mut scene, format_args!("light {r:.3} {g:.3} {b:.3}"));
            line(&mut scene, format_args!("sphere {x:.4} {:.3} {z:.4}  {radius:.4}", at(string)));
        }
    }
    scene
}

/// Where a string hangs, along the hall.
fn at(string: u32) -> f64 {
    -2.8 + 2.4 * f64::from(string)
}

/// Numbers that are spread over 0..1 without a pattern (SplitMix64's scrambling).
fn even(i: u32) -> f64 {
    let mut x = u64::from(i + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

fn line(scene: &mut String, text: std::fmt::Arguments) {
    writeln!(scene, "{text}").unwrap();
}
