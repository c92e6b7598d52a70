//! Where files come from: the disk, or the program itself.

use std::borrow::Cow;
use std::io::{Error, ErrorKind};

/// Gives the bytes of files by path.
pub trait FileSource {
    /// The bytes of `path`.
    ///
    /// # Errors
    /// As the system says, or because there is no such file.
    fn read(&self, path: &str) -> std::io::Result<Cow<'_, [u8]>>;
}

/// Largest file that is read, in bytes.
const MAX_FILE: u64 = 4 << 30;

/// Files of the system.
#[derive(Clone, Copy, Debug)]
pub struct Disk;

impl FileSource for Disk {
    fn read(&self, path: &str) -> std::io::Result<Cow<'_, [u8]>> {
        let meta = std::fs::metadata(path)?;
        if meta.is_dir() {
            return Err(Error::new(
                ErrorKind::InvalidInput,
                "it is a folder, not a file",
            ));
        }
        if meta.len() > MAX_FILE {
            return Err(Error::new(
                ErrorKind::InvalidInput,
                "it is larger than 4 GiB",
            ));
        }
        std::fs::read(path).map(Cow::Owned)
    }
}

/// The files of one frame of a sequence: `{frame}` in a name is its number.
pub struct OneFrame<'a> {
    /// Where all frames are.
    pub files: &'a dyn FileSource,
    /// The number.
    pub frame: u32,
}

impl FileSource for OneFrame<'_> {
    fn read(&self, path: &str) -> std::io::Result<Cow<'_, [u8]>> {
        self.files
            .read(&path.replace("{frame}", &self.frame.to_string()))
    }
}

/// The reason of a failed read in words.
pub fn reason(error: &Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file".to_owned(),
        ErrorKind::PermissionDenied => "it must not be read (permission denied)".to_owned(),
        _ => error.to_string(),
    }
}

/// `name` as seen from the folder of `file`.
pub fn beside(file: &str, name: &str) -> String {
    let name = name.replace('\\', "/");
    if name.starts_with('/') || std::path::Path::new(&name).is_absolute() {
        return name;
    }
    let folder = file.replace('\\', "/");
    match folder.rfind('/') {
        Some(end) => format!("{}/{name}", &folder[..end]),
        None => name,
    }
}
