//! `rtc watch`: the picture follows the text.
//!
//! | module | what it holds |
//! |---|---|
//! | [`hub`] | what everybody may know, and ask |

pub mod hub;
