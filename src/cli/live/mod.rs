//! `rtc watch`: the picture follows the text.
//!
//! | module | what it holds |
//! |---|---|
//! | [`serve`] | the page |
//! | [`editor`] | how a place in a file is opened |
//! | [`hub`] | what everybody may know, and ask |

pub mod editor;
pub mod hub;
pub mod serve;
