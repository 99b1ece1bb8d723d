//! `rtc lsp`: whole sessions of an editor, over the standard input and output of the real command.

mod client;
mod edits;
mod robust;
mod session;
