//! Memory is not to be set aside in vain: where the address space is limited, and by what stays for days.

/// The C library sets aside 64 MiB of address space for each thread, which under `ulimit -v` are then
/// missing where memory is wanted, and no estimate holds. What a thread has given back stays with its own
/// share besides, and what was once large is from then on cut from where the small is, so that a window left
/// open comes to hold ever more in pieces. It does without both if it is told so before the program begins: so
/// the program begins again, as the same process, where there is such a limit, or if it `stays`.
#[cfg(target_os = "linux")]
pub(super) fn begin(stays: bool) {
    use burnish::limits::{ONE_PLACE, address_space};
    use std::os::unix::process::CommandExt;
    let (name, one) = ONE_PLACE;
    if !stays && address_space().is_none() || std::env::var_os(name).is_some() {
        return;
    }
    let Ok(program) = std::env::current_exe() else { return };
    let mut arguments = std::env::args_os();
    let mut again = std::process::Command::new(program);
    if let Some(name) = arguments.next() {
        again.arg0(name);
    }
    if stays {
        again.env(LARGE.0, LARGE.1);
    }
    // Comes back only where it fails; then it is done without.
    let _ = again.args(arguments).env(name, one).exec();
}

/// From how many bytes on the C library gives back at once what is no longer used, whatever was asked for
/// before: the least that holds no tile's sums.
#[cfg(target_os = "linux")]
const LARGE: (&str, &str) = ("MALLOC_MMAP_THRESHOLD_", "524288");

/// Other systems have no such limit, and share memory between threads.
#[cfg(not(target_os = "linux"))]
pub(super) fn begin(_: bool) {}
