//! How long the frames of the window take, and what they leave to the workers: printed with `-v`.

use crate::viewer::app::App;
use std::time::{Duration, Instant};

/// A moment on the clock and in the life of this thread.
pub(super) struct Moment {
    clock: Instant,
    /// Time that a processor has spent on this thread, where the system tells.
    spent: Option<Duration>,
}

impl Moment {
    pub(super) fn now() -> Moment {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
        let nanos = text.and_then(|text| text.split_whitespace().next()?.parse().ok());
        Moment { clock: Instant::now(), spent: nanos.map(Duration::from_nanos) }
    }
}

/// Times of frames, by the clock and by the processor.
#[derive(Default)]
pub(super) struct FrameTimes {
    frames: u64,
    /// Time of the app's own work in the present frame: by the clock, and what of it a processor was at
    /// work. The rest is waiting for one that is busy with the workers.
    now: [Duration; 2],
    slowest: [Duration; 2],
    /// Seconds of each frame, by the clock.
    all: Vec<f32>,
    /// With what egui and the graphics driver do.
    whole: f64,
    /// Paths and seconds of tracing when the window had been left alone for a while, and frames.
    calm: Option<(u64, f64, u64)>,
    last: (u64, f64),
    began: Option<Instant>,
}

impl FrameTimes {
    /// Time from the start until the window is taken to be left alone.
    const CALM: Duration = Duration::from_secs(4);

    /// Adds what was done since then to the present frame's.
    pub(super) fn own(&mut self, since: &Moment) {
        let now = Moment::now();
        let clock = now.clock - since.clock;
        let spent = now.spent.zip(since.spent).map_or(clock, |(now, then)| now - then);
        self.now = [self.now[0] + clock, self.now[1] + spent];
    }

    /// Adds a frame's time with all that is not the app's.
    pub(super) fn frame(&mut self, seconds: f32) {
        self.whole += f64::from(seconds);
    }

    /// Ends a frame.
    pub(super) fn end_frame(&mut self, app: &App) {
        let began = *self.began.get_or_insert_with(Instant::now);
        self.frames += 1;
        let work = std::mem::take(&mut self.now);
        self.slowest = [0, 1].map(|i: usize| self.slowest[i].max(work[i]));
        self.all.push(work[0].as_secs_f32());
        if let Some(snapshot) = app.render.as_ref().and_then(|r| r.newest.as_ref()) {
            self.last = (snapshot.counts.paths, snapshot.seconds);
            if self.calm.is_none() && began.elapsed() >= FrameTimes::CALM {
                self.calm = Some((self.last.0, self.last.1, self.frames));
            }
        }
    }

    /// All of it, for `-v`.
    pub(super) fn words(&self) -> String {
        let mut all = self.all.clone();
        all.sort_by(f32::total_cmp);
        let quantile = |part: usize| all.get(all.len() * part / 100).copied().unwrap_or(0.0);
        let mut words = format!(
            "{} frames; own work of one by the clock: {:.2} ms in the middle, {:.2} ms at the 95th \
             percentile, {:.2} ms at the 99th, {:.2} ms at most, of which a processor was at work {:.2} ms at most; with \
             egui's and the graphics driver's: mean {:.1} ms",
            self.frames,
            1e3 * quantile(50),
            1e3 * quantile(95),
            1e3 * quantile(99),
            1e3 * self.slowest[0].as_secs_f64(),
            1e3 * self.slowest[1].as_secs_f64(),
            1e3 * self.whole / self.frames.max(1) as f64,
        );
        if let Some((paths, seconds, frames)) = self.calm {
            let time = self.last.1 - seconds;
            if time > 0.0 {
                words += &format!(
                    "; after {} s: {:.0} paths/s, {:.1} frames/s of tracing",
                    FrameTimes::CALM.as_secs(),
                    self.last.0.saturating_sub(paths) as f64 / time,
                    (self.frames - frames) as f64 / time,
                );
            }
        }
        words
    }
}
