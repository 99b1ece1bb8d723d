//! `rtc lsp`: whole sessions of an editor, over the standard input and output of the real command.

mod answers;
mod client;
mod disk;
mod edits;
mod names;
mod page;
mod preview;
mod robust;
mod session;
mod written;
