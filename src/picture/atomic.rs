//! Files appear whole or not at all.

use super::SaveError;
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::NamedTempFile;

/// Anything that can be written to and moved about in, as encoders want it.
pub trait Sink: Write + Seek {}
impl<T: Write + Seek> Sink for T {}

/// Writes a file aside, in the same folder, and renames it into place once it is on the disk: at
/// every moment `path` holds either what it held before or all of the new content.
pub fn replace_file(
    path: &Path,
    content: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
) -> Result<(), SaveError> {
    let failed = |source: io::Error| {
        use io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
        let source = match source.kind() {
            // The kind alone: the full text names the temporary file, which tells the user nothing.
            kind @ (StorageFull | QuotaExceeded | FileTooLarge) => kind.into(),
            _ => source,
        };
        SaveError::Write { path: path.to_path_buf(), source }
    };
    let (target, aside) = open_aside(path)?;
    let mut buffer = BufWriter::new(aside);
    content(&mut buffer).map_err(failed)?;
    let aside = buffer.into_inner().map_err(|e| failed(e.into_error()))?;
    aside.as_file().sync_all().map_err(failed)?;
    aside.persist(target).map_err(|e| failed(e.error))?;
    Ok(())
}

/// Whether [`replace_file`] could begin: to be asked before hours of work, not after.
pub fn check_writable(path: &Path) -> Result<(), SaveError> {
    open_aside(path).map(|_| ())
}

/// The file to replace and a new one beside it, which goes away when dropped.
fn open_aside(path: &Path) -> Result<(PathBuf, NamedTempFile), SaveError> {
    // A rename would replace a symbolic link itself, not what it points to.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let old = fs::metadata(&target).ok();
    if let (None, Ok(to)) = (&old, fs::read_link(path)) {
        return Err(SaveError::Dangling { path: path.to_path_buf(), to });
    }
    match &old {
        Some(old) if !old.is_file() => return Err(SaveError::NotAFile(path.to_path_buf())),
        Some(old) if old.permissions().readonly() => {
            return Err(SaveError::Protected(path.to_path_buf()));
        }
        _ if target.file_name().is_none() => return Err(SaveError::NotAFile(path.to_path_buf())),
        _ => {}
    }
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    remove_leftovers(folder);
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    make_public(&mut builder);
    let aside = builder.tempfile_in(folder).and_then(|aside| {
        old.map_or(Ok(()), |old| aside.as_file().set_permissions(old.permissions()))?;
        // For as long as this process lives: others see by it that the file is in use. Some file
        // systems have no locks, and do without.
        let _ = aside.as_file().try_lock();
        Ok(aside)
    });
    match aside {
        Ok(aside) => Ok((target, aside)),
        Err(e) => Err(SaveError::Folder {
            path: path.to_path_buf(),
            folder: folder.to_path_buf(),
            // The kind alone: the full text names the temporary file, which tells the user nothing.
            source: e.kind().into(),
        }),
    }
}

/// What files are called that are being written.
const PREFIX: &str = ".burnish-";
const SUFFIX: &str = ".part";
/// A file so young may be between its making and its lock.
const YOUNG: Duration = Duration::from_secs(60);

/// Removes what processes left that were killed while they wrote. A file that somebody still writes
/// has a lock, which a process loses by its death; on file systems without locks nothing is removed.
fn remove_leftovers(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let ours = name.to_str().is_some_and(|n| n.starts_with(PREFIX) && n.ends_with(SUFFIX));
        if ours && is_left_over(&entry.path()) {
            // Another process may have been faster.
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn is_left_over(path: &Path) -> bool {
    let age = |about: fs::Metadata| about.modified().ok()?.elapsed().ok();
    let about = fs::symlink_metadata(path).ok().filter(fs::Metadata::is_file);
    about.and_then(age).is_some_and(|age| age > YOUNG)
        && File::open(path).is_ok_and(|file| file.try_lock().is_ok())
}

/// Temporary files are private by default; a picture is as public as the user's umask allows.
#[cfg(unix)]
fn make_public(builder: &mut tempfile::Builder) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn make_public(_: &mut tempfile::Builder) {}
