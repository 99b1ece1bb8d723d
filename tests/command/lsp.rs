//! `rtc lsp`: whole sessions of an editor, over the standard input and output of the real command.

mod answers;
mod client;
mod edits;
mod names;
mod preview;
mod robust;
mod session;
