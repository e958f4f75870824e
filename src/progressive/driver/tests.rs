//! Pictures that are left and come back to, beside each other and in the background.

use super::Driver;
use crate::brdf::{Model, Roughness};
use crate::progressive::control::Shared;
use crate::progressive::mailbox::Mailbox;
use crate::progressive::turn::{Role, Turn};
use crate::progressive::work::Workers;
use crate::progressive::{Options, Params, Session, Snapshot, State, render};
use crate::scene::{Camera, Material, SceneBuilder};
use crossbeam_channel::bounded;
use glam::DVec3;
use std::sync::Arc;
use std::time::{Duration, Instant};

const LIMIT: u64 = 90;

/// A number that has nothing to do with those before it (Steele et al. 2014, SplitMix64).
fn hash(n: u64, stream: u64) -> u64 {
    let z = (n ^ stream << 32).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A glossy ball in the corner of a room with an emitter: some cells are much noisier than others.
fn params() -> Params {
    let mut b = SceneBuilder::new("corner");
    let wall = Material::reflecting("wall", [0.6, 0.5, 0.4], [0.0; 3], 1.0).unwrap();
    let wall = b.material(wall);
    b.cuboid(DVec3::new(-3.0, -3.0, -1.0), DVec3::new(6.0, 6.0, 4.0), wall).unwrap();
    let ball = Material::reflecting("ball", [0.1; 3], [0.7; 3], 60.0).unwrap();
    let ball = b.material(ball);
    b.sphere(DVec3::new(0.4, 0.3, 0.0), 1.0, ball).unwrap();
    let emitter = b.material(Material::light("lamp", [30.0; 3]).unwrap());
    b.sphere(DVec3::new(-1.7, -0.6, 2.2), 0.2, emitter).unwrap();
    b.camera = Some(Camera::look_at(DVec3::new(0.0, -2.9, 0.6), DVec3::Y, 1.1).unwrap());
    b.screen = [70, 50];
    Params::new(Arc::new(b.build()))
}

fn options(keep: u64) -> Options {
    Options { threads: 2, preview: true, interval: Duration::ZERO, keep }
}

/// What has not come by then never comes, however much else the machine has to do.
const PATIENCE: Duration = Duration::from_secs(900);

/// The first snapshot of the epoch that is like that.
fn wait_for(session: &Session, epoch: u64, like: impl Fn(&Snapshot) -> bool) -> Snapshot {
    let start = Instant::now();
    loop {
        if let Ok(snapshot) = session.snapshots().recv_timeout(Duration::from_secs(1))
            && snapshot.epoch == epoch
            && like(&snapshot)
        {
            return snapshot;
        }
        assert!(start.elapsed() < PATIENCE, "never came");
    }
}

/// The finished picture, of which this is the newest snapshot so far.
fn finish(session: &Session, so_far: Snapshot) -> Snapshot {
    match so_far.state {
        State::Done => so_far,
        _ => wait_for(session, so_far.epoch, |s| s.state == State::Done),
    }
}

fn same(a: &Snapshot, b: &Snapshot) -> bool {
    a.mean() == b.mean()
        && a.standard_error() == b.standard_error()
        && a.samples() == b.samples()
        && (a.passes, a.counts.paths, a.group) == (b.passes, b.counts.paths, b.group)
}

fn variants() -> Vec<Params> {
    let params = params();
    let rough = |alpha| params.clone().with_roughness(Roughness::from_alpha(alpha).unwrap());
    let models = Model::ALL.map(|model| Params { model, ..params.clone() });
    models.into_iter().chain([rough(0.07), rough(0.61)]).collect()
}

#[test]
fn a_picture_that_was_left_goes_on_as_if_it_had_not_been() {
    let variants = variants();
    let session =
        Session::with_options(variants[0].clone(), LIMIT, options(1 << 30), || {}).unwrap();
    // Left at moments that have nothing to do with passes; some in the middle of a tile.
    for turn in 0..60u64 {
        let which = hash(turn, 7) as usize % variants.len();
        session.set(variants[which].clone()).unwrap();
        std::thread::sleep(Duration::from_micros(hash(turn, 8) % 12_000));
    }
    for params in &variants {
        let epoch = session.set(params.clone()).unwrap();
        let finished = wait_for(&session, epoch, |s| s.state == State::Done);
        let plain = render(params.clone(), LIMIT, 1).unwrap();
        let samples = plain.samples();
        assert!(samples.iter().max() > samples.iter().min(), "tiles have all alike to do");
        assert!(same(&finished, &plain), "{:?}", params.model);
    }
    assert_eq!(session.kept().pictures, variants.len() as u64 - 1);
}

#[test]
fn a_picture_seen_before_is_there_at_once_and_not_traced_again() {
    let variants = variants();
    let session =
        Session::with_options(variants[0].clone(), LIMIT, options(1 << 30), || {}).unwrap();
    let first = wait_for(&session, session.epoch(), |s| s.state == State::Done);
    let other = session.set(variants[1].clone()).unwrap();
    wait_for(&session, other, |s| s.state == State::Done);
    let epoch = session.set(variants[0].clone()).unwrap();
    assert!(epoch > other);
    // The very first snapshot of it, whatever its state.
    let back = wait_for(&session, epoch, |_| true);
    assert!(same(&back, &first));
    assert_eq!(back.dirty.len(), back.tiles.len(), "all of it is to be shown");
    assert!(same(&finish(&session, back), &first), "and there it stays");
    // Started again it has to come back the long way.
    session.set_limit(1);
    let again = session.restart();
    assert_eq!(wait_for(&session, again, |s| s.state == State::Done).passes, 1);
    session.set_limit(LIMIT);
    assert!(same(&wait_for(&session, again, |s| s.passes == LIMIT), &first));
}

#[test]
fn without_memory_for_it_nothing_is_kept() {
    let variants = variants();
    let session = Session::with_options(variants[0].clone(), 8, options(0), || {}).unwrap();
    let first = wait_for(&session, session.epoch(), |s| s.state == State::Done);
    for params in [&variants[1], &variants[0]] {
        session.set_limit(1);
        let epoch = session.set(params.clone()).unwrap();
        assert_eq!(wait_for(&session, epoch, |s| s.state == State::Done).passes, 1);
        session.set_limit(8);
        let done = wait_for(&session, epoch, |s| s.passes == 8);
        assert!(params.model != variants[0].model || done.mean() == first.mean());
    }
    assert_eq!(session.kept(), Default::default());
}

#[test]
fn memory_stays_within_its_bound_over_a_thousand_switches() {
    let base = params();
    // A pixel of a film has 96 bytes and more; three pictures and a bit have room.
    let bound = 3 * base.bytes() + base.bytes() / 2;
    let session = Session::with_options(base.clone(), 2, options(bound), || {}).unwrap();
    let mut most = 0;
    for turn in 0..1000u64 {
        // Ever new ones, and now and then one that was seen.
        let alpha = 0.01 + 0.9 * (hash(turn / 2, 3) % 997) as f64 / 997.0;
        let params = base.clone().with_roughness(Roughness::from_alpha(alpha).unwrap());
        let epoch = session.set(params).unwrap();
        if turn % 3 == 0 {
            wait_for(&session, epoch, |s| s.passes > 0);
        }
        let kept = session.kept();
        assert!(kept.bytes <= bound, "{kept:?} of {bound}");
        most = most.max(kept.pictures);
    }
    assert!(most >= 2, "nothing was kept: the test tests nothing");
    session.set_keep(0);
    let start = Instant::now();
    while session.kept().pictures > 0 {
        assert!(start.elapsed() < PATIENCE, "memory that is given back");
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn memory_is_given_back_while_there_is_nothing_else_to_do() {
    let variants = variants();
    let session =
        Session::with_options(variants[0].clone(), LIMIT, options(1 << 30), || {}).unwrap();
    wait_for(&session, session.epoch(), |s| s.state == State::Done);
    let epoch = session.set(variants[1].clone()).unwrap();
    wait_for(&session, epoch, |s| s.state == State::Done);
    assert_eq!(session.kept().pictures, 1);
    // Whoever is done waits by now, or is about to.
    std::thread::sleep(Duration::from_millis(50));
    session.set_keep(0);
    let start = Instant::now();
    while session.kept().pictures > 0 {
        assert!(start.elapsed() < PATIENCE, "memory that is given back");
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn others_are_refined_while_there_is_nothing_else_to_do() {
    let variants = variants();
    let session =
        Session::with_options(variants[0].clone(), LIMIT, options(1 << 30), || {}).unwrap();
    session.set_background(variants[1..3].to_vec());
    let start = Instant::now();
    wait_for(&session, session.epoch(), |s| s.state == State::Done);
    while session.kept().pictures < 2 {
        assert!(start.elapsed() < PATIENCE, "they are not refined");
        std::thread::sleep(Duration::from_millis(1));
    }
    for params in &variants[1..3] {
        let epoch = session.set(params.clone()).unwrap();
        let at_once = wait_for(&session, epoch, |_| true);
        let plain = render(params.clone(), at_once.passes, 1).unwrap();
        assert!(at_once.passes > 0, "not one pass");
        assert!(at_once.mean() == plain.mean(), "at {} passes", at_once.passes);
        let finished = finish(&session, at_once);
        assert!(same(&finished, &render(params.clone(), LIMIT, 1).unwrap()));
    }
}

#[test]
fn two_pictures_beside_each_other_keep_step() {
    let variants = variants();
    let session =
        Session::with_options(variants[0].clone(), LIMIT, options(1 << 30), || {}).unwrap();
    let number = session.set_beside(Some(variants[1].clone())).unwrap();
    let (mut shown, mut beside) = (0, 0);
    let mut last: Option<Snapshot> = None;
    let start = Instant::now();
    while shown < LIMIT || beside < LIMIT {
        assert!(start.elapsed() < PATIENCE, "{shown} and {beside} passes");
        if let Some(snapshot) = session.latest() {
            shown = snapshot.passes;
        }
        if let Some(snapshot) = session.latest_beside() {
            assert_eq!(snapshot.epoch, number);
            beside = snapshot.passes;
            last = Some(snapshot);
        }
        std::thread::yield_now();
    }
    assert!(same(&last.unwrap(), &render(variants[1].clone(), LIMIT, 1).unwrap()));
    // One for the other: both are there at once.
    let epoch = session.set(variants[1].clone()).unwrap();
    let number = session.set_beside(Some(variants[0].clone())).unwrap();
    assert_eq!(wait_for(&session, epoch, |_| true).passes, LIMIT);
    let start = Instant::now();
    let beside = loop {
        match session.latest_beside() {
            Some(snapshot) if snapshot.epoch == number => break snapshot,
            _ => assert!(start.elapsed() < PATIENCE),
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    assert!(same(&beside, &render(variants[0].clone(), LIMIT, 1).unwrap()));
    // None beside itself.
    session.set_beside(Some(variants[1].clone())).unwrap();
    session.set_beside(None).unwrap();
}

/// A picture that turns out larger than was thought, or for which another has to go, would else be
/// traced again and again for nothing.
#[test]
fn what_cannot_be_kept_is_not_traced_in_the_background_again() {
    let mut b = SceneBuilder::new("so bright that sums are wide");
    b.environment = [1e5; 3];
    b.screen = [40, 30];
    let params = Params::new(Arc::new(b.build()));
    let other = Params { model: Model::Phong, ..params.clone() };
    let shared = Arc::new(Shared::new(params.clone(), 64, options(0)));
    let outlets = [(); 2].map(|()| {
        let (sender, receiver) = bounded(1);
        Mailbox::new(sender, receiver, Box::new(|| ()))
    });
    let mut driver = Driver::new(Workers::new(options(0), shared, outlets).unwrap(), None);
    driver.at.passes = 64;
    assert!(params.bytes_after(64) > params.bytes() + params.bytes() / 2);
    let turn = Turn { role: Role::Background, epoch: 2, orders: 0 };
    let guess = params.bytes();
    driver.cache.set_limit(guess + guess / 8);
    assert!(driver.cache.has_room_for(&params), "the guess has room");
    driver.in_the_background(turn, params.clone());
    assert_eq!(driver.cache.size(), [0, 0], "and what comes of it has not");
    assert!(driver.useless == [params.clone()]);
    // Room for one of two: the second takes the first one's.
    driver.useless.clear();
    driver.cache.set_limit(params.bytes_after(64) + guess / 8);
    driver.in_the_background(turn, params.clone());
    assert!(driver.useless.is_empty() && driver.cache.passes(&params) == 64);
    driver.in_the_background(turn, other.clone());
    assert!(driver.useless == [other], "it has put the first one out");
}
