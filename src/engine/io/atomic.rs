//! Writing without losing what was there.

use std::io::{Error, ErrorKind, Write};
use std::path::Path;

/// Replaces `path` by `bytes`: they are written beside it first, so that the old file survives a
/// full disk, a crash or a removed folder.
///
/// # Errors
/// As the system says; `path` is then as it was.
pub fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    // A link stays a link: what it points at is replaced.
    let path = &std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let old = std::fs::metadata(path).ok();
    if old.as_ref().is_some_and(|m| m.permissions().readonly()) {
        let message = "it must not be written (it is read-only)";
        return Err(Error::new(ErrorKind::PermissionDenied, message));
    }
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".lightscope-");
    #[cfg(unix)]
    {
        // A temporary file is private; a picture has the rights of any new file, or the old ones.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder)?;
    if let Some(old) = old {
        file.as_file().set_permissions(old.permissions())?;
    }
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.txt");
        write(&path, b"old").expect("a new file");
        write(&path, b"new").expect("an old file is replaced");
        assert_eq!(std::fs::read(&path).expect("readable"), b"new");
        let mut rights = std::fs::metadata(&path).expect("there").permissions();
        rights.set_readonly(true);
        std::fs::set_permissions(&path, rights).expect("made read-only");
        assert!(write(&path, b"newer").is_err());
        assert_eq!(std::fs::read(&path).expect("readable"), b"new");
        let missing = folder.path().join("missing/a.txt");
        assert!(write(&missing, b"x").is_err());
        assert_eq!(
            std::fs::read_dir(folder.path()).expect("a folder").count(),
            1
        );
    }
    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let folder = tempfile::tempdir().expect("a folder");
        let (path, link) = (folder.path().join("a.txt"), folder.path().join("link.txt"));
        std::fs::write(&path, b"old").expect("written");
        std::os::unix::fs::symlink(&path, &link).expect("linked");
        write(&link, b"new").expect("written through the link");
        assert_eq!(std::fs::read(&path).expect("readable"), b"new");
        assert!(link.is_symlink());
    }
}
