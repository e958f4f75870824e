//! Memory is not to be set aside in vain: where the address space is limited, and by what stays for days.

/// Tells the C library how to set memory aside, which it has to know before a program begins: so the program begins
/// again, as the same process.
///
/// It sets aside 64 MiB of address space for each thread, which under `ulimit -v` are then missing where memory
/// is wanted, and no estimate holds: where there is such a limit it is told to do without. Elsewhere it is not: threads
/// that wait for each other's memory make an edit's picture a quarter later (`burnish report latency`).
///
/// Blocks from 128 KiB on come from the system at first, and go back to it once they are given back; but when the first
/// one is, blocks of its size are from then on cut from where the small ones lie, and as much is kept there. So
/// what `stays`, a window left open, comes to hold ever more in the holes between. It is then told to keep to the
/// 128 KiB.
#[cfg(target_os = "linux")]
pub(super) fn begin(stays: bool) {
    use burnish::limits::{ONE_PLACE, address_space};
    use std::os::unix::process::CommandExt;
    let wanted = [(ONE_PLACE, address_space().is_some()), (LARGE, stays)];
    let is_new =
        |((name, _), is_wanted): &((&str, _), bool)| *is_wanted && std::env::var_os(name).is_none();
    let new: Vec<_> = wanted.into_iter().filter(is_new).map(|(setting, _)| setting).collect();
    if new.is_empty() {
        return;
    }
    let Ok(program) = std::env::current_exe() else { return };
    let mut arguments = std::env::args_os();
    let mut again = std::process::Command::new(program);
    if let Some(name) = arguments.next() {
        again.arg0(name);
    }
    // Comes back only where it fails; then it is done without.
    let _ = again.args(arguments).envs(new).exec();
}

/// From how many bytes on blocks come from the system alone: what the C library begins with, told so that it
/// stays.
#[cfg(target_os = "linux")]
const LARGE: (&str, &str) = ("MALLOC_MMAP_THRESHOLD_", "131072");

/// Other systems have no such limit, and see to it themselves.
#[cfg(not(target_os = "linux"))]
pub(super) fn begin(_: bool) {}
