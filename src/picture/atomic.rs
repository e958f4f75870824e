//! Files appear whole or not at all.

use std::fs;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;
use thiserror::Error;

/// A file that could not be written. What was there before is untouched.
#[derive(Debug, Error)]
pub enum SaveError {
    /// The name does not say what kind of picture is wanted.
    #[error("{}: unknown kind of picture; end the name in {}", .0.display(), super::Format::NAMES)]
    Format(PathBuf),
    /// The folder is missing, or nothing can be made in it.
    #[error("{}: cannot write in the folder {}: {source}; choose a folder that exists and that \
             you may write to", .path.display(), .folder.display())]
    Folder {
        /// The file asked for.
        path: PathBuf,
        /// Where it would have been.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The path names a folder or a device.
    #[error("{}: is not an ordinary file; give the name of a file", .0.display())]
    NotAFile(PathBuf),
    /// The file is there and may not be written.
    #[error("{}: is write-protected; remove the protection or choose another name", .0.display())]
    Protected(PathBuf),
    /// Writing failed on the way, such as on a full disk.
    #[error(
        "{}: could not be written: {source}; what was there before is untouched", .path.display()
    )]
    Write {
        /// The file asked for.
        path: PathBuf,
        /// What the system or the encoder said.
        source: io::Error,
    },
}

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
    let mut builder = tempfile::Builder::new();
    builder.prefix(".burnish-").suffix(".part");
    make_public(&mut builder);
    let aside = builder.tempfile_in(folder).and_then(|aside| {
        old.map_or(Ok(()), |old| aside.as_file().set_permissions(old.permissions()))?;
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

/// Temporary files are private by default; a picture is as public as the user's umask allows.
#[cfg(unix)]
fn make_public(builder: &mut tempfile::Builder) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn make_public(_: &mut tempfile::Builder) {}
