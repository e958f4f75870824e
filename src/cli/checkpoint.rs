//! Experiments kept in a file while they are rendered.

use super::talk::{detail, warning};
use super::{Failure, scene};
use burnish::math::simd::Isa;
use burnish::picture::SaveError;
use burnish::plain;
use burnish::progressive::{Experiment, Goal, Recipe, Session};
use burnish::scene::Axis;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// Writes an experiment now and then.
pub(super) struct Keeper {
    path: PathBuf,
    every: Duration,
    goal: Goal,
    /// When the last one was there.
    last: Instant,
    /// While one is being written.
    told: Option<Receiver<Result<(), SaveError>>>,
}

impl Keeper {
    pub(super) fn new(path: &Path, every: f64, goal: Goal) -> Keeper {
        let every = Duration::from_secs_f64(every);
        Keeper { path: path.to_path_buf(), every, goal, last: Instant::now(), told: None }
    }

    /// Has one written if the last is long enough ago. One that cannot be is tried again later.
    pub(super) fn keep_if_due(&mut self, session: &Session) {
        if let Some(told) = &self.told {
            match told.try_recv() {
                Err(TryRecvError::Empty) => return,
                Ok(Ok(())) => detail(format_args!("checkpoint: {}", plain::path(&self.path))),
                Ok(Err(e)) => warning(format_args!("no checkpoint: {e}")),
                Err(TryRecvError::Disconnected) => warning("no checkpoint: the render has failed"),
            }
            self.told = None;
            self.last = Instant::now();
        } else if self.last.elapsed() >= self.every {
            self.begin(session);
        }
    }

    fn begin(&mut self, session: &Session) {
        let (tell, told) = channel();
        let (path, goal) = (self.path.clone(), self.goal.clone());
        session.visit_experiment(move |experiment| {
            experiment.goal = goal;
            // Who asked may have gone.
            let _ = tell.send(experiment.save(&path));
        });
        self.told = Some(told);
    }

    /// Writes the last one.
    pub(super) fn finish(mut self, session: &Session) -> Result<(), Failure> {
        self.begin(session);
        let told = self.told.take().and_then(|told| told.recv().ok());
        match told {
            Some(result) => result.map_err(Failure::new),
            None => Err(Failure::new("no checkpoint: the render has failed")),
        }
    }
}

/// Reads an experiment; errors name the file.
pub(super) fn read(path: &Path) -> Result<Experiment, Failure> {
    Experiment::read(path).map_err(Failure::new)
}

/// The scene of a picture in a file: as it was called when it was begun, if that is known, from here or else
/// from beside the file, unless another place is given; with the instruction set that gives the same bits.
pub(super) fn scene_of(
    recipe: &Recipe,
    called: Option<&str>,
    file: &Path,
    given: Option<&Path>,
) -> Result<scene::Loaded, Failure> {
    let example = recipe.scene.example.as_deref();
    let own = recipe.scene.files.first().map(|own| own.name.as_str());
    let named = called.or(example).or(own).map(Path::new);
    let beside = |name: &Path| file.parent().unwrap_or(Path::new("")).join(name);
    let place = match (given, named) {
        (Some(given), _) => given.to_path_buf(),
        (None, Some(name)) if scene::is_there(name) => name.to_path_buf(),
        (None, Some(name)) if beside(name).exists() => beside(name),
        (None, name) => {
            let name = name.map_or(String::new(), |name| format!(", {},", plain::path(name)));
            let file = plain::path(file);
            let text = format!("{file}: its scene{name} is not there; say where by --scene");
            return Err(Failure::new(text));
        }
    };
    let isa = (recipe.isa == Isa::Portable.name()).then_some(Isa::Portable);
    let up = recipe.scene.up.as_deref();
    let up = up.and_then(|up| Axis::ALL.into_iter().find(|axis| axis.name() == up));
    scene::load_for(Some(&place), isa, up)
}
