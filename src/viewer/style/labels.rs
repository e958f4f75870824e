//! The one table of what can be set in the window: the name that each control bears, for screen
//! readers too, and what it does. Tooltips and `CONTROLS.md` are made from it; what has a key
//! as well is in the table of [`keys`](crate::viewer::keys).

/// A control.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Control {
    pub(crate) name: &'static str,
    /// A sentence that describes it, with formula, unit and range where that applies.
    pub(crate) tip: &'static str,
}

const fn control(name: &'static str, tip: &'static str) -> Control {
    Control { name, tip }
}

pub(crate) const ROUGHNESS: Control = control(
    "Roughness",
    "alpha, the width of the distribution of microfacet slopes, and the Phong exponent a_p are two \
     names of one number:\nalpha = sqrt(2 / (a_p + 2))\nKeys: [ and ]",
);
pub(crate) const AS_IN_FILE: Control =
    control("Reset", "Puts the roughness back to the scene file's.");
pub(crate) const ALPHA: Control =
    control("alpha", "Roughness alpha, no unit, 0.0001 (mirror-like) to 1 (dull). Drag or type.");
pub(crate) const A_P: Control =
    control("a_p", "Phong exponent a_p, no unit, 0 (dull) to 2e8 - 2 (mirror-like). Drag or type.");
pub(crate) const APPLIES_TO: Control =
    control("Applies to", "Which materials the slider and the two fields change.");
pub(crate) const ALL: Control = control("All", "Every material that has a specular lobe.");
pub(crate) const PICKED: Control =
    control("Selected", "Click a surface in the picture to pick its material.");
pub(crate) const STOP_AT: Control = control(
    "Stop at",
    "What ends the tracing. Another goal, or a farther one, goes on where it stopped.",
);
pub(crate) const PASS_LIMIT: Control = control(
    "Pass limit",
    "Tracing stops after this many passes; each adds one sample to every pixel, after 16 of \
     them on the mean. 1 to 4294967296. A higher limit goes on where it stopped.",
);
pub(crate) const ERROR_LIMIT: Control = control(
    "Error limit",
    "Tracing stops once the upper 95 % limit of the relative error is at most this, 0.0001 to \
     100 %: sqrt(mean((x - r)\u{b2} / (r\u{b2} + 0.01))), r being the truth. Looked at from 64 \
     passes on.",
);
pub(crate) const TIME_LIMIT: Control = control(
    "Time limit",
    "Tracing stops after this many seconds of tracing, 0.1 to 1e9 s. Pauses are not counted.",
);

pub(crate) const COMPARE_OFF: Control = control("Off", "One picture alone.");
pub(crate) const WIPE: Control =
    control("Wipe bar", "Where one picture ends and the other begins. Drag, or arrow keys.");
pub(crate) const FIRST: Control = control("First", "The picture that the other is compared with.");
pub(crate) const SECOND: Control = control(
    "Second",
    "The other picture. Models and roughnesses are traced in turn with the first, with the same \
     random numbers. What is tagged (T) or read from an OpenEXR file stays as it is; a file counts \
     as exact.",
);
pub(crate) const OTHER_ALPHA: Control = control(
    "Other alpha",
    "Roughness alpha of the second picture, no unit, 0.0001 to 1, of what the slider speaks of.",
);
pub(crate) const MATCH: Control = control(
    "Match",
    "Which alphas the second picture's model has: the same ones, or those at which a property of the \
     lobe is the same. Mean slope: E[tan] of wm under D cos. Half-width: the angle at which D is half \
     of its largest. Albedo: what the lobe reflects with F = 1.",
);
pub(crate) const RESUME: Control = control(
    "Resume the file",
    "Goes on with the picture in the file: its scene, camera, materials and passes. One that      `burnish render --checkpoint` wrote goes on from its sums; another is traced again, to the same      bits.",
);
pub(crate) const SAME_ALPHA: &str = "Same alpha";
pub(crate) const REMAINS: &str = "What remains: half of the integral of |D1 - D2| cos over the \
                                  hemisphere, the part of the microfacet area that faces elsewhere.";
pub(crate) const VERDICT: &str = "By Student's t of each pixel's luminance on the standard errors of \
                                  both pictures, 95 %, corrected for the number of pixels (Benjamini \
                                  and Hochberg 1995). Pictures with common random numbers err alike: \
                                  less is then called significant than is.";

pub(crate) const KEEP: Control = control(
    "Keep",
    "Memory for pictures of models, roughnesses and views that were left, 0 to 1048576 MiB; at first a \
     quarter of the machine's. Back to one of them is its picture at once, which goes on from there.",
);
pub(crate) const HOLD: Control = control(
    "Hold",
    "After a change of model or material the old picture stays until the new one has this many \
     passes, 0 to 64; 0 for its first coarse blocks. What is dragged is seen at once.",
);
pub(crate) const REFINE: Control = control(
    "Refine the other models",
    "Traces the other two models to as many passes while the picture is done or paused.",
);

pub(crate) const SCENES: Control =
    control("Scenes", "Scenes that come with burnish, and below them those opened last.");
pub(crate) const PATH: Control = control(
    "Open scene",
    "Path of a .scn, .obj or .ply file, or the name of a scene that comes with burnish, such as \
     gallery. Enter opens it, Escape leaves.",
);
pub(crate) const OPEN_PATH: Control = control("Open path", "Opens the path that was typed.");
pub(crate) const CANCEL: Control = control("Cancel", "Leaves the scene that is open.");

pub(crate) const KD: Control = control(
    "Kd",
    "Diffuse reflectance, linear Rec. 709, each channel 0 to 1, no unit: f = Kd / pi. What reflects \
     more than arrives is told under \"Scene\".",
);
pub(crate) const KS: Control = control(
    "Ks",
    "Specular reflectance at normal incidence, linear Rec. 709, each channel 0 to 1, no unit: \
     F = Ks + (1 - Ks) (1 - cos)^5. With 0 0 0 there is no specular lobe at all.",
);
pub(crate) const EMISSION: Control = control(
    "Emits",
    "Radiance that leaves every point in every direction, linear Rec. 709, 0 to 1e18 \
     W/(m\u{b2} sr).",
);
pub(crate) const PRESET: Control = control(
    "Preset",
    "Puts measured reflectances, and a roughness that suits them, in the place of the material's. Each \
     entry says its source.",
);
pub(crate) const EXPONENT: Control = control(
    "Exponent",
    "Phong exponent a_p of this material, no unit, 0 (dull) to 2e8 - 2 (mirror-like); \
     alpha = sqrt(2 / (a_p + 2)). Drag or type.",
);
/// Colours are three fields: "Kd red".
pub(crate) const CHANNELS: [&str; 3] = ["red", "green", "blue"];

pub(crate) const LAYER: Control = control(
    "Show",
    "What is shown of the picture. Snapshots and copies are of the picture itself all the same.",
);
pub(crate) const LAYER_PICTURE: Control = control("Picture", "The picture itself.");
pub(crate) const LAYER_NOISE: Control = control(
    "Noise",
    "The relative standard error of each pixel in false colour: sqrt(mean(s\u{b2} / (x\u{b2} + 0.01))) \
     over its channels, s being the standard error of the radiance x in W/(m\u{b2} sr), pooled over \
     touching pixels. Known from 4 passes on.",
);
pub(crate) const LAYER_SAMPLES: Control = control(
    "Samples",
    "How many samples each pixel has, in false colour: after 16 passes more where it is noisier, by \
     cells of 8 x 8 pixels.",
);
pub(crate) const LAYER_NONE: &str =
    "No maps while a difference is shown: it has colours of its own.";

pub(crate) const EXPOSURE: Control = control(
    "Exposure",
    "Shown is radiance times 2^stops. Keys: E and Shift-E. Double-click for 0.",
);
pub(crate) const CURVE: Control = control(
    "Curve",
    "How radiance beyond the screen's white is shown. Of the display and PNG only.",
);
pub(crate) const CAMERA: Control = control("Camera", "Where the scene is seen from.");
pub(crate) const WINDOW: Control = control("Theme", "The colours of the window.");

pub(crate) const SIZE: Control =
    control("Size", "Width and height of the picture in pixels, each 1 to 32768.");
pub(crate) const WIDTH: Control =
    control("Width", "Width of the picture in pixels, 1 to 32768. Drag or type.");
pub(crate) const HEIGHT: Control =
    control("Height", "Height of the picture in pixels, 1 to 32768. Drag or type.");
pub(crate) const PRESETS: Control =
    control("Presets", "Sizes in use, the scene file's, and the one that fills the window.");
pub(crate) const CROP: Control = control(
    "Crop",
    "Which part of the camera's picture is traced, at the full size: drag over the picture with Ctrl to \
     choose one, W for the whole. Its side, and its left and upper edge, in parts of the whole.",
);
pub(crate) const SEED: Control = control(
    "Seed",
    "Picks one of 2^64 independent pictures, 0 to 18446744073709551615: the same seed is the same \
     noise.",
);
pub(crate) const NEXT_SEED: Control =
    control("Next", "The next seed: the same picture with other noise.");
pub(crate) const DEPTH: Control = control(
    "Depth",
    "Largest number of scattering events between camera and light. Fewer is faster, and darker than \
     the truth.",
);
pub(crate) const DEPTH_LIMIT: Control = control(
    "Depth limit",
    "At most this many scattering events, 1 to 1000: 1 is direct light alone.",
);
pub(crate) const THREADS: Control = control(
    "Threads",
    "Worker threads, 0 to 1024; 0 is one a core. A change starts the picture again; its bits are \
     the same with any number.",
);

pub(crate) const ERRATUM: Control = control(
    "Bug",
    "Mistakes of the report and the program that this one grew from, each to be seen by itself: the \
     picture is then wrong on purpose.",
);
pub(crate) const LIGHT: Control =
    control("Light", "How light is found. All three give the same picture with different noise.");
pub(crate) const NORMALS: Control = control(
    "Normals",
    "Which microfacet normals are drawn. Both give the same picture with different noise.",
);

/// Names of sections that are controls as well.
pub(crate) const LOBES: &str = "Lobes";
pub(crate) const PIXEL: &str = "Pixel";
pub(crate) const ERRORS: &str = "Error over time";

pub(crate) const QUANTITY: Control =
    control("Quantity", "What is drawn over the angle, for all three models over each other.");
pub(crate) const AXES: Control = control("Axes", "How the curves are drawn.");
pub(crate) const AXES_CHOICES: [Control; 2] = [
    control("Cartesian", "The value over the angle from the normal."),
    control("Polar", "The value as the distance from the surface's point, in its direction."),
];
pub(crate) const SCALE: Control = control("Scale", "How values are spaced.");
pub(crate) const SCALE_CHOICES: [Control; 2] = [
    control("Linear", "Equal differences of values are equally far apart; from 0."),
    control("Log", "Equal ratios of values are equally far apart; six decades at most."),
];
pub(crate) const LOBE_OF: Control = control("Lobe of", "Which reflectances f has.");
pub(crate) const WHITE: Control =
    control("F = 1", "The specular lobe alone with F = 1: what the models differ in.");
pub(crate) const OF_MATERIAL: Control = control(
    "Material",
    "The selected material's Kd and Ks, by their Rec. 709 luminance, with Schlick's F.",
);
pub(crate) const OF_PIXEL: Control = control(
    "Clicked",
    "The material behind the clicked pixel at the angle from which the pixel sees it; it keeps up \
     with the camera. Moving the slider leaves it.",
);
pub(crate) const THETA_O: Control = control(
    "theta of wo",
    "Angle between the normal and the direction wo to the viewer, 0 to 89 degrees. Drag or type.",
);
pub(crate) const CURVES: Control = control(
    "Lobe curves",
    "Values at the pointer are in the table below. With the focused plot (Tab) the left and right \
     arrows move by 1 degree.",
);
pub(crate) const COPY_CSV: Control =
    control("Copy CSV", "Copies the curves as a table: angle in degrees, and each model's value.");
pub(crate) const SAVE_SVG: Control =
    control("Save SVG", "Writes the plot as an SVG file to where snapshots go.");
pub(crate) const SAVE_PNG: Control = control(
    "Save PNG",
    "Writes the plot as it is on the screen as a PNG file to where snapshots go.",
);

pub(crate) const AGAINST: Control = control(
    "Reference",
    "What the picture's true error is taken against, beside the error that the picture estimates \
     itself. Tags are made by T, files are opened by Ctrl-O or dropped on the window.",
);
pub(crate) const AGAINST_NOTHING: Control = control("None", "Estimates alone.");
pub(crate) const AGAINST_TAG: Control = control(
    "Tag",
    "The picture as it was when it was tagged (T). Its noise counts as error, and what both share \
     does not: the same samples, or random numbers in common.",
);
pub(crate) const AGAINST_FILE: Control = control(
    "File",
    "The OpenEXR picture that is open, of the same size. Its own noise, if it has any, counts as \
     error.",
);
pub(crate) const ERROR_CURVES: Control = control(
    "Error curves",
    "Relative error over seconds of tracing, both logarithmic; pauses and the turns of other pictures \
     are not counted. The shown picture is the bold line, with its 95 % limits; models have the \
     colours of the lobes, other materials and methods are faint, and so is what cannot be relied on \
     yet. Dotted: the true error. With the focused plot (Tab) the left and right arrows move the time.",
);
pub(crate) const ERROR_CSV: Control = control(
    "Copy CSV",
    "Copies all points as a table: picture, estimated or true, seconds, passes, relative error, its \
     95 % limits, and whether it can be relied on.",
);
pub(crate) const ERROR_CAPTION: &str = "Both are sqrt(mean((x - r)\u{b2} / (r\u{b2} + 0.01))) over \
     pixels and channels, x being the picture; r is the truth for the estimate, which is made from the \
     spread of independent replicates, and the reference for the true error. Nothing is subtracted \
     for the reference's own noise: near it the curve flattens.";
pub(crate) const ERROR_TABLE: &str = "Relative error as the picture estimates it, \"?\" while that \
     cannot be relied on, and against the reference; without one, the seconds that the picture was \
     traced for. Those of the newest points, or at the pointer.";

pub(crate) const ASKED: Control = control(
    "Pixel",
    "Which pixel is taken apart, from the top left, from 0. A click in the picture sets it.",
);
pub(crate) const COLUMN: Control =
    control("Column", "Column of the pixel, from 0 at the left. Drag or type.");
pub(crate) const ROW: Control =
    control("Row", "Row of the pixel, from 0 at the top. Drag or type.");
pub(crate) const SAMPLES: Control = control(
    "Samples",
    "By how many samples of the reference tracer the pixel is taken apart, 16 to 65536. Drag or \
     type.",
);
pub(crate) const THETA_I: Control = control(
    "theta of wi",
    "Angle between the normal and the direction wi to the light in the plane of incidence, -89 to \
     89 degrees; below 0 on the viewer's side.",
);
pub(crate) const MIRROR: Control =
    control("Mirror", "The light in the mirror direction, where the half vector is the normal.");
pub(crate) const DRAW_PATH: Control = control(
    "Draw over the picture",
    "Draws the path as a line over the picture, its vertices numbered, thin lines going to lights.",
);

pub(crate) const DIRECTIONS_TIP: &str =
    "Directions sampled from the BRDF, in the local frame of the first surface.";
pub(crate) const BY_EVENT_TIP: &str = "Mean luminance in W/(m\u{b2} sr) by the number of scattering events between camera and light, \
     with half the width of its 95 % interval, from 16 independent randomisations (Student).";
pub(crate) const BY_TECHNIQUE_TIP: &str = "The same light by how it was found: seen by the camera, by sampling a light at a surface, or by \
     a direction sampled from the BRDF that hit a light. With MIS both of the latter are weighted.";
pub(crate) const HISTOGRAM_TIP: &str = "How many samples have which luminance in W/(m\u{b2} sr), over its logarithm, eight steps a decade.";
pub(crate) const BRIGHTEST_TIP: &str =
    "The sample of the greatest luminance, traced again. One such sample in few is a firefly.";
pub(crate) const BETA_TIP: &str =
    "Luminance of the path's throughput beta up to the vertex: the product of f cos / pdf.";
pub(crate) const ADDS_TIP: &str = "Luminance that emission and light sampling at the vertex add to the sample, in W/(m\u{b2} sr).";

pub(crate) const WATCH: Control = control(
    "Read again when it changes",
    "When a file of the scene changes on the disk, the scene is read again. A camera that was moved \
     stays; edits of materials go.",
);

pub(crate) const DISMISS: Control = control("Dismiss", "Takes the message away.");
pub(crate) const CLOSE: Control = control("Close", "Closes the help.");

/// All of them by the part of the window that they are in, as name and words: for `CONTROLS.md`.
#[cfg(test)]
pub(crate) fn table() -> Vec<(&'static str, Vec<(String, String)>)> {
    use crate::viewer::document::comparison::{First, Layout};
    use crate::viewer::document::goal::Stop;
    use crate::viewer::panels::error::Against;
    use crate::viewer::panels::method;
    use crate::viewer::panels::tracing::Depth;
    use crate::viewer::panels::view;
    use crate::viewer::picture::maps::Layer;
    use burnish::{brdf::Normals, measure::lobe::Quantity};
    use burnish::{picture::Curve, progressive::Strategy};
    let line = |c: &Control| (c.name.to_owned(), c.tip.to_owned());
    let choice =
        |of: &Control, name: &str, words: &str| (format!("{}: {name}", of.name), words.to_owned());
    let lines = |controls: &[Control]| controls.iter().map(line).collect::<Vec<_>>();
    let mut first = lines(&[ROUGHNESS, AS_IN_FILE, ALPHA, A_P, APPLIES_TO]);
    first.extend([ALL, PICKED].map(|c| choice(&APPLIES_TO, c.name, c.tip)));
    first.push(line(&STOP_AT));
    first.extend(Stop::ALL.map(|s| {
        let limit = s.limit();
        (format!("{}: {}, {}", STOP_AT.name, s.title(), limit.name), limit.tip.to_owned())
    }));
    first.push(line(&SCENES));

    let mut tracing = lines(&[SIZE, WIDTH, HEIGHT, PRESETS, CROP, SEED, NEXT_SEED, DEPTH]);
    tracing.extend(Depth::ALL.map(|d| choice(&DEPTH, d.title(), d.tip())));
    tracing.extend(lines(&[DEPTH_LIMIT, THREADS]));

    let channels = format!("Three fields: {}.", CHANNELS.join(", "));
    let mut materials = vec![(
        "A material's name".to_owned(),
        "Picks the material, as a click in the picture does; again lets go of it. Its fields are \
         below the list."
            .to_owned(),
    )];
    materials
        .extend([KD, KS, EMISSION].map(|c| (c.name.to_owned(), format!("{} {channels}", c.tip))));
    materials.extend(lines(&[PRESET, EXPONENT]));

    let mut view = vec![line(&LAYER)];
    view.extend(Layer::ALL.map(|l| choice(&LAYER, l.control().name, l.control().tip)));
    view.extend(lines(&[EXPOSURE, CURVE]));
    view.extend(Curve::ALL.map(|c| choice(&CURVE, c.title(), view::describe(c))));
    view.extend(lines(&[CAMERA, WINDOW]));
    view.extend(view::THEMES.map(|(_, name, tip)| choice(&WINDOW, name, tip)));

    let mut method = lines(&[LIGHT]);
    method.extend(Strategy::ALL.map(|s| choice(&LIGHT, s.title(), method::found(s))));
    method.push(line(&NORMALS));
    method.extend(Normals::ALL.map(|n| choice(&NORMALS, n.title(), method::drawn(n, false))));

    let mut compare = vec![line(&COMPARE_OFF)];
    compare.extend(Layout::ALL.map(|l| (l.title().to_owned(), l.tip().to_owned())));
    compare.push(line(&FIRST));
    compare.extend(First::ALL.map(|f| choice(&FIRST, f.title(), f.tip())));
    compare.extend(lines(&[SECOND, OTHER_ALPHA, MATCH, RESUME, WIPE]));

    let mut lobes = lines(&[QUANTITY]);
    lobes.extend(Quantity::ALL.map(|q| choice(&QUANTITY, q.title(), q.describe())));
    let choices: [(Control, &[Control]); 3] = [
        (AXES, &AXES_CHOICES),
        (SCALE, &SCALE_CHOICES),
        (LOBE_OF, &[WHITE, OF_MATERIAL, OF_PIXEL]),
    ];
    for (of, among) in choices {
        lobes.push(line(&of));
        lobes.extend(among.iter().map(|c| choice(&of, c.name, c.tip)));
    }
    lobes.extend(lines(&[THETA_O, CURVES, COPY_CSV, SAVE_SVG, SAVE_PNG]));
    let mut errors = vec![line(&AGAINST)];
    errors.extend(Against::ALL.map(|a| choice(&AGAINST, a.control().name, a.control().tip)));
    errors.extend(lines(&[ERROR_CURVES, ERROR_CSV, SAVE_SVG, SAVE_PNG]));
    let pixel = lines(&[ASKED, COLUMN, ROW, SAMPLES, THETA_I, MIRROR, DRAW_PATH]);

    vec![
        ("First in the panel", first),
        ("Compare", compare),
        (LOBES, lobes),
        (PIXEL, pixel),
        ("Materials", materials),
        ("View", view),
        (ERRORS, errors),
        ("Tracing", tracing),
        ("Kept pictures", lines(&[KEEP, HOLD, REFINE])),
        ("Sampling", method),
        ("Deliberate bugs", vec![line(&ERRATUM)]),
        ("Scene", lines(&[WATCH])),
        ("Open, Ctrl-O", lines(&[PATH, OPEN_PATH, CANCEL])),
        ("Messages and help", lines(&[DISMISS, CLOSE])),
    ]
}
