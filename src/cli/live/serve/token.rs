//! The secret in the address of the page: who has it may look, and set what the page can set.

use std::path::PathBuf;

/// Hexadecimal digits of a secret: 128 bits.
pub const DIGITS: usize = 32;

/// The secret for a port. Where the system has a folder that only this user can read and that ends with their session, it
/// is kept there, so that pages that are open find the next run.
pub fn for_port(port: u16) -> Result<String, getrandom::Error> {
    let kept = std::env::var_os("XDG_RUNTIME_DIR")
        .map(PathBuf::from)
        .filter(|folder| folder.is_absolute())
        .map(|folder| folder.join("rtc").join(format!("token-{port}")));
    if let Some(token) = kept.as_ref().and_then(|path| std::fs::read_to_string(path).ok())
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

/// Writes a file that only this user can read.
fn keep(path: &std::path::Path, token: &str) -> std::io::Result<()> {
    let mut file = std::fs::OpenOptions::new();
    file.write(true).create(true).truncate(true);
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
