//! Little memory: where the address space is limited, it is not to be set aside in vain.

/// The C library sets aside 64 MiB of address space for each thread, which under `ulimit -v` are then
/// missing where memory is wanted, and no estimate holds. It does without if it is told so before the
/// program begins: so the program begins again, as the same process, where there is such a limit.
#[cfg(target_os = "linux")]
pub(super) fn begin() {
    use burnish::limits::{ONE_PLACE, address_space};
    use std::os::unix::process::CommandExt;
    let (name, one) = ONE_PLACE;
    if address_space().is_none() || std::env::var_os(name).is_some() {
        return;
    }
    let Ok(program) = std::env::current_exe() else { return };
    let mut arguments = std::env::args_os();
    let mut again = std::process::Command::new(program);
    if let Some(name) = arguments.next() {
        again.arg0(name);
    }
    // Comes back only where it fails; then it is done without.
    let _ = again.args(arguments).env(name, one).exec();
}

/// Other systems have no such limit.
#[cfg(not(target_os = "linux"))]
pub(super) fn begin() {}
