//! The kinds of file that pictures are written as, and what goes wrong in writing them.

use crate::plain;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The kinds of file that pictures are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8-bit sRGB, tone-mapped and dithered: for looking at.
    Png,
    /// OpenEXR with the radiance itself in channels R, G, B, 32-bit float, linear Rec. 709: for
    /// measuring. Neither exposure nor curve goes into it.
    Exr,
}

impl Format {
    /// What a file's name may end in.
    pub const NAMES: &str = ".png (8-bit sRGB) or .exr (linear 32-bit float)";

    /// By the extension of the file's name, in upper or lower case.
    pub fn of(path: &Path) -> Result<Format, SaveError> {
        match path.extension().map(|e| e.to_ascii_lowercase()) {
            Some(e) if e == "png" => Ok(Format::Png),
            Some(e) if e == "exr" => Ok(Format::Exr),
            _ => Err(SaveError::Format(path.to_path_buf())),
        }
    }
}

/// A file that could not be written. What was there before is untouched.
#[derive(Debug, Error)]
pub enum SaveError {
    /// The name does not say what kind of picture is wanted.
    #[error("{}: unknown kind of picture; end the name in {}", plain::path(.0), Format::NAMES)]
    Format(PathBuf),
    /// The folder is missing, or nothing can be made in it.
    #[error("{}: cannot write in the folder {}: {source}; choose a folder that exists and that \
             you may write to", plain::path(.path), plain::path(.folder))]
    Folder {
        /// The file asked for.
        path: PathBuf,
        /// Where it would have been.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The path names a folder or a device.
    #[error("{}: is not an ordinary file; give the name of a file", plain::path(.0))]
    NotAFile(PathBuf),
    /// The path is a symbolic link to a place where nothing is.
    #[error("{}: is a symbolic link to {}, which is not there; name that file, or remove the link",
            plain::path(.path), plain::path(.to))]
    Dangling {
        /// The link.
        path: PathBuf,
        /// Where it leads.
        to: PathBuf,
    },
    /// The file is there and may not be written.
    #[error("{}: is write-protected; remove the protection or choose another name", plain::path(.0))]
    Protected(PathBuf),
    /// Writing failed on the way, such as on a full disk.
    #[error(
        "{}: could not be written: {source}; what was there before is untouched", plain::path(.path)
    )]
    Write {
        /// The file asked for.
        path: PathBuf,
        /// What the system or the encoder said.
        source: io::Error,
    },
}
