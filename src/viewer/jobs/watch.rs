//! Looks after the files of the open scene, and tells when they have changed.

use egui::Context;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, SystemTime};

/// Time from one look to the next. A file is done with once two looks find it the same.
const PERIOD: Duration = Duration::from_millis(250);

/// A file and what its folder says of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stamp {
    path: PathBuf,
    /// When it was last written, and its length; `None` for a file that is not there.
    state: Option<(SystemTime, u64)>,
}

impl Stamp {
    pub(crate) fn of(path: &Path) -> Stamp {
        let state = fs::metadata(path).and_then(|m| Ok((m.modified()?, m.len()))).ok();
        Stamp { path: path.to_path_buf(), state }
    }

    pub(crate) fn is_of(&self, path: &Path) -> bool {
        self.path == path
    }
}

/// A thread that looks at files until this is dropped.
pub(crate) struct Watch {
    changed: Receiver<()>,
    /// More files for the thread, which ends when its other end finds that this is gone.
    more: Sender<Vec<Stamp>>,
}

impl Watch {
    /// Begins to wait until the files differ from what they were. `None` without files, or where
    /// no thread can be had: then F5 is left.
    pub(crate) fn start(ctx: &Context, known: Vec<Stamp>) -> Option<Watch> {
        if known.is_empty() {
            return None;
        }
        let (notify, changed) = channel();
        let (more, added) = channel();
        let ctx = ctx.clone();
        let look = move || {
            look_after(known, &added, || {
                let heard = notify.send(()).is_ok();
                ctx.request_repaint();
                heard
            });
        };
        std::thread::Builder::new().name("watch".to_owned()).spawn(look).ok()?;
        Some(Watch { changed, more })
    }

    /// Looks after these files, too. What is known of others stays.
    pub(crate) fn add(&self, files: Vec<Stamp>) {
        // Without the thread nothing is looked after any more.
        let _ = self.more.send(files);
    }

    /// Whether the files have changed since this was last asked.
    pub(crate) fn poll(&self) -> bool {
        self.changed.try_iter().count() > 0
    }
}

/// Calls `notify` after each change, until it returns false, or the sender of `added` is
/// gone.
fn look_after(mut known: Vec<Stamp>, added: &Receiver<Vec<Stamp>>, notify: impl Fn() -> bool) {
    let mut before = Vec::new();
    loop {
        match added.recv_timeout(PERIOD) {
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
            Ok(files) => {
                for file in files {
                    if !known.iter().any(|k| k.path == file.path) {
                        known.push(file);
                    }
                }
                continue;
            }
        }
        let now: Vec<Stamp> = known.iter().map(|s| Stamp::of(&s.path)).collect();
        if now != known && settled(&known, &before, &now) {
            known.clone_from(&now);
            if !notify() {
                return;
            }
        }
        before = now;
    }
}

/// Whether nobody is at work on the files. Many editors write a new one and rename it over the old
/// one, which for a moment is not there.
fn settled(known: &[Stamp], before: &[Stamp], now: &[Stamp]) -> bool {
    let gone = known.iter().zip(now).any(|(k, n)| k.state.is_some() && n.state.is_none());
    before == now && !gone
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamp(length: Option<u64>) -> Vec<Stamp> {
        let state = length.map(|l| (SystemTime::UNIX_EPOCH, l));
        vec![Stamp { path: "a.scn".into(), state }]
    }

    #[test]
    fn a_file_that_grows_or_is_away_is_waited_for() {
        let [old, half, whole, gone] = [Some(5), Some(2), Some(7), None].map(stamp);
        assert!(!settled(&old, &old, &half), "just begun");
        assert!(!settled(&old, &half, &whole), "still growing");
        assert!(settled(&old, &whole, &whole));
        assert!(!settled(&old, &gone, &gone), "being replaced");
        assert!(settled(&gone, &whole, &whole), "it came");
    }

    #[test]
    fn a_change_is_told_once_and_the_thread_ends() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.scn");
        fs::write(&path, "one").unwrap();
        let known = vec![Stamp::of(&path)];
        let (stopper, stop) = channel();
        let (notify, told) = channel();
        let thread =
            std::thread::spawn(move || look_after(known, &stop, || notify.send(()).is_ok()));
        fs::write(&path, "three").unwrap();
        told.recv_timeout(Duration::from_secs(60)).unwrap();
        drop(stopper);
        thread.join().unwrap();
        assert_eq!(told.try_iter().count(), 0);
    }

    #[test]
    fn a_file_that_is_added_is_looked_after_and_one_that_is_known_stays() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = ["a", "b"].map(|name| folder.path().join(name));
        fs::write(&first, "one").unwrap();
        let stale = Stamp { path: first.clone(), state: None };
        let known = vec![Stamp::of(&first)];
        let (more, added) = channel();
        let (notify, told) = channel();
        let thread =
            std::thread::spawn(move || look_after(known, &added, || notify.send(()).is_ok()));
        more.send(vec![stale, Stamp::of(&second)]).unwrap();
        // Time for a change to be told that is none: nothing else would tell of looks that found nothing.
        std::thread::sleep(4 * PERIOD);
        assert_eq!(told.try_iter().count(), 0, "nothing has changed");
        fs::write(&second, "here").unwrap();
        told.recv_timeout(Duration::from_secs(60)).unwrap();
        drop(more);
        thread.join().unwrap();
        assert_eq!(told.try_iter().count(), 0);
    }
}
