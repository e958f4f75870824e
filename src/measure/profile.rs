//! Where the engine's time goes: stages by the clock, rays by kind, lanes in use. One thread.

use crate::progressive::Params;
use crate::trace::{PixelBatch, PixelGrouping, RayCounts, ReuseGroup, Scratch, Stage, Tracer};
use std::time::{Duration, Instant};

/// What a few passes took.
#[derive(Clone, Debug)]
pub struct Profile {
    /// How many paths shared.
    pub group: ReuseGroup,
    /// Camera paths.
    pub paths: u64,
    /// All of the time, dealing and adding up included.
    pub time: Duration,
    /// By stage, in the order of [`Stage::ALL`].
    pub stages: [StageCost; Stage::ALL.len()],
    /// Rays and pairs.
    pub counts: RayCounts,
    /// Paths that a register holds.
    pub width: usize,
}

/// What a stage took.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageCost {
    /// Its time.
    pub time: Duration,
    /// Members of batches that had part in it.
    pub members: u64,
    /// Lanes of the registers that they were in.
    pub lanes: u64,
}

impl Profile {
    /// Of `passes` passes with these parameters; `None` where the engine does not trace them.
    pub fn new(params: &Params, passes: u64) -> Option<Profile> {
        let tracer = params.tracer();
        let group = params.decide_group().ok()?;
        let width = params.scene.isa().width();
        let (counts, stages) = (RayCounts::default(), Default::default());
        let time = Duration::ZERO;
        let mut profile = Profile { group, paths: 0, time, stages, counts, width };
        let mut scratch = tracer.scratch();
        let mut batch = PixelBatch::default();
        let begin = Instant::now();
        for pass in 0..passes {
            let grouping = PixelGrouping::new(params.size, params.seed, pass, group);
            let [columns, rows] = grouping.batches();
            for at in (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y])) {
                grouping.batch(at, &mut batch);
                profile.watch(&tracer, &batch, pass, &mut scratch);
                profile.paths += batch.pixels.len() as u64;
            }
        }
        profile.time = begin.elapsed();
        profile.counts = scratch.counts;
        (profile.counts.nearest > 0).then_some(profile)
    }

    /// A stage's part of the time.
    pub fn share(&self, stage: usize) -> f64 {
        self.stages[stage].time.as_secs_f64() / self.time.as_secs_f64().max(f64::MIN_POSITIVE)
    }
}

impl Profile {
    /// Takes note of what a batch's stages take.
    fn watch(&mut self, tracer: &Tracer, batch: &PixelBatch, pass: u64, scratch: &mut Scratch) {
        let mut last = Instant::now();
        tracer.watch_batch(batch, pass, scratch, &mut |stage, members| {
            let now = Instant::now();
            let cost = &mut self.stages[stage as usize];
            cost.time += now - last;
            cost.members += members as u64;
            cost.lanes += members.next_multiple_of(self.width) as u64;
            last = now;
        });
    }
}
