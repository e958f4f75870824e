//! The `.scn` format: one command a line.

mod args;

use super::files::{FileRecorder, Files};
use super::log::{Errors, Log, ReadError};
use super::{Format, left_out, model, settle, text, title};
use crate::limits::SCREEN_SIDE as MAX_SIDE;
use crate::plain;
use crate::scene::{
    Camera, MAX_COORDINATE, Material, MaterialError, MaterialId, Mesh, Report, SceneBuilder,
    ShapeError, Source,
};
use args::{Args, Problem};
use glam::{DAffine3, DVec3};
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

/// Reads a scene; `name` stands in messages and `files` brings the models.
pub fn read_scn(
    bytes: &[u8],
    name: &Path,
    files: &dyn Files,
) -> Result<(SceneBuilder, Report), ReadError> {
    let log = Log::new(name);
    let text = text::decode(bytes, &log)?;
    let record = FileRecorder::new(name, bytes, files);
    let mut reader = ScnReader {
        builder: SceneBuilder::new(title(name)),
        log,
        files: &record,
        line: 0,
        current: Current::default_material()
            .map_err(|e| ReadError::whole_file(name, e.to_string()))?,
        models: HashMap::new(),
        placed: placed(&text),
        comment: (0, String::new()),
        last: HashMap::new(),
        lines: Vec::new(),
    };
    // Errors do not end it: who mends a file wants to know all of them.
    let mut errors = Errors::default();
    for (number, line) in text::lines(&text) {
        reader.line = number;
        reader.builder.line = Some(number);
        match reader.line(line) {
            Ok(()) => {}
            Err(Problem::Here(text)) => errors.add(reader.log.error(Some(number), text)),
            Err(Problem::Elsewhere(error)) => errors.add(error),
            Err(Problem::Told) => {}
        }
    }
    errors.finish(&reader.log)?;
    let lines = std::mem::take(&mut reader.lines);
    let (mut builder, mut report) = reader.finish()?;
    report.notes.extend(record.remarks());
    builder.source = Source { text: Some(text.into_owned()), lines, ..record.finish() };
    Ok((builder, report))
}

/// How often each model is placed, by the names that the lines give.
fn placed(text: &str) -> HashMap<&str, u64> {
    let mut placed = HashMap::new();
    for (_, line) in text::lines(text) {
        let Some(("mesh", arguments)) = line.trim().split_once(char::is_whitespace) else {
            continue;
        };
        if let Ok(file) = Args::new("mesh", "", arguments).file_name() {
            *placed.entry(file).or_insert(0) += 1;
        }
    }
    placed
}

const CAMERA: &str = "x y z ry ORIENT";

fn camera(args: &mut Args) -> Result<Camera, Problem> {
    let (eye, [ry]) = (args.point()?, args.numbers()?);
    Ok(Camera::new(eye, ry, args.orientation()?)?)
}

/// A camera from its line, with or without the word `camera` before it, such as
/// [`Camera::scn_line`] writes. What would be a warning in a file is an error here.
pub fn parse_camera(text: &str) -> Result<Camera, String> {
    let arguments = text.trim_start();
    let arguments = arguments.strip_prefix("camera ").unwrap_or(arguments);
    let mut args = Args::new("camera", CAMERA, arguments);
    let camera = camera(&mut args).map_err(|problem| match problem {
        Problem::Here(text) => text,
        Problem::Elsewhere(error) => error.to_string(),
        Problem::Told => String::new(),
    })?;
    match args.remarks().into_iter().next() {
        Some(remark) => Err(remark),
        None => Ok(camera),
    }
}

/// What the lines so far have brought.
struct ScnReader<'a> {
    builder: SceneBuilder,
    log: Log,
    files: &'a dyn Files,
    line: usize,
    current: Current,
    /// Every model is read once, however often it is placed; `None` for one that cannot be.
    models: HashMap<String, Option<Rc<Mesh>>>,
    /// How often each is placed.
    placed: HashMap<&'a str, u64>,
    /// The last comment and its line: a material takes its name from the one right above it.
    comment: (usize, String),
    /// The line of each command's last occurrence.
    last: HashMap<&'static str, usize>,
    /// The line of each material in the scene.
    lines: Vec<Option<usize>>,
}

/// The material of the shapes that follow.
struct Current {
    material: Material,
    /// Where it is given; `None` for the default.
    line: Option<usize>,
    /// Its number, once a shape uses it: what no shape uses stays out of the scene.
    id: Option<MaterialId>,
    /// What to say when a shape uses it, and the line that is to blame if it is not the shape's.
    warning: Option<(Option<usize>, String)>,
}

impl Current {
    fn new(material: Material, line: usize) -> Current {
        Current { material, line: Some(line), id: None, warning: None }
    }

    /// The material before any `brdf`.
    fn default_material() -> Result<Current, MaterialError> {
        let material = Material::reflecting("default", [1.0, 0.5, 0.0], [1.0; 3], 1.0)?;
        let text = "no `brdf` or `light` comes before this shape: Kd 1 0.5 0, Ks 1 1 1, a_p 1 is \
                    used";
        let warning = Some((None, text.to_owned()));
        Ok(Current { material, line: None, id: None, warning })
    }
}

/// What a command is called, its arguments, and what it does with them.
type Command<'a> =
    (&'static str, &'static str, fn(&mut ScnReader<'a>, &mut Args) -> Result<(), Problem>);

impl<'a> ScnReader<'a> {
    /// The commands. Arguments in brackets are given all or not at all; `ORIENT` is any number of
    /// `x deg`, `y deg`, `z deg`, `q w x y z` and `a deg ax ay az`.
    const COMMANDS: [Command<'a>; 11] = [
        ("screen", "W H", ScnReader::screen),
        ("camera", CAMERA, ScnReader::camera),
        ("ambient", "r g b", ScnReader::ambient),
        ("brdf", "Kd Kd Kd Ks Ks Ks a_p [Kt Kt Kt ior]", ScnReader::brdf),
        ("light", "r g b", ScnReader::light),
        ("sphere", "cx cy cz r", ScnReader::sphere),
        ("box", "x y z dx dy dz", ScnReader::cuboid),
        ("cylinder", "bx by bz ax ay az r", ScnReader::cylinder),
        ("mesh", "FILE tx ty tz s ORIENT", ScnReader::mesh),
        ("environment", "r g b", ScnReader::environment),
        ("caption", "TEXT", ScnReader::caption),
    ];

    /// The comment on the line above, or else the command and its line.
    fn material_name(&self, command: &str) -> String {
        match &self.comment {
            (line, text) if line + 1 == self.line && !text.is_empty() => {
                text.chars().take(40).collect()
            }
            _ => format!("{command}, line {}", self.line),
        }
    }

    fn line(&mut self, line: &str) -> Result<(), Problem> {
        let line = line.trim();
        if let Some(comment) = line.strip_prefix('#') {
            self.comment = (self.line, comment.trim().to_owned());
            return Ok(());
        }
        let (word, arguments) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        if word.is_empty() {
            return Ok(());
        }
        let Some((name, usage, run)) = Self::COMMANDS.into_iter().find(|c| c.0 == word) else {
            let text = format!("unknown command `{}`: the line is not used", text::shown(word));
            self.log.warn(Some(self.line), text);
            return Ok(());
        };
        let mut args = Args::new(name, usage, arguments);
        let result = run(self, &mut args);
        self.last.insert(name, self.line);
        result.map_err(|problem| match problem {
            Problem::Here(text) => Problem::Here(format!("{name}: {text}")),
            elsewhere => elsewhere,
        })?;
        for text in args.remarks() {
            self.log.warn(Some(self.line), format!("{name}: {text}"));
        }
        Ok(())
    }

    fn screen(&mut self, args: &mut Args) -> Result<(), Problem> {
        let size = args.numbers::<2>()?;
        if size.iter().any(|x| !(1.0..=f64::from(MAX_SIDE)).contains(x) || x.fract() != 0.0) {
            let [w, h] = size.map(plain::number);
            return Err(Problem::Here(format!(
                "width and height must be whole numbers from 1 to {MAX_SIDE}, not {w} {h}"
            )));
        }
        self.builder.screen = size.map(|x| x as u32);
        self.replaces("screen");
        Ok(())
    }

    fn camera(&mut self, args: &mut Args) -> Result<(), Problem> {
        self.builder.camera = Some(camera(args)?);
        self.replaces("camera");
        Ok(())
    }

    /// A path tracer has no ambient light.
    fn ambient(&mut self, args: &mut Args) -> Result<(), Problem> {
        args.numbers::<3>().map(|_| ())
    }

    fn brdf(&mut self, args: &mut Args) -> Result<(), Problem> {
        let (kd, ks, [exponent]) = (args.numbers()?, args.numbers()?, args.numbers()?);
        let name = self.material_name("brdf");
        self.current = Current::new(Material::reflecting(name, kd, ks, exponent)?, self.line);
        if args.more() {
            let (kt, [_ior]) = (args.numbers::<3>()?, args.numbers()?);
            if kt != [0.0; 3] {
                let [r, g, b] = kt;
                let text = format!(
                    "brdf: Kt {r} {g} {b} asks for transmission, which is not modelled: the \
                     surface is opaque"
                );
                self.current.warning = Some((Some(self.line), text));
            }
        }
        Ok(())
    }

    fn light(&mut self, args: &mut Args) -> Result<(), Problem> {
        let name = self.material_name("light");
        self.current = Current::new(Material::light(name, args.numbers()?)?, self.line);
        Ok(())
    }

    fn sphere(&mut self, args: &mut Args) -> Result<(), Problem> {
        let (centre, [radius]) = (args.point()?, args.numbers()?);
        let material = self.material();
        Ok(self.builder.sphere(centre, radius, material)?)
    }

    fn cuboid(&mut self, args: &mut Args) -> Result<(), Problem> {
        let (corner, diagonal) = (args.point()?, args.point()?);
        let material = self.material();
        Ok(self.builder.cuboid(corner, diagonal, material)?)
    }

    fn cylinder(&mut self, args: &mut Args) -> Result<(), Problem> {
        let (base, axis, [radius]) = (args.point()?, args.point()?, args.numbers()?);
        let material = self.material();
        Ok(self.builder.cylinder(base, axis, radius, material)?)
    }

    /// Places a model by T · S(s) · R.
    fn mesh(&mut self, args: &mut Args) -> Result<(), Problem> {
        let file = args.file_name()?;
        if let Some(word) = args.peek().filter(|word| text::leading_number(word).is_none()) {
            return Err(Problem::Here(format!(
                "expected a number for tx, not `{}`; a name with blanks stands in quotes",
                text::shown(word)
            )));
        }
        let (shift, [scale]) = (args.point()?, args.numbers()?);
        let turn = args.orientation()?;
        if shift.abs().max_element() > MAX_COORDINATE {
            return Err(ShapeError::Coordinate(shift.x, shift.y, shift.z).into());
        }
        if !(1.0 / MAX_COORDINATE..=MAX_COORDINATE).contains(&scale.abs()) {
            return Err(Problem::Here(format!(
                "the scale s must be from 1e-18 to 1e18 in size, not {scale}"
            )));
        }
        let format = match Format::of(Path::new(file)) {
            Ok(format) => format,
            Err(text) => {
                let text = format!("mesh: the shape {} is left out: {text}", text::shown(file));
                self.log.warn(Some(self.line), text);
                return Ok(());
            }
        };
        let mesh = self.model(file, format)?;
        let material = self.material();
        let placement = DAffine3::from_scale_rotation_translation(DVec3::splat(scale), turn, shift);
        let counts = self.builder.mesh(&mesh, placement, material)?;
        if let Some(text) = left_out(counts) {
            self.log.warn(Some(self.line), format!("mesh {}: {text}", text::shown(file)));
        }
        Ok(())
    }

    fn environment(&mut self, args: &mut Args) -> Result<(), Problem> {
        self.builder.environment = Material::light("environment", args.numbers()?)?.emission;
        self.replaces("environment");
        Ok(())
    }

    /// What to look for in the scene.
    fn caption(&mut self, args: &mut Args) -> Result<(), Problem> {
        self.builder.caption = Some(args.text()?.chars().take(200).collect());
        self.replaces("caption");
        Ok(())
    }

    /// Says so when a command that counts once is given again.
    fn replaces(&mut self, name: &'static str) {
        if let Some(earlier) = self.last.get(name) {
            let text = format!("{name}: this replaces the one of line {earlier}");
            self.log.warn(Some(self.line), text);
        }
    }

    /// The current material, for a shape that is about to be added.
    fn material(&mut self) -> MaterialId {
        if let Some((line, text)) = self.current.warning.take() {
            self.log.warn(line.or(Some(self.line)), text);
        }
        let (current, builder) = (&mut self.current, &mut self.builder);
        *current.id.get_or_insert_with(|| {
            self.lines.push(current.line);
            builder.material(current.material.clone())
        })
    }

    /// The model of that name. One that cannot be read is told of once.
    fn model(&mut self, file: &str, format: Format) -> Result<Rc<Mesh>, Problem> {
        if let Some(known) = self.models.get(file) {
            return known.as_ref().map(Rc::clone).ok_or(Problem::Told);
        }
        let read = self.read_model(file, format).and_then(|mesh| self.has_room(file, mesh));
        self.models.insert(file.to_owned(), read.as_ref().ok().map(Rc::clone));
        read
    }

    /// A model that there is room for as often as it is placed: known before the first time.
    fn has_room(&self, file: &str, mesh: Mesh) -> Result<Rc<Mesh>, Problem> {
        let times = self.placed.get(file).copied().unwrap_or(1).max(1);
        self.builder.has_room(times, &mesh).map_err(|e| {
            Problem::Here(format!(
                "{} with its {} triangles is placed {times} times: {e}",
                text::shown(file),
                mesh.triangles.len()
            ))
        })?;
        Ok(Rc::new(mesh))
    }

    fn read_model(&mut self, file: &str, format: Format) -> Result<Mesh, Problem> {
        // A path as Windows has it.
        let slashes = || self.files.find(&file.replace('\\', "/"));
        let found = self.files.find(file).or_else(|e| slashes().map_err(|_| e));
        let (path, bytes) = found.map_err(|e| {
            Problem::Here(format!("cannot read the model {}: {e}", text::shown(file)))
        })?;
        let user = self.log.error(Some(self.line), "").place;
        self.log.within(path, |log| model(format, &bytes, log)).map_err(|mut e| {
            e.text = format!("{} (a model of {user})", e.text);
            Problem::Elsewhere(e)
        })
    }

    fn finish(mut self) -> Result<(SceneBuilder, Report), ReadError> {
        if self.last.is_empty() {
            let text = "no command found; expected lines such as `sphere cx cy cz r`";
            return Err(self.log.error(None, text));
        }
        let absent = |name| !self.last.contains_key(name);
        let defaults = [
            (absent("screen"), "no `screen W H`: the picture has 640 by 480 pixels"),
            (absent("camera"), "no `camera`: one that frames the whole scene is used"),
            (self.builder.shapes() == 0, "there is no shape to see"),
            (
                !self.builder.is_lit(),
                "nothing emits light, so the picture will be black: put `light r g b` before a \
                 shape, or add `environment r g b`",
            ),
        ];
        for (_, text) in defaults.into_iter().filter(|(applies, _)| *applies) {
            self.log.warn(None, text);
        }
        settle(&mut self.builder, &mut self.log);
        Ok((self.builder, self.log.finish()))
    }
}
