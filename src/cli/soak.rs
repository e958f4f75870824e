//! `burnish soak`: a session under thousands of changes, for hours.

use super::snapshots::next;
use super::{Failure, interrupt, print, say, scene, values};
use burnish::brdf::{Model, Normals, Roughness};
use burnish::progressive::{Options, Params, Session, Snapshot, State, Strategy, render};
use burnish::scene::Camera;
use std::path::Path;
use std::time::{Duration, Instant};

/// Changes everything that can be changed, over and over, as a person would in a window left open
/// for days, and looks at what is held.
///
/// Every change is drawn from --seed: models, roughness, camera, size, strategy, pauses, limits and
/// scenes, most of them faster than a pass. Every so often the picture of the last parameters is
/// compared with the same one rendered afresh, to the bit. Fails if the two differ, if a session
/// fails or does not answer within a minute, or if more memory is held in the end than a tenth above
/// what was held after the first 10,000 changes, each time by one and the same picture. Ctrl-C ends it
/// early, and the figures are printed.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish soak --hours 1
  burnish soak --changes 100000 --seed 7")]
pub(super) struct Args {
    /// For so long.
    #[arg(long, value_name = "H", default_value_t = 1.0)]
    hours: f64,
    /// Largest number of changes.
    #[arg(long, value_name = "N", default_value_t = u64::MAX)]
    changes: u64,
    /// Which of 2^64 series of changes.
    #[arg(long, value_name = "K", default_value_t = 0)]
    seed: u64,
    /// Worker threads; 0 is one a core.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
}

/// Changes between two comparisons, and between two looks at memory, of which the first is taken to be of what
/// has settled.
const COMPARED: u64 = 500;
const TOLD: u64 = 10_000;
/// No picture is larger than this.
const LARGEST: [u32; 2] = [200, 150];
/// Passes of a picture that is compared.
const PASSES: u64 = 3;
/// How long a session may take to answer.
const PATIENCE: Duration = Duration::from_secs(60);
/// Scenes that it changes between.
const SCENES: [&str; 4] = ["default", "cornell", "plates", "lights"];

/// Changes, compares and counts.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let seconds = values::seconds(&(args.hours * 3600.0).to_string()).map_err(Failure::new)?;
    interrupt::listen()?;
    let load = |name: &&str| Ok(Params::new(scene::load(Some(Path::new(name)))?.scene));
    let scenes: Vec<Params> = SCENES.iter().map(load).collect::<Result<_, Failure>>()?;
    let mut random = Random(args.seed);
    let mut params = Params { size: [64, 48], ..scenes[0].clone() };
    // What is held is compared at the largest size there is: more passes of a larger picture hold more.
    let mut measured = Params { size: LARGEST, ..params.clone() };
    let options = Options::interactive(args.threads);
    let session = Session::with_options(params.clone(), 1 << 32, options, || {});
    let session = session.map_err(Failure::new)?;
    let start = Instant::now();
    let (mut changes, mut compared, mut settled, mut most) = (0, 0, None, 0);
    while start.elapsed().as_secs_f64() < seconds && changes < args.changes && !interrupt::came() {
        change(&mut random, &scenes, &session, &mut params)?;
        changes += 1;
        if changes % COMPARED == 0 {
            compare(&session, &mut params, args.threads)?;
            compared += 1;
        }
        most = most.max(held().unwrap_or(0));
        if changes % TOLD == 0 {
            let held = held_by(&session, &mut measured)?;
            settled.get_or_insert(held);
            let minutes = start.elapsed().as_secs_f64() / 60.0;
            say(format_args!("{minutes:.1} min: {changes} changes, {}", mib(held)));
        }
    }
    compare(&session, &mut params, args.threads)?;
    let end = held_by(&session, &mut measured)?;
    let minutes = start.elapsed().as_secs_f64() / 60.0;
    print(format_args!(
        "{changes} changes in {minutes:.1} min, {} pictures equal to fresh ones; memory held: {} at \
         most, {} in the end",
        compared + 1,
        mib(most),
        mib(end)
    ))?;
    match settled {
        Some(before) if before > 0 => {
            let growth = 100.0 * (end as f64 / before as f64 - 1.0);
            print(format_args!("{growth:+.1} % since the first {TOLD} changes ({})", mib(before)))?;
            if growth > 10.0 {
                return Err(Failure::new("more than a tenth more memory is held than at first"));
            }
        }
        _ => say(format_args!("fewer than {TOLD} changes: nothing is said of memory")),
    }
    Ok(())
}

/// One change of everything that a user or a program can change.
fn change(
    random: &mut Random,
    scenes: &[Params],
    session: &Session,
    params: &mut Params,
) -> Result<(), Failure> {
    let below = |random: &mut Random, n: usize| random.below(n as u64) as usize;
    let what = random.below(16);
    match what {
        0 => session.pause(),
        1 => session.resume(),
        2 => session.set_limit(1 + random.below(20)),
        3 => drop(session.snapshots().try_recv()),
        4 => {
            session.restart();
        }
        5 => params.model = Model::ALL[below(random, Model::ALL.len())],
        6 => params.size = LARGEST.map(|side| 1 + random.below(u64::from(side)) as u32),
        7 => params.seed = random.below(1000),
        8 => params.max_depth = [None, Some(1), Some(4)][below(random, 3)],
        9 => params.strategy = Strategy::ALL[below(random, Strategy::ALL.len())],
        10 => params.normals = Normals::ALL[below(random, Normals::ALL.len())],
        11 => {
            let [low, high] = params.scene.bounds();
            let mut at = || low + (high - low) * (random.below(100) as f64 / 100.0);
            let (eye, target) = (at(), (low + high) * 0.5 + (high - low) * 0.01);
            if let Ok(camera) = Camera::look_at(eye, target, 1.0) {
                params.camera = camera;
            }
        }
        12 if random.below(8) == 0 => {
            *params = Params { size: params.size, ..scenes[below(random, scenes.len())].clone() };
        }
        _ => {
            let alpha = 10f64.powf(-4.0 * random.below(1000) as f64 / 1000.0);
            let roughness = Roughness::from_alpha(alpha).map_err(Failure::new)?;
            *params = params.clone().with_roughness(roughness);
        }
    }
    if what < 5 {
        return Ok(());
    }
    session.set(params.clone()).map(drop).map_err(Failure::new)
}

/// Whether the session comes to the picture that a fresh one has.
fn compare(session: &Session, params: &mut Params, threads: usize) -> Result<(), Failure> {
    let last = finished(session, params)?;
    let fresh = render(params.clone(), PASSES, threads).map_err(Failure::new)?;
    if last.mean() != fresh.mean() || last.counts != fresh.counts {
        return Err(Failure::new(format_args!(
            "the picture after the changes is not that of a fresh session: {params:?}"
        )));
    }
    Ok(())
}

/// The picture of these parameters with a seed of its own.
fn finished(session: &Session, params: &mut Params) -> Result<Snapshot, Failure> {
    params.seed += 1;
    session.set_limit(PASSES);
    session.resume();
    let epoch = session.set(params.clone()).map_err(Failure::new)?;
    let start = Instant::now();
    loop {
        match next(session, Duration::from_secs(1))? {
            Some(s) if s.epoch == epoch && s.state == State::Done => return Ok(s),
            _ if start.elapsed() > PATIENCE => {
                return Err(Failure::new("the session does not answer"));
            }
            _ => {}
        }
    }
}

/// Bytes of memory that this process holds with these parameters' picture.
fn held_by(session: &Session, params: &mut Params) -> Result<u64, Failure> {
    finished(session, params)?;
    Ok(held().unwrap_or(0))
}

/// Bytes of memory that this process has asked for and holds now; pages of the program itself, which the system
/// reads when they are first run and drops as it likes, are not among them. Linux alone tells.
fn held() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("RssAnon:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

fn mib(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20))
}

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % n.max(1)
    }
}
