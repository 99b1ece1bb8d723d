//! Starts the language server of rtc in Zed: the `rtc` on the path, or the one that the settings name.

use zed_extension_api::{self as zed, settings::LspSettings, Command, LanguageServerId, Result, Worktree};

struct Rt;

impl zed::Extension for Rt {
    fn new() -> Self {
        Rt
    }

    fn language_server_command(&mut self, _: &LanguageServerId, worktree: &Worktree) -> Result<Command> {
        let set = LspSettings::for_worktree("rtc", worktree).ok().and_then(|settings| settings.binary);
        let named = set.as_ref().and_then(|binary| binary.path.clone());
        let command = named
            .or_else(|| worktree.which("rtc"))
            .ok_or("`rtc` is not on the path: install it, or set lsp.rtc.binary.path")?;
        let args = set.and_then(|binary| binary.arguments).unwrap_or_else(|| vec!["lsp".into()]);
        Ok(Command { command, args, env: worktree.shell_env() })
    }
}

zed::register_extension!(Rt);
