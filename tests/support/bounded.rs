//! Time and memory of what reads a file, held to bounds.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part

use peak_alloc::PeakAlloc;
use std::process::Command;
use std::time::{Duration, Instant};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// What any reader may take whatever comes, and for each byte of its input.
pub const FREE: usize = 2 << 20;
pub const EACH: usize = 64;

/// What this thread has had of a processor, where the system tells.
pub fn worked() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}

/// Does this within a second and so many bytes, which are counted for the whole process: nothing else may run in
/// it. On a machine that is busy with other things it is done again and the thread's own time counts; what hangs is
/// slow each time.
pub fn bounded<T>(most: usize, file: &[u8], seed: u64, act: impl Fn() -> T) -> T {
    const SECOND: Duration = Duration::from_secs(1);
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let start = Instant::now();
    let mut result = act();
    let mut took = start.elapsed();
    let bytes = MEMORY.peak_usage().saturating_sub(before);
    for _ in 0..4 {
        if took > SECOND {
            let (start, before) = (Instant::now(), worked());
            result = act();
            let own = worked().zip(before).map(|(after, before)| after.saturating_sub(before));
            took = own.unwrap_or(start.elapsed());
        }
    }
    let shown = String::from_utf8_lossy(&file[..file.len().min(4000)]);
    assert!(took <= SECOND, "{took:?} for (seed {seed}) {shown:?}");
    assert!(bytes <= most, "{bytes} bytes of {most} for (seed {seed}) {shown:?}");
    result
}

/// Whether nothing but this test, named by its crate and modules, runs in this process. If there may be others, it
/// is run again in a process of its own, and has to pass there.
pub fn is_alone(test: &str) -> bool {
    const ALONE: &str = "BURNISH_TEST_ALONE";
    if std::env::var_os(ALONE).is_some() {
        return true;
    }
    let (_, name) = test.split_once("::").expect("a crate and a test");
    let mut again = Command::new(std::env::current_exe().unwrap());
    let output = again.args(["--exact", name, "--nocapture"]).env(ALONE, "1").output().unwrap();
    let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    println!("{out}");
    assert!(output.status.success() && out.contains(" 1 passed"), "{out}{err}");
    false
}
