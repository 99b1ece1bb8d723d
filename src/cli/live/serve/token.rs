//! The secret in the address of the page: who has it may look, and set what the page can set.

use std::path::{Path, PathBuf};

/// Hexadecimal digits of a secret: 128 bits.
pub const DIGITS: usize = 32;

/// The secret for a port. Where the system has a folder that only this user can read and that ends with their session, it
/// is kept there, so that pages that are open find the next run.
pub fn for_port(port: u16) -> Result<String, getrandom::Error> {
    let kept = std::env::var_os("XDG_RUNTIME_DIR")
        .map(PathBuf::from)
        .filter(|folder| folder.is_absolute())
        .map(|folder| folder.join("rtc").join(format!("token-{port}")));
    if let Some(token) =
        kept.as_ref().filter(|path| is_ours_alone(path)).and_then(|path| std::fs::read_to_string(path).ok())
        && is_token(&token)
    {
        return Ok(token);
    }
    let mut bytes = [0; DIGITS / 2];
    getrandom::fill(&mut bytes)?;
    let token: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    if let Some(path) = kept {
        // Without it, only the address is another next time.
        let _ = keep(&path, &token);
    }
    Ok(token)
}

/// Whether a text could be a secret.
pub fn is_token(text: &str) -> bool {
    text.len() == DIGITS && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// Whether nobody else can have read a file that this user can read, nor written it.
fn is_ours_alone(path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        std::fs::symlink_metadata(path).is_ok_and(|found| found.is_file() && found.mode() & 0o077 == 0)
    }
    #[cfg(not(unix))]
    path.is_file()
}

/// Writes a file that only this user can read.
fn keep(path: &Path, token: &str) -> std::io::Result<()> {
    if let Err(error) = std::fs::remove_file(path)
        && error.kind() != std::io::ErrorKind::NotFound
    {
        return Err(error);
    }
    let mut file = std::fs::OpenOptions::new();
    file.write(true).create_new(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        file.mode(0o600);
    }
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    std::io::Write::write_all(&mut file.open(path)?, token.as_bytes())
}
